"""The present names of renamed entities."""

import pytest

from semmap.nodes.kb_node.answers.past.renames import Renames
from semmap.nodes.kb_node.storage.trail_file import TrailLine

RENAMES = Renames([[(5, "mug1"), (3, "cup2"), (0, "cup1")], [(0, "table1")]])


@pytest.mark.parametrize(
    ("name", "when", "present"),
    [
        ("cup1", 2, "mug1"),
        ("cup2", 3, "mug1"),
        ("cup2", 4, "mug1"),
        ("mug1", 5, "mug1"),
        ("cup1", 3, "cup1"),  # another entity, whose name is still its own
        ("mug1", 4, "mug1 (another entity)"),
        ("table1", 4, "table1"),
    ],
)
def test_the_present_name_of_an_entity(name, when, present):
    assert RENAMES.present(name, when) == present
    assert RENAMES.present_names == {"mug1"}


def test_a_trail_has_the_present_names():
    lines = [TrailLine(2, "start"), TrailLine(2, "at", "cup1", (0.0, 0.0, 0.0), ("table1", "mug1"))]
    assert list(RENAMES.in_trail(lines)) == [
        lines[0],
        TrailLine(2, "at", "mug1", (0.0, 0.0, 0.0), ("table1", "mug1 (another entity)")),
    ]
