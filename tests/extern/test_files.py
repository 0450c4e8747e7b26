"""Local files of the client."""

from pathlib import Path

import pytest

from semmap.nodes.extern import files
from semmap.schemas import errors


def test_a_file_is_read_whole(tmp_path):
    file = tmp_path / "map.ttl"
    file.write_bytes(b"x" * 100_000)
    assert files.read_file(file) == b"x" * 100_000


def test_what_cannot_be_read_says_why(tmp_path):
    with pytest.raises(errors.BadFile, match=r"^there is no file .*/map.ttl$"):
        files.read_file(tmp_path / "map.ttl")
    with pytest.raises(errors.BadFile, match="is a directory, not a file"):
        files.read_file(tmp_path)


def test_what_has_no_end_is_refused(monkeypatch):
    monkeypatch.setattr(files, "LARGEST", 1 << 20)
    with pytest.raises(errors.BadFile, match=r"^/dev/zero is larger than 1 MiB; split it into several"):
        files.read_file(Path("/dev/zero"))


def test_a_map_of_labels(tmp_path):
    file = tmp_path / "map.json"
    file.write_text('{"coffee mug": "Cup"}')
    assert files.read_label_map(file) == {"coffee mug": "Cup"}
    file.write_text("[]")
    with pytest.raises(errors.BadFile, match="not a JSON object of labels"):
        files.read_label_map(file)
