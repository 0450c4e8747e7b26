import math

import pytest
from msgspec import structs

from semmap.nodes.navigation.path_planning import find_path, parse_position
from semmap.schemas.errors import Refused
from semmap.schemas.plans import HEIGHTS_M
from tests.navigation.made import DOOR, PLACES, box, door, place, plan, thing


def way(made, start, end, radius=0.25, heights=HEIGHTS_M):
    return find_path(made, start, end, radius, heights)


def test_a_way_leads_through_the_door_and_is_as_long_as_a_taut_string():
    found = way(plan(DOOR), (1.0, 1.45), (7.0, 1.45))

    assert (found.places, found.doors, found.closed) == (("west", "east"), ("door1",), ())
    assert found.metres == pytest.approx(6.0, abs=0.1)
    bent = way(plan(DOOR), (1.0, 4.5), (7.0, 4.5))
    taut = math.dist((1.0, 4.5), (4.05, 1.65)) + math.dist((4.05, 1.65), (7.0, 4.5))
    assert taut - 0.05 <= bent.metres <= taut * 1.08
    assert bent.metres == pytest.approx(
        sum(math.dist(a, b) for a, b in zip(bent.points, bent.points[1:], strict=False)), abs=0.01
    )


def test_a_closed_door_is_told_with_what_opening_it_makes():
    found = way(plan(structs.replace(DOOR, open=False)), "west", "east")

    assert found.closed == ("door1",)
    assert found.text.startswith(
        "no route is open from west to east: door1 is closed; with it open, the route is "
    )
    assert way(plan(structs.replace(DOOR, open=True)), "west", "east").closed == ()


def test_an_open_door_is_preferred_to_a_shorter_way_through_a_closed_one():
    walls = (*plan().walls[:5], box(4.0, 1.9, 4.1, 3.6), box(4.0, 4.5, 4.1, 5.0))
    far = door("door2", 4.02, 3.61, 4.08, 4.49)
    found = way(plan(structs.replace(DOOR, open=False), far, walls=walls), (3.0, 1.45), (5.0, 1.45))

    assert (found.doors, found.closed) == (("door2",), ())
    assert found.metres > 5.0


def test_what_stands_in_the_way_is_named():
    block = thing("crate1", box(3.2, 0.5, 3.9, 2.5, high=1.0))
    with pytest.raises(Refused, match=r"no route from west to east .*: crate1 is in the way"):
        way(plan(DOOR, block), "west", "east")
    assert way(plan(DOOR, block), "west", "east", heights=(1.2, 1.5)).metres > 3.0
    assert way(plan(DOOR, thing("rug1", box(3.2, 0.5, 3.9, 2.5, high=0.02))), "west", "east").metres > 3.0


def test_who_is_too_wide_for_the_door_is_told_so():
    with pytest.raises(Refused, match=r"for a robot 1.2 m wide: no door or"):
        way(plan(DOOR), "west", "east", radius=0.6)
    assert way(plan(DOOR), "west", "east", radius=0.4).metres > 3.0


def test_forbidden_places_are_gone_around_or_named():
    middle = place("middle", 3.0, 0.0, 3.8, 5.0, forbidden=True, part=True)
    corner = place("corner", 3.0, 3.0, 3.8, 5.0, forbidden=True, part=True)
    with pytest.raises(Refused, match="every route leads through middle, which is forbidden"):
        way(plan(DOOR, places=(*PLACES, middle)), "west", "east")
    assert way(plan(DOOR, places=(*PLACES, corner)), "west", "east").metres > 3.0


def test_what_is_in_a_forbidden_place_is_not_reached_and_that_is_said():
    west, east = PLACES
    made = plan(
        DOOR, thing("crate1", box(6.0, 2.0, 7.0, 3.0)), places=(west, structs.replace(east, forbidden=True))
    )
    for end in ("east", "crate1", (5.0, 1.0)):
        with pytest.raises(Refused, match="through east, which is forbidden"):
            way(made, "west", end)


def test_things_are_reached_beside_them_in_their_own_room():
    shelf = thing("shelf1", box(4.1, 3.0, 4.5, 4.0, high=1.8))
    found = way(plan(DOOR, shelf), (3.0, 3.5), "shelf1")

    assert found.places == ("west", "east")
    assert found.doors == ("door1",)


def test_without_walls_the_gaps_between_places_are_walls():
    found = way(plan(DOOR, walls=()), "west", "east")

    assert found.doors == ("door1",)
    with pytest.raises(Refused, match="no door or opening"):
        way(plan(walls=()), "west", "east")


def test_positions_without_room():
    crate = thing("crate1", box(1.0, 1.0, 3.0, 3.0, high=1.0))
    with pytest.raises(Refused, match=r"no room for a robot 0.5 m wide at \(2, 2\): crate1 is in the way"):
        way(plan(crate), (2.0, 2.0), "west")
    with pytest.raises(Refused, match="it is outside every place of the map"):
        way(plan(), (20.0, 2.0), "west")
    with pytest.raises(Refused, match="ghost1 has no position or size"):
        way(plan(), "ghost1", "west")


def test_places_that_are_made_up_of_others_are_not_on_the_way():
    flat = place("flat", -0.1, -0.1, 8.1, 5.1)

    assert way(plan(DOOR, places=(flat, *PLACES)), "west", "east").places == ("west", "east")


def test_a_map_that_is_too_large_is_refused():
    with pytest.raises(Refused, match="too large for route planning"):
        way(plan(places=(place("plain", 0.0, 0.0, 5000.0, 5000.0),), walls=()), (1.0, 1.0), (2.0, 2.0))


@pytest.mark.parametrize(
    ("word", "found"),
    [
        ("2.5,1", (2.5, 1.0)),
        ("-1, 2", (-1.0, 2.0)),
        ("(3 4)", (3.0, 4.0)),
        ("kitchen", None),
        ("2", None),
        ("1.2.3,4", None),
    ],
)
def test_positions_as_words(word, found):
    assert parse_position(word) == found
