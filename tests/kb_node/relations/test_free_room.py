"""Room for an object on, in or next to another one."""

import json
import math
from itertools import combinations

import pytest
from msgspec import structs

from semmap.nodes.geometry.polygons import clipped
from semmap.nodes.kb_node.relations.free_room import find_room
from semmap.nodes.kb_node.relations.measuring import proximity
from semmap.nodes.kb_node.relations.measuring.arrangement import measure_next_to
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.sim_node.models.library import build
from semmap.nodes.sim_node.models.variety_table import KINDS
from semmap.ontology import MODEL_SHAPES_JSON
from semmap.schemas.bridge import FindRoom
from semmap.schemas.errors import Refused
from tests.kb_node.relations.entities import ROOM, TABLE, TOP, thing

SHAPES = json.loads(MODEL_SHAPES_JSON.read_bytes())
FRIDGE = thing("fridge1", (2.0, 0.0, 0.0))


def put(space, placing, target, name="cup1", model="cup", **fields):
    """Find room for an object and put it there."""
    found = find_room(space, FindRoom(name=name, model=model, placing=placing, target=target, **fields), None)
    space.put(
        thing(name, found.pose.position_m, model, turn=found.pose.orientation_wxyz, size=fields.get("size_m"))
    )
    return found


def relations(space, name):
    container, supports, place = space.spatial_relations(space.solids[name])
    return (
        container[0].name if container else None,
        [support.name for support, _ in supports],
        place[0].name if place else None,
    )


def test_ten_cups_on_a_table_stand_apart():
    space = Space([ROOM, TABLE])
    for number in range(10):
        put(space, "on", "table1", f"cup{number}")
    assert all(relations(space, f"cup{n}") == (None, ["table1"], "kitchen1") for n in range(10))
    cups = [space.solids[f"cup{n}"] for n in range(10)]
    assert all(proximity.touches(*both, space.limits) is None for both in combinations(cups, 2))


def test_the_first_is_in_the_middle_along_the_axes_of_a_turned_table():
    table = thing("table1", (1.0, 2.0, 0.0), yaw=0.5)
    found = put(Space([table]), "on", "table1")
    assert found.pose.position_m == pytest.approx((1.0, 2.0, TOP), abs=5e-3)
    assert found.pose.yaw_rad == pytest.approx(0.5)


def test_a_full_table_is_refused_with_what_takes_it_up():
    space = Space([TABLE, thing("box1", (0.0, 0.0, TOP), "", size=(0.8, 0.55, 0.3))])
    with pytest.raises(Refused, match=r"there is no room for box2 on table1: box1 take"):
        put(space, "on", "table1", "box2", "", size_m=(0.6, 0.5, 0.2))


def test_what_is_larger_than_the_surface_does_not_fit():
    with pytest.raises(Refused, match=r"table2 \(3 x 3 x 0.5 m\) does not fit on table1"):
        put(Space([TABLE]), "on", "table1", "table2", "table", size_m=(3.0, 3.0, 0.5))


def test_a_long_object_is_turned_to_fit():
    stool = thing("board1", (0.0, 0.0, 0.0), "", size=(0.3, 1.2, 0.4))
    found = put(Space([stool]), "on", "board1", "bar1", "", size_m=(1.0, 0.1, 0.1))
    assert math.degrees(found.pose.yaw_rad) == pytest.approx(90.0)


def test_a_large_object_is_put_where_it_just_fits():
    board = thing("board1", (0.0, 0.0, 0.0), "", size=(2.0, 1.0, 0.4))
    box = thing("box1", (0.0, -0.18, 0.4), "", size=(1.99, 0.64, 0.2))
    found = put(Space([board, box]), "on", "board1", "bar1", "", size_m=(1.9, 0.3, 0.1))
    assert 0.3 < found.pose.position_m[1] < 0.35


def test_a_given_orientation_is_kept():
    turned = thing("x1", (0.0, 0.0, 0.0), "", yaw=0.3).pose.orientation_wxyz
    assert put(Space([TABLE]), "on", "table1", orientation=turned).pose.orientation_wxyz == turned


def test_a_closed_refrigerator_takes_it_with_a_note():
    space = Space([ROOM, FRIDGE])
    found = put(space, "in", "fridge1", "milk1", "", size_m=(0.07, 0.07, 0.2))
    assert relations(space, "milk1")[0] == "fridge1"
    assert found.note == "fridge1 is closed"


def test_an_open_refrigerator_takes_it_without_a_note():
    fridge = structs.replace(FRIDGE, properties={"isOpen": True})
    assert put(Space([fridge]), "in", "fridge1", "milk1", "", size_m=(0.07, 0.07, 0.2)).note == ""


def test_a_room_takes_it_on_its_floor():
    space = Space([ROOM, TABLE])
    put(space, "in", "kitchen1", "chair1", "chair")
    assert relations(space, "chair1") == (None, [], "kitchen1")
    assert proximity.gap(space.solids["chair1"], space.solids["table1"]) > 0.01


