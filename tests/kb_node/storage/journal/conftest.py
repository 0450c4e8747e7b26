import pytest

from semmap.nodes.kb_node.storage.journal import FILENAME, Journal


@pytest.fixture
def path(tmp_path):
    return tmp_path / FILENAME


@pytest.fixture
def journal(path):
    made = Journal.create(path, b"<urn:t> <urn:t> <urn:t> .\n")
    yield made
    made.close()
