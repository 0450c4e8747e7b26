"""Next to, between, and attached to."""

import pytest

from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.measuring.arrangement import (
    find_attachments,
    find_between,
    measure_attachment,
    measure_next_to,
)
from semmap.nodes.kb_node.relations.measuring.space import Space
from tests.kb_node.relations.entities import ROOM, TABLE, TOP, thing

WALL = thing("wall1", (0.0, 2.0, 0.0), size=(0.1, 4.0, 2.5), turn=(0.7071068, 0.0, 0.0, 0.7071068))
PICTURE = thing("picture1", (0.0, 1.93, 1.4), turn=(0.7071068, 0.0, 0.0, -0.7071068))
CUPS = [thing(f"cup{n}", (0.18 * n, 0.0, TOP)) for n in (1, 2, 3)]


def space(*entities):
    return Space([ROOM, TABLE, *entities])


@pytest.mark.parametrize(
    ("other", "holds"),
    [
        pytest.param(thing("plate1", (0.2, 0.2, TOP)), True, id="on the same table"),
        pytest.param(thing("plate1", (0.2, 0.2, 0.0)), None, id="under the table, far below"),
        pytest.param(thing("stool1", (0.35, 0.0, 0.25)), False, id="near, but not on the table"),
        pytest.param(thing("plate1", (0.2, 2.9, TOP)), None, id="far away"),
    ],
)
def test_next_to(other, holds):
    cup = thing("cup1", (0.0, 0.0, TOP))
    there = space(cup, other)
    made = measure_next_to(there, there.solids["cup1"], there.solids[other.name])
    assert (None if made is None else made.holds) == holds


def test_an_object_between_two_prevents_next_to():
    there = space(*CUPS)
    first, middle, last = (there.solids[cup.name] for cup in CUPS)
    assert find_between(there, first, last) == [middle]
    assert find_between(there, first, middle) == []
    made = measure_next_to(there, first, last)
    assert made is None or not made.holds
    assert measure_next_to(there, first, middle).holds


def test_a_picture_on_a_wall_is_attached_to_it():
    there = space(WALL, PICTURE)
    picture, wall = there.solids["picture1"], there.solids["wall1"]
    assert measure_attachment(there, picture, wall).holds
    assert measure_attachment(there, wall, picture) is None
    assert list(find_attachments(there, picture)) == [wall]


def test_a_standing_object_is_not_attached_to_the_wall():
    there = space(WALL, thing("cabinet1", (0.0, 1.72, 0.0)))
    assert list(find_attachments(there, there.solids["cabinet1"])) == []


def test_an_attachment_ends_with_a_support():
    facts = Facts()
    facts.update([ROOM, WALL, PICTURE])
    hangs = ("picture1", "isAttachedTo", "wall1")
    assert hangs in facts
    box = thing("box1", (0.0, 1.85, 0.0), size=(0.3, 0.3, 1.4))
    assert hangs in facts.update([box]).gone
    assert hangs in facts.update([], ["box1"]).come
