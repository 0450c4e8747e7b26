"""Visibility and sides from a view."""

import math

import pytest

from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.viewing import (
    View,
    is_on_side,
    list_intrinsic_sides,
    list_sides,
)
from semmap.nodes.kb_node.relations.relation_reports import list_relations
from semmap.schemas.commands import Relations
from tests.kb_node.relations.entities import ROOM, TABLE, TOP, thing

CUP = thing("cup1", (0.0, 0.0, TOP))
SCREEN = thing("screen1", (-1.5, 0.0, 0.0), model="", size=(0.1, 2.0, 2.0))
PERSON = thing("person1", (-2.5, 0.0, 0.0), model="person")


def told(*entities, **fields):
    space = Space([ROOM, TABLE, CUP, *entities])
    return {(r.relation, r.object): r for r in list_relations(space, Relations(name="cup1", **fields))}


def test_an_unobstructed_object_is_visible():
    found = told(viewpoint=(-2.5, 0.0, 1.5, 0.0))["isVisibleFrom", ""]
    assert found.holds
    assert found.share == 1.0
    assert found.text == "cup1 is visible from there: 100% of the lines of sight reach it"


def test_an_object_behind_a_screen_is_not_visible():
    found = told(PERSON, SCREEN, viewer="person1")["isVisibleFrom", "person1"]
    assert not found.holds
    assert found.text.endswith("0% of the lines of sight reach it; screen1 is in the way")


def test_a_half_occluded_object_is_half_visible():
    half = thing("box1", (-0.5, 0.06, TOP), model="", size=(0.1, 0.1, 0.4))
    found = told(half, viewpoint=(-2.5, 0.0, TOP + 0.05, 0.0))["isVisibleFrom", ""]
    assert 0.3 <= found.share <= 0.7


@pytest.mark.parametrize(("yaw", "is_visible"), [(0.0, True), (0.9, True), (1.3, False), (math.pi, False)])
def test_visibility_depends_on_the_viewing_direction(yaw, is_visible):
    assert told(viewpoint=(-2.5, 0.0, 1.5, yaw))["isVisibleFrom", ""].holds == is_visible


def test_an_object_with_a_front_has_intrinsic_sides():
    assert ("isInFrontOf", "person1") in told(PERSON, viewer="person1")
    turned = thing("person1", (-2.5, 0.0, 0.0), model="person", yaw=math.pi / 2)
    assert ("isRightOf", "person1") in told(turned, viewer="person1")


@pytest.mark.parametrize(
    ("x", "y", "sides"),
    [
        (-1.0, 0.0, {"isInFrontOf": 1.0}),
        (1.0, 0.0, {"isBehind": 1.0}),
        (0.0, 1.0, {"isLeftOf": 1.0}),
        (0.0, -1.0, {"isRightOf": 1.0}),
        (1.0, 0.9, {"isBehind": 1.0, "isLeftOf": 0.9}),
        (1.0, 0.8, {"isBehind": 1.0}),  # more than 50 degrees from the axis
        (-0.8, -1.0, {"isRightOf": 1.0}),
        (-0.9, -1.0, {"isInFrontOf": 0.9, "isRightOf": 1.0}),
        (0.09, 0.0, {}),  # at the same place
        (0.0, 2.3, {}),  # too far away
    ],
)
def test_the_sides_of_a_box_that_a_viewer_faces(x, y, sides):
    one, other = (
        thing(name, at, "", size=(0.2, 0.2, 0.2)) for name, at in (("a1", (x, y, 0.0)), ("b1", (0.0,) * 3))
    )
    space, view = Space([ROOM, one, other]), View.at(-5.0, 0.0, 0.0, 0.0)
    solid, of = space.solids["a1"], space.solids["b1"]
    found = {side.relation: side.by_m for side in list_sides(space, solid, view) if side.other is of}
    assert found == pytest.approx(sides)
    for relation in ("isInFrontOf", "isBehind", "isLeftOf", "isRightOf"):
        assert is_on_side(space, relation, solid, of, view) == (relation in sides)
        assert not is_on_side(space, relation, solid, space.solids["kitchen1"], view)
    if abs(y) < 2.0:  # the front of the box itself is away from the viewer, and its left is theirs
        turned = {"isInFrontOf": "isBehind", "isBehind": "isInFrontOf"}
        own = {side.relation: side.by_m for side in list_intrinsic_sides(solid, of)}
        assert own == pytest.approx({turned.get(name, name): by_m for name, by_m in sides.items()})


@pytest.mark.parametrize(
    ("viewer", "eyes", "ahead"),
    [
        (thing("r1", (1.0, 2.0, 0.0), "", size=(0.4, 0.4, 2.0)), (1.0, 2.0, 1.8), (1.0, 0.0)),
        (
            thing("r1", (1.0, 2.0, 0.0), "", size=(0.4, 0.4, 1.0), yaw=math.pi / 2),
            (1.0, 2.0, 0.9),
            (0.0, 1.0),
        ),
        (thing("r1", (1.0, 2.0, 0.5), "unheard of"), (1.0, 2.0, 0.5), (1.0, 0.0)),
    ],
)
def test_the_view_of_an_entity_is_along_its_front(viewer, eyes, ahead):
    view = View.of(Space([viewer]).solids["r1"])
    assert view.eyes == pytest.approx(eyes)
    assert view.ahead == pytest.approx(ahead)
