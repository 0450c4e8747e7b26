"""Places with polygon extents, one by one and many at once."""

import random

import pytest
from msgspec import structs

from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.geometry.solids import solid_of
from semmap.nodes.kb_node.relations.measuring import places, proximity
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.schemas.entities import Pose
from semmap.schemas.polygons import EXTENT, box_around, read_wkt
from tests.kb_node.relations.entities import thing
from tests.kb_node.relations.facts.test_many_at_once import at_once, kept, one_by_one

L_SHAPE = "POLYGON ((0 0, 6 0, 6 2, 2 2, 2 5, 0 5, 0 0))"
COURT = "POLYGON ((-1 -1, 9 -1, 9 9, -1 9, -1 -1), (0 0, 0 5, 6 5, 6 0, 0 0))"


def place(name, wkt, z=0.0):
    at, size = box_around(read_wkt(wkt), z, 2.5)
    return structs.replace(thing(name, at, size=size, place=True), properties={EXTENT: wkt})


def place_of(space, name):
    found = space.spatial_relations(space.solids[name]).place
    return None if found is None else found[0].name


def test_the_polygon_counts_and_not_its_box():
    room, court = place("room1", L_SHAPE), place("court1", COURT)
    cups = {
        "cup1": (1.0, 4.0, 0.0),
        "cup2": (4.0, 4.0, 0.0),
        "cup3": (8.0, 8.0, 0.0),
        "cup4": (5.0, 1.0, 0.0),
    }
    space = Space([room, court, *(thing(name, at) for name, at in cups.items())])

    assert {name: place_of(space, name) for name in cups} == {
        "cup1": "room1",
        "cup2": None,
        "cup3": "court1",
        "cup4": "room1",
    }


def test_half_a_footprint_is_enough():
    space = Space([place("room1", L_SHAPE), thing("box1", (2.1, 3.0, 0.0), "", size=(1.0, 1.0, 1.0))])
    made = places.within(space.solids["box1"], space.solids["room1"], space.limits)

    assert made is not None
    assert (round(made.share, 9), made.holds) == (0.4, False)


STRIP = "POLYGON ((0 0, 2 0, 2 5, 0 5, 0 0))"
BOX = thing("box1", (1.0, 2.5, 0.0), size=(2.0, 5.0, 2.5), place=True)


@pytest.mark.parametrize(
    ("inner", "outer", "share"),
    [
        (place("a1", STRIP), place("b1", L_SHAPE), 1.0),
        (place("a1", L_SHAPE), place("b1", STRIP), 10.0 / 18.0),
        (place("a1", L_SHAPE), place("b1", L_SHAPE), 1.0),
        (place("a1", L_SHAPE), place("b1", COURT), 0.0),  # in its hole
        (place("a1", COURT), place("b1", L_SHAPE), 0.0),
        (place("a1", L_SHAPE), BOX, 10.0 / 18.0),
        (BOX, place("b1", L_SHAPE), 1.0),
        (place("a1", L_SHAPE), structs.replace(BOX, pose=Pose(position_m=(9.0, 9.0, 0.0))), 0.0),
        (place("a1", L_SHAPE, z=3.0), place("b1", L_SHAPE), 0.0),
    ],
)
def test_the_share_of_a_place_within_another(inner, outer, share):
    space = Space([inner, outer])
    one, other = space.solids[inner.name], space.solids[outer.name]
    made = places.within(one, other, space.limits, also_places=True)
    assert made.share == pytest.approx(share)
    assert made.holds == (share >= 0.5)
    assert places.within(one, other, space.limits) is None


def test_without_a_size_the_position_counts():
    space = Space(
        [place("room1", L_SHAPE), thing("x1", (1.0, 4.0, 0.0), ""), thing("x2", (4.0, 4.0, 0.0), "")]
    )

    assert [place_of(space, name) for name in ("x1", "x2")] == ["room1", None]


def test_distances_are_those_of_the_polygon():
    space = Space([place("room1", L_SHAPE), thing("box1", (4.0, 4.0, 0.0), "", size=(1.0, 1.0, 1.0))])

    assert proximity.gap(space.solids["box1"], space.solids["room1"]) == 1.5
    assert proximity.gap(space.solids["room1"], space.solids["box1"]) == 1.5


def test_floor_and_height_count():
    upstairs = place("room2", L_SHAPE, z=3.0)
    space = Space([place("room1", L_SHAPE), upstairs, thing("cup1", (1.0, 1.0, 3.0))])

    assert place_of(space, "cup1") == "room2"


def test_a_rotated_place_survives_encoding():
    room = place("room1", L_SHAPE)
    one, other = solid_of(room), solid_of(PlacedEntity.of(room))

    assert one.form is other.form
    assert one.footprint == 18.0


def test_a_survey_equals_single_measurements():
    chance = random.Random(5)
    there = [
        place("room1", L_SHAPE),
        place("court1", COURT),
        thing("hall1", (4.0, 4.0, 0.0), size=(20.0, 20.0, 3.0), place=True),
    ]
    for k in range(300):
        at = (chance.uniform(-2, 10), chance.uniform(-2, 10), 0.0)
        there.append(thing(f"cup{k}", at, yaw=chance.choice((0.0, 0.7))))
        if k % 10 == 0:
            there.append(thing(f"table{k}", (at[1], at[0], 0.0), yaw=chance.uniform(0, 3)))
    one, other = one_by_one(there), at_once(there)

    assert kept(one) == kept(other)
    found = {other for of in kept(one)[0][0].values() for _, other in of} | {
        other for of, _ in kept(one) for about in of.values() for _, other in about
    }
    assert {"room1", "court1", "hall1"} <= found


def test_a_changed_extent_changes_the_contents():
    cup = thing("cup1", (4.0, 4.0, 0.0))
    facts = one_by_one([place("room1", L_SHAPE), cup])
    assert not facts.holds(("cup1", "isLocatedIn", "room1"))

    wider = structs.replace(place("room1", "POLYGON ((0 0, 6 0, 6 5, 0 5, 0 0))"))
    assert wider.pose == Pose(position_m=(3.0, 2.5, 0.0))
    facts.update([wider])
    assert facts.holds(("cup1", "isLocatedIn", "room1"))


def test_clearing_the_cache_keeps_the_region():
    room = place("room1", L_SHAPE)
    space = Space([room])
    solid = space.solids["room1"]
    outline, area = solid.outline, solid.footprint
    solid.clear_cache()
    space.put(thing("cup1", (4.0, 1.0, 0.0)))
    assert place_of(space, "cup1") == "room1"
    assert (solid.outline, solid.footprint) == (outline, area)
