"""Roles of frames as slots of all frames."""

import pytest

from semmap.nodes.language.understanding import slots
from tests.data import data_folder


@pytest.mark.parametrize(
    ("frame", "role", "branch", "verb"),
    [
        ("Taking", "Theme", "other", "take"),
        ("Motion", "Theme", "robot", "go"),
        ("Attaching", "Item", "Device", "connect"),
        ("Attaching", "Goal", "Fixture", "connect"),
        ("Arriving", "Goal", "Location", "enter"),
        ("Closure", "Container_portal", "Door", "open"),
        ("Closure", "Containing_object", "Container", "open"),
        ("Locating", "Cognizer", "robot", "search"),
        ("Locating", "Perceiver", "robot", "find"),
        ("Locating", "Ground", "Location", "find"),
        ("Inspecting", "Ground", "Location", "inspect"),
        ("Giving", "Recipient", "Person", "give"),
        ("Change_direction", "Speed", "unknown", "turn"),
    ],
)
def test_a_role_comes_back_from_its_slot(frame, role, branch, verb):
    assert slots.role(frame, slots.slot(frame, role), branch, verb) == role


def test_every_role_of_the_corpus_has_a_slot():
    inventory = data_folder() / "huric" / "INVENTORY.md"
    for line in inventory.read_text().splitlines():
        if line.startswith("- "):
            frame, roles = line[2:].split(": ")
            assert all(slots.slot(frame, role) for role in roles.split(", ")), frame


def test_an_unknown_role_has_no_slot():
    with pytest.raises(KeyError):
        slots.slot("Taking", "Colour")
