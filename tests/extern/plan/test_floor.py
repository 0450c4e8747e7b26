import math

import pytest
from msgspec import structs

from semmap.nodes.extern.plan.floor import floor_of, footprint
from semmap.ontology.model_shapes import own_size_m
from semmap.schemas.entities import Pose, orientation_from_yaw
from semmap.schemas.plans import Outline, Plan, PlannedThing
from tests.extern.plan.things import place, thing


def corners(outline):
    return sorted((round(x, 6), round(y, 6)) for x, y in outline)


def test_a_footprint_is_turned_as_the_thing_stands():
    pose = Pose(position_m=(1.0, 1.0, 0.0), orientation_wxyz=orientation_from_yaw(math.pi / 2))
    assert corners(footprint(pose, (2.0, 1.0, 3.0))) == [(0.5, 0.0), (0.5, 2.0), (1.5, 0.0), (1.5, 2.0)]


def test_a_footprint_of_what_lies_on_its_side_is_as_long_as_it_is_high():
    quarter = math.sqrt(0.5)
    lying = Pose(position_m=(0.0, 0.0, 0.5), orientation_wxyz=(quarter, 0.0, quarter, 0.0))
    assert corners(footprint(lying, (1.0, 0.5, 3.0))) == [
        (0.0, -0.25),
        (0.0, 0.25),
        (3.0, -0.25),
        (3.0, 0.25),
    ]


def test_a_flat_of_rooms_is_not_a_room_and_a_corner_is_part_of_one():
    flat = place("flat", (5.0, 2.0), (10.0, 4.0))
    rooms = (place("west", (2.4, 2.0), (4.8, 4.0)), place("east", (7.6, 2.0), (4.8, 4.0)))
    corner = place("corner", (1.0, 1.0), (1.5, 1.5))
    floor = floor_of((flat, *rooms, corner))
    assert {room.name for room in floor.rooms} == {"west", "east"}
    assert [zone.name for zone in floor.zones] == ["corner"]


def test_a_room_with_one_corner_stays_a_room():
    floor = floor_of((place("room", (0, 0), (4.0, 4.0)), place("corner", (0, 0), (3.5, 3.5))))
    assert [room.name for room in floor.rooms] == ["room"]


def test_a_place_may_have_a_polygon_of_its_own():
    triangle = ((0.0, 0.0), (4.0, 0.0), (0.0, 4.0))
    floor = floor_of([place("hall", (0, 0), (1.0, 1.0))], outlines={"hall": triangle})
    assert floor.rooms[0].outline == triangle
    assert floor.rooms[0].floor_m2 == pytest.approx(8.0)


def test_bodies_count_before_the_map():
    moved = Pose(position_m=(7.0, 0.0, 0.0))
    floor = floor_of([thing("table1")], {"table1": moved})
    assert corners(floor.pieces[0].outline)[0] == (6.5, -1.0)


@pytest.mark.parametrize(
    ("entity", "kind"),
    [
        (thing("table1"), "furniture"),
        (thing("door1", types=("Door",), size=(0.06, 0.9, 2.0)), "door"),
        (thing("window1", types=("Window",), size=(0.06, 0.9, 1.0)), "window"),
        (thing("ann", types=("Person",)), "person"),
        (thing("lamp1", at=(0, 0, 2.4)), "overhead"),
        (thing("cup1", at=(0, 0, 0.74), size=(0.08, 0.08, 0.1)), "small"),
    ],
)
def test_kinds(entity, kind):
    assert floor_of([entity]).pieces[0].kind == kind


def test_what_stands_on_something_is_drawn_after_it():
    names = [
        p.name for p in floor_of([thing("cup1", at=(0, 0, 0.74), size=(0.1,) * 3), thing("table1")]).pieces
    ]
    assert names == ["table1", "cup1"]


def test_what_has_no_position_or_size_is_counted():
    nowhere = structs.replace(thing("ghost"), pose=None)
    unknown = structs.replace(thing("blob"), size_m=None)
    floor = floor_of([nowhere, unknown])
    assert (floor.pieces, floor.unplaced) == ((), 2)


