"""Parsing of batches: one change per line."""

from __future__ import annotations

import json

import pytest

from semmap.nodes.extern.cli.commands.batch import read_changes
from semmap.schemas import commands as c
from semmap.schemas import errors


def test_each_line_is_the_command_that_it_would_be_alone():
    text = """
# the morning
set door1 isOpen true
  semmap set shelf1 mass -3

update chair1 --at 1 2 0 --ref "a seat" --unset note
unset door1 hasColor 'color red'
"""
    assert list(read_changes(text)) == [
        c.Set(name="door1", property="isOpen", values=("true",)),
        c.Set(name="shelf1", property="mass", values=("-3",)),
        c.Update(name="chair1", at=(1.0, 2.0, 0.0), ref="a seat", unset=("note",)),
        c.Unset(name="door1", property="hasColor", value="color red"),
    ]


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("remove cup1", "line 2: 'remove' is not one of update, set, unset"),
        ("set door1", "line 2: missing argument PROPERTY; usage: set .*NAME PROPERTY VALUE"),
        ("set door1 isOpen true --sudo", "line 2: unknown option '--sudo'; see: set --help"),
        ("update chair1 --at 1 two 0", "line 2: .*'two' is not a number"),
        ("set door1 'isOpen", "line 2: no closing quotation"),
        ("update --help", "line 2: 'update --help' is not a change"),
    ],
)
def test_an_invalid_line_is_named(capsys, line, said):
    with pytest.raises(errors.BadRequest, match=said):
        list(read_changes(f"set door1 isOpen true\n{line}\n"))


def test_a_batch_over_a_real_system(flat_map, tmp_path):
    file = tmp_path / "morning.txt"
    file.write_text("set door1 isOpen true\nset door2 isOpen true\nupdate chair1 --at 1 1 0\n")
    assert "changed 3: door1, door2 and chair1 (commit 2)" in flat_map.cli("batch", str(file))
    (row,) = json.loads(flat_map.cli("history", "--limit", "1", "--format", "json"))
    assert (row["seq"], row["verb"]) == (2, "batch")
    flat_map.cli("undo")
    file.write_text("set door1 isOpen true\nset door99 isOpen true\n")
    assert "door99" in flat_map.cli("batch", str(file), status=1)
    file.write_bytes(b"set door1 \xff")
    assert "is not a UTF-8 text file" in flat_map.cli("batch", str(file), status=2)
    assert "there is no file" in flat_map.cli("batch", str(tmp_path / "none.txt"), status=2)
    file.write_text("# nothing\n")
    assert "no changes found" in flat_map.cli("batch", str(file), status=2)
    with flat_map.client() as client:
        assert client.get("door1").properties["isOpen"] is False
        made = client.batch(
            c.Set(name="door1", property="isOpen", values=(True,)),
            c.Unset(name="door2", property="isOpen"),
            reason="airing",
        )
        assert made.commit == 4
        assert client.history(limit=1)[0].reason == "airing"
