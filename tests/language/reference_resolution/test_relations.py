"""Relations in descriptions: to others of the same kind, to the viewer, and those that do not hold."""

from __future__ import annotations

import pytest

from semmap.nodes.language.reference_resolution.map_index import MapIndex
from semmap.nodes.language.reference_resolution.missing import missing
from semmap.nodes.language.reference_resolution.resolution import find
from tests.language.reference_resolution.kitchen import TERMS, Written, found, item, known

HEIGHTS = {"fridge1": 0.0, "fridge2": 1.0, "fridge3": 2.0, "fridge4": 3.0, "cup1": 4.0}


class Stack(Written):
    """Four fridges above each other, the second is open, and a cup on the highest."""

    def position(self, name):
        return (0.0, 0.0, HEIGHTS[name])

    def related(self, relation, name, other):
        higher = HEIGHTS[name] > HEIGHTS[other]
        return {"isAbove": higher, "isUnder": name != other and not higher}.get(relation, False)


def in_stack(text):
    index = MapIndex(TERMS)
    index.update([item(f"fridge{n}", "Fridge", isOpen=n == 2) for n in (1, 2, 3, 4)] + [item("cup1", "Cup")])
    return set(find(text, index, Stack()).names)


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("the fridge above the open fridge", {"fridge3"}),
        ("the fridge above the open one", {"fridge3"}),
        ("the fridge under the open fridge", {"fridge1"}),
        ("the fridges under the cup", {"fridge1", "fridge2", "fridge3", "fridge4"}),
    ],
)
def test_above_one_of_its_kind_is_the_nearest_above(text, names):
    assert in_stack(text) == names


@pytest.mark.parametrize(
    ("text", "outcome", "names"),
    [
        ("the cup between cup1 and the glasses", "one", {"cup2"}),
        ("the fridge without a cup", "one", {"fridge1"}),
        ("the sink without a cup", "none", set()),
        ("the table that holds a cup", "one", {"table1"}),
        ("the cup not on the table", "one", {"cup3"}),
        ("the cup that is not in the sink", "ambiguous", {"cup1", "cup2"}),
        ("the third cup from the fridge", "one", {"cup2"}),
        ("the cup near me", "none", set()),
        ("the closest cup", "one", {"cup1"}),
        ("the cup of wine", "one", {"wine1"}),  # a container stands for its content
        ("the table of wine", "none", set()),
        ("the person", "one", {"anna"}),
        ("anyone", "one", {"anna"}),
        ("who is in the kitchen", "one", {"anna"}),
        ("the open fridge", "none", set()),
    ],
)
def test_relations_select_what_they_hold_for(text, outcome, names):
    assert found(text, "anna", has_viewer=True) == (outcome, names)


def test_what_is_missing_is_described_with_where_it_should_be():
    """The knowledge base looks for it in the past."""
    answer = find("the cup on the fridge", known(), Written())
    assert (answer.outcome, missing(answer).pairs) == (
        "none",
        tuple((cup, "isOn", "fridge1") for cup in ("cup1", "cup2", "cup3")),
    )