def test_an_object_without_a_size_has_that_of_its_body_or_model():
    cup = structs.replace(thing("cup1"), size_m=None, model="cup")
    (by_body,) = floor_of([cup], body_sizes_m={"cup1": (0.3, 0.2, 0.1)}).pieces
    assert corners(by_body.outline)[0] == (-0.15, -0.1)
    assert by_body.top_m == 0.1
    (by_model,) = floor_of([cup]).pieces
    x, y, z = own_size_m("cup")
    assert corners(by_model.outline)[0] == (round(-x / 2, 6), round(-y / 2, 6))
    assert by_model.top_m == z
    default_box = floor_of([structs.replace(cup, model="")], body_sizes_m={"cup1": (0.2, 0.2, 0.2)})
    assert (default_box.pieces, default_box.unplaced) == ((), 1)


def rectangle(x0, y0, x1, y1, top=0.7):
    return Outline(corners=((x0, y0), (x1, y0), (x1, y1), (x0, y1)), low=0.0, high=top)


def plan(name, *parts):
    about = {"name": name, "label": name, "class_": "Couch", "footprint": (), "parts": parts}
    return Plan(places=(), things=(PlannedThing(**about),))


CORNER = plan("couch1", rectangle(0.9, -1, 1, 1), rectangle(0, -1, 1, 0), rectangle(0.1, -0.9, 0.9, -0.1))


def test_an_object_has_the_outlines_of_its_parts_without_those_that_others_cover():
    couch = thing("couch1", size=(2.0, 2.0, 0.7))
    floor = floor_of([couch], plan=CORNER)
    (piece,) = floor.pieces
    assert [corners(part) for part in piece.parts] == [
        corners(rectangle(0, -1, 1, 0).corners),
        corners(rectangle(0.9, -1, 1, 1).corners),
    ]
    assert floor.bounds == (0, 1, -1, 1)
    assert [floor.at(point) for point in ((0.5, -0.5), (0.95, 0.5), (0.3, 0.3))] == ["couch1", "couch1", None]


def test_outlines_move_with_an_upright_object_and_a_tilted_one_is_its_box():
    couch = thing("couch1", size=(2.0, 2.0, 0.7))
    turned = Pose(position_m=(5.0, 5.0, 0.0), orientation_wxyz=orientation_from_yaw(math.pi / 2))
    (piece,) = floor_of([couch], {"couch1": turned}, plan=CORNER).pieces
    assert corners(piece.parts[0]) == [(5.0, 5.0), (5.0, 6.0), (6.0, 5.0), (6.0, 6.0)]
    quarter = math.sqrt(0.5)
    tilted = structs.replace(turned, orientation_wxyz=(quarter, quarter, 0.0, 0.0))
    (piece,) = floor_of([couch], {"couch1": tilted}, plan=CORNER).pieces
    assert piece.parts == ()
    assert len(piece.outline) == 4


def test_doors_and_objects_that_are_not_in_the_plan_are_boxes():
    door = thing("door1", types=("Door",), size=(0.06, 0.9, 2.0))
    (gap,) = floor_of([door], plan=plan("door1", rectangle(0, 0, 1, 1), rectangle(3, 3, 4, 4))).pieces
    assert corners(gap.outline) == [(-0.03, -0.45), (-0.03, 0.45), (0.03, -0.45), (0.03, 0.45)]
    (table,) = floor_of([thing("table1")], plan=CORNER).pieces
    assert (table.parts, corners(table.outline)[0]) == ((), (-0.5, -1.0))


def test_the_bounds_of_nothing_are_a_square_metre():
    assert floor_of([]).bounds == (0.0, 1.0, 0.0, 1.0)


def test_what_is_at_a_point_is_the_uppermost_thing_there():
    cup = thing("cup1", at=(0, 0, 0.74), size=(0.1, 0.1, 0.1))
    bay = ((-2.0, -2.0), (4.0, -2.0), (4.0, 4.0), (3.0, 4.0), (3.0, -1.0), (-2.0, -1.0))
    floor = floor_of([cup, thing("table1"), place("hall", (0, 0), (1, 1))], outlines={"hall": bay})
    assert [floor.at(point) for point in ((0.0, 0.0), (0.3, 0.0), (3.5, 3.0), (2.0, 3.0))] == [
        "cup1", "table1", "hall", None
    ]  # fmt: skip
