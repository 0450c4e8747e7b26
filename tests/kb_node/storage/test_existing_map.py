import pytest

from semmap.nodes.kb_node.storage.existing_map import describe_existing_map
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.schemas import errors


def test_a_start_with_an_existing_map_says_so(tmp_path):
    assert describe_existing_map(tmp_path) is None
    Journal.create(tmp_path / FILENAME, b"<urn:t> <urn:t> <urn:t> .\n").close()
    said = f"continuing with the map in {tmp_path} (--fresh starts a new one and keeps this one)"
    assert describe_existing_map(tmp_path) == said
    Journal(tmp_path / FILENAME).close()  # it is not left open


def test_a_file_that_is_no_journal_is_rejected(tmp_path):
    (tmp_path / FILENAME).write_bytes(b"no journal" * 100)
    with pytest.raises(errors.Refused, match=FILENAME):
        describe_existing_map(tmp_path)
