"""Plans contain the outlines of objects and places, part by part, and the known walls."""

from __future__ import annotations

import pytest
from msgspec import structs

from semmap.nodes.kb_node.answers.route_planning import plan_of
from semmap.schemas.plans import Outline
from tests.kb_node.relations.entities import CORNER, ROOM, TABLE, TOP, thing

SQUARE = "POLYGON ((0 0, 4 0, 4 2, 0 2, 0 0), (1 0.5, 1 1.5, 2 1.5, 2 0.5, 1 0.5))"
WALL = Outline(corners=((0.0, 0.0), (1.0, 0.0), (1.0, 0.1)), low=0.0, high=2.5)
NO_WALLS = "no simulator provides the walls, so they are assumed where there is neither a place nor a door"
BOX = thing("box1", (1.0, 2.0, 0.5), size=(0.4, 0.2, 0.3))


def said(entity, *types, **properties):
    return structs.replace(entity, properties=properties, types=(*entity.types, *types))


def area(corners):
    pairs = zip(corners, (*corners[1:], corners[0]), strict=True)
    return sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in pairs) / 2


def test_an_object_is_drawn_at_its_pose():
    plan = plan_of([BOX], ())
    ((box,),) = (plan.things,)
    assert (box.name, box.label, box.class_) == ("box1", "box1", "Box")
    ((part,),) = (box.parts,)
    assert (part.low, part.high) == (pytest.approx(0.5, abs=0.01), pytest.approx(0.8, abs=0.01))
    for corners in (part.corners, box.footprint):
        assert sorted((round(x, 3), round(y, 3)) for x, y in corners) == [
            (0.8, 1.9),
            (0.8, 2.1),
            (1.2, 1.9),
            (1.2, 2.1),
        ]
        assert area(corners) == pytest.approx(0.08, abs=0.001)
    assert (box.door, box.open, box.connects) == (False, None, ())
    assert plan.places == ()


def test_a_table_is_drawn_with_its_legs_and_its_label():
    (table,) = plan_of([TABLE], ()).things
    assert (table.label, len(table.parts) > 1) == ("kitchen table", True)
    assert max(part.high for part in table.parts) == pytest.approx(TOP)
    assert all(area(part.corners) > 0 for part in table.parts)


def test_entities_without_pose_or_size_are_omitted_and_the_others_sorted_by_name():
    nowhere = thing("cup1", None)
    unmeasured = structs.replace(thing("gizmo1", (0.0, 0.0, 0.0)), size_m=None, model="")
    plan = plan_of([TABLE, nowhere, unmeasured, BOX], ())
    assert [one.name for one in plan.things] == ["box1", "table1"]


@pytest.mark.parametrize(
    ("properties", "open_", "connects"),
    [
        ({}, None, ()),
        ({"isOpen": True, "connects": ("kitchen1", "hall1")}, True, ("kitchen1", "hall1")),
        ({"isOpen": False, "connects": "kitchen1"}, False, ("kitchen1",)),
        ({"isOpen": "ajar"}, None, ()),
    ],
)
def test_a_door_has_a_state_and_connects_places(properties, open_, connects):
    (door,) = plan_of([said(BOX, "Door", **properties)], ()).things
    assert (door.door, door.open, door.connects) == (True, open_, connects)
    (other,) = plan_of([said(BOX, **properties)], ()).things
    assert (other.door, other.open, other.connects) == (False, None, ())


def test_a_place_is_drawn_as_a_box_or_a_polygon_with_holes():
    corner, kitchen = plan_of([ROOM, CORNER], ()).places
    assert (kitchen.name, kitchen.label, kitchen.class_) == ("kitchen1", "kitchen", "Kitchen")
    assert (kitchen.floor, kitchen.height) == (0.0, 2.5)
    (ring,) = kitchen.rings
    assert area(ring) == pytest.approx(36.0)
    assert (corner.name, corner.part, corner.forbidden) == ("corner1", False, False)
    drawn = structs.replace(
        ROOM, pose=structs.replace(ROOM.pose, position_m=(2.0, 1.0, 0.5)), size_m=(4.0, 2.0, 2.5)
    )
    (place,) = plan_of([said(drawn, "Building_Subparts", hasExtent=SQUARE, isForbidden=True)], ()).places
    outer, hole = place.rings
    assert (area(outer), area(hole)) == (pytest.approx(8.0), pytest.approx(-1.0))
    assert (place.part, place.forbidden, place.floor, place.height) == (True, True, 0.5, 2.5)


@pytest.mark.parametrize(
    ("entities", "walls", "notes"),
    [
        ([ROOM], None, (NO_WALLS,)),
        ([ROOM], (), (NO_WALLS,)),
        ([ROOM], (WALL,), ()),
        ([ROOM, thing("wall1", (0.0, 0.0, 0.0), "wall", size=(4.0, 0.1, 2.5))], None, ()),
        ([BOX], None, ()),
    ],
    ids=["unknown", "none", "of the world", "of the map", "no place"],
)
def test_a_plan_without_walls_has_a_note(entities, walls, notes):
    plan = plan_of(entities, walls)
    assert (plan.notes, plan.walls) == (notes, walls or ())
