"""Visibility and sides from a view."""

import math

import pytest

from semmap.nodes.kb_node.relations.measuring.space import Space
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