@pytest.mark.parametrize(
    ("around", "target"),
    [
        pytest.param([ROOM, TABLE], "table1", id="on the floor of a room"),
        pytest.param([TABLE], "table1", id="on the ground"),
        pytest.param([TABLE, thing("bowl1", (0.3, 0.1, TOP))], "bowl1", id="on a table"),
        pytest.param([FRIDGE, thing("jar1", (2.0, 0.1, 0.03), "jar")], "jar1", id="in a refrigerator"),
    ],
)
def test_next_to_another_object_it_has_the_same_support(around, target):
    space = Space(around)
    put(space, "next_to", target)
    beside = measure_next_to(space, space.solids["cup1"], space.solids[target])
    assert beside is not None
    assert beside.holds
    assert not clipped(space.solids["cup1"].outline, space.solids[target].outline)  # not under it


def test_what_moves_with_it_takes_up_no_room():
    tray = thing("tray1", (0.0, 0.0, TOP))
    space = Space([TABLE, tray, thing("apple1", (0.0, 0.0, TOP + 0.015))])
    query = FindRoom(name="tray1", placing="on", target="table1")
    assert find_room(space, query, tray, ["apple1"]).pose.position_m == pytest.approx(
        (0.0, 0.0, TOP), abs=5e-3
    )
    assert {"tray1", "apple1"} <= space.solids.keys()


@pytest.mark.parametrize(
    ("placing", "target", "reason"),
    [
        ("on", "kitchen1", "kitchen1 is a place; for its floor use --in kitchen1"),
        ("next_to", "kitchen1", "kitchen1 is a place; for its floor use --in kitchen1"),
        ("in", "table1", "table1 has no interior"),
        ("in", "tray1", "tray1 is shallow, so things are on it; use --on tray1"),
        ("on", "lost1", "lost1 has no position, so nothing can be placed on it; first: semmap update lost1"),
        ("in", "ghost1", "the size of ghost1 is unknown; set it with: semmap update ghost1 --size X Y Z"),
        ("on", "fallen1", "fallen1 is tilted, so nothing can be placed on it"),
    ],
)
def test_where_nothing_can_be_placed_the_reason_is_given(placing, target, reason):
    fallen = thing("fallen1", (3.0, 3.0, 0.0), "table", turn=(math.cos(0.7), math.sin(0.7), 0.0, 0.0))
    tray, ghost = thing("tray1", (2.0, 0.0, 0.0)), thing("ghost1", (1.0, 1.0, 0.0), "unheard of")
    space = Space([ROOM, TABLE, fallen, tray, ghost])
    with pytest.raises(Refused) as error:
        put(space, placing, target)
    assert error.value.text.startswith(reason)


@pytest.mark.parametrize("model", ["table", "counter"])
def test_room_next_to_a_sink_in_a_top_is_on_the_top(model):
    counter = thing(f"{model}1", (0.0, 0.0, 0.0))
    top = counter.size_m[2]
    sink = structs.replace(thing("sink1", (0.0, 0.0, top - 0.2), "", size=(0.4, 0.4, 0.21)), fixed=True)
    space = Space([ROOM, counter, sink])
    assert relations(space, "sink1")[0] == counter.name
    put(space, "next_to", "sink1")
    assert relations(space, "cup1") == (None, [counter.name], "kitchen1")
    assert space.solids["cup1"].bottom == pytest.approx(top, abs=5e-3)
    assert measure_next_to(space, space.solids["cup1"], space.solids["sink1"]).holds


def test_an_object_without_a_size_is_refused():
    with pytest.raises(Refused, match="the size of thing1 is unknown, so no room can be found; give a size"):
        put(Space([TABLE]), "on", "table1", "thing1", "unheard of")


_TINY = (0.02, 0.02, 0.01)


SOLID = {"cup", "espresso_cup", "glass", "small_glass", "tall_glass", "tumbler"} | {
    name for name in KINDS if any(part.cavity for part in build(name, None).parts)
}
"""Models whose colliding parts fill their interior: drinking vessels, and those with a cavity."""
HOLLOW = [
    name
    for name, shape in SHAPES.items()
    if not all(interior.get("shallow") for interior in shape.get("interiors", ()))
]


@pytest.mark.parametrize("model", [name for name in HOLLOW if name not in SOLID])
def test_every_model_with_an_interior_takes_a_small_object(model):
    space = Space([thing("holder1", (1.0, 1.0, 0.0), model, yaw=0.4)])
    put(space, "in", "holder1", "tiny1", "", size_m=_TINY)
    assert relations(space, "tiny1")[0] == "holder1"


@pytest.mark.parametrize("model", sorted(SOLID))
def test_a_model_that_is_solid_in_the_simulator_takes_nothing(model):
    space = Space([thing("holder1", (1.0, 1.0, 0.0), model, yaw=0.4)])
    with pytest.raises(Refused, match="holder1 is solid in the simulator, so nothing can be placed in it"):
        put(space, "in", "holder1", "tiny1", "", size_m=_TINY)


@pytest.mark.parametrize(
    "model", ["table", "desk", "bed", "couch", "chair", "bookshelf", "counter", "stove", "box"]
)
def test_furniture_takes_a_small_object_on_top(model):
    space = Space([thing("support1", (1.0, 1.0, 0.0), model, yaw=0.4)])
    put(space, "on", "support1", "tiny1", "", size_m=_TINY)
    assert relations(space, "tiny1")[1] == ["support1"]
