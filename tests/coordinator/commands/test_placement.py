"""`on`, `in` and `next_to` of commands."""

import json
import math
from itertools import combinations
from types import SimpleNamespace

import pytest
from msgspec import structs

from semmap.nodes.coordinator.commands.placement import (
    at_room,
    make_request,
    place_described,
    placing_of,
)
from semmap.nodes.coordinator.kb_coroutines import run
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.bridge import Room
from semmap.schemas.entities import Pose, orientation_from_yaw
from semmap.schemas.scene_files import Described
from tests.coordinator.reconciler.test_reconcile import entity

SMALL = (0.1, 0.1, 0.1)
TABLE = c.Add(class_="Living_Room_Table", name="table1", at=(1.0, 1.0, 0.0), yaw=0.5, size=(1.2, 0.8, 0.7))


def add(dispatcher, name=None, size=SMALL, **fields):
    return dispatcher.change(c.Add(class_="Chair", name=name, size=size, **fields))


def test_an_object_is_placed_on_another_and_next_to_it(dispatcher):
    dispatcher.change(TABLE)
    reply = add(dispatcher, "toy1", on="table1")
    toy = dispatcher.map.entity("toy1")
    assert reply.text.startswith("added Chair toy1 on table1 at (")
    assert toy.pose.position_m[2] > 0.3
    assert toy.pose.yaw_rad == pytest.approx(0.5)
    beside = add(dispatcher, "toy2", next_to="toy1")
    assert beside.text.startswith("added Chair toy2 next to toy1 at (")
    assert dispatcher.map.entity("toy2").pose.position_m[2] == pytest.approx(toy.pose.position_m[2])


def test_an_update_places_it_and_keeps_its_orientation(dispatcher):
    dispatcher.change(TABLE)
    add(dispatcher, "toy1", at=(4.0, 4.0, 0.0), yaw=0.2)
    reply = dispatcher.change(c.Update(name="toy1", on="table1"))
    assert reply.text.startswith("updated toy1")
    assert reply.text.endswith(", on table1")
    assert dispatcher.map.entity("toy1").pose.yaw_rad == pytest.approx(0.2)


def test_objects_placed_one_after_the_other_stand_apart(dispatcher):
    dispatcher.change(TABLE)
    for _ in range(3):
        add(dispatcher, on="table1")
    positions = [dispatcher.map.entity(f"chair{n}").pose.position_m for n in (1, 2, 3)]
    assert min(math.dist(one, other) for one, other in combinations(positions, 2)) > 0.1


@pytest.mark.parametrize(
    ("fields", "error", "reason"),
    [
        ({"on": "tabel1"}, errors.UnknownName, "no entity is named 'tabel1'; did you mean table1"),
        ({"on": "table1", "at": (0.0, 0.0, 0.0)}, errors.BadRequest, "give only one of --on and --at"),
        ({"on": "table1", "next_to": "table1"}, errors.BadRequest, "give only one of --on and --next-to"),
        ({"in_": "table1"}, errors.Refused, "table1 has no interior"),
        ({"on": "table1", "size": (5.0, 5.0, 1.0)}, errors.Refused, "does not fit on table1"),
    ],
)
def test_a_placement_that_is_not_possible_adds_nothing(dispatcher, fields, error, reason):
    dispatcher.change(TABLE)
    with pytest.raises(error, match=reason):
        add(dispatcher, "toy1", **fields)
    assert set(dispatcher.map.entities) == {"table1"}


def test_a_place_and_the_object_itself_are_not_placed(dispatcher):
    dispatcher.change(TABLE)
    with pytest.raises(errors.Refused, match="kitchen1 is a place and is not placed on an object; give --at"):
        dispatcher.change(c.Add(class_="Kitchen", name="kitchen1", on="table1"))
    with pytest.raises(errors.Refused, match="table1 cannot be placed next to itself; name another entity"):
        dispatcher.change(c.Update(name="table1", next_to="table1"))


def test_a_batch_places_by_position(dispatcher):
    dispatcher.change(TABLE)
    add(dispatcher, "toy1", at=(3.0, 1.0, 0.0))
    with pytest.raises(errors.BadRequest, match="a change in a batch is placed by its position; give at"):
        dispatcher.change(c.Batch(changes=(c.Update(name="toy1", on="table1"),)))


def test_a_move_is_placed_with_its_contents(dispatcher):
    dispatcher.change(TABLE)
    add(dispatcher, "toy1", at=(3.0, 1.0, 0.0))
    command = c.Move(name="toy1", on="table1", carry=True)
    request = make_request(dispatcher.map, command, placing_of(command), "toy1", None)
    assert (request.target, request.placing, request.carry) == ("table1", "on", True)
    found = Pose(position_m=(1.0, 2.0, 3.0), orientation_wxyz=orientation_from_yaw(0.0))
    assert at_room(command, Room(pose=found)) == c.Move(name="toy1", at=(1.0, 2.0, 3.0), carry=True)


def scene(*entities):
    return c.Load(content=json.dumps({"entities": entities}).encode(), filename="room.json")


def toy(name, **fields):
    return {"class": "Chair", "name": name, "size": SMALL, **fields}


BENCH = {
    "class": "Living_Room_Table",
    "name": "table1",
    "at": [1, 1, 0],
    "yaw": "90deg",
    "size": [1.2, 0.8, 0.7],
}


def test_a_scene_places_objects_on_those_before_them(dispatcher):
    dispatcher.change(
        scene(BENCH, toy("toy1", on="table1"), toy("toy2", on="table1"), toy("toy3", next_to="toy1"))
    )
    toys = [dispatcher.map.entity(f"toy{n}").pose.position_m for n in (1, 2, 3)]
    assert [z for _, _, z in toys] == pytest.approx([0.7] * 3)
    assert min(math.dist(one, other) for one, other in combinations(toys, 2)) > 0.1


def test_a_scene_that_is_loaded_again_leaves_placed_objects_where_they_are(dispatcher):
    file = scene(BENCH, toy("toy1", on="table1"), toy("toy2", on="table1"))
    dispatcher.change(file)
    before = dispatcher.map.seq
    assert dispatcher.change(file).commit is None
    dispatcher.change(c.Update(name="toy2", at=(5.0, 5.0, 0.0)))
    dispatcher.change(file)
    assert dispatcher.map.entity("toy2").pose.position_m[2] == pytest.approx(0.7)
    assert dispatcher.map.seq == before + 2


def test_in_a_scene_that_replaces_the_map_the_old_objects_take_up_no_room(dispatcher):
    wide = toy("toy1", on="table1")
    wide["size"] = [1.1, 0.7, 0.2]
    dispatcher.change(scene(BENCH, wide))
    middle = dispatcher.map.entity("toy1").pose
    other = {**wide, "name": "toy2"}
    dispatcher.change(structs.replace(scene(BENCH, other), replace=True))
    assert set(dispatcher.map.entities) == {"table1", "toy2"}
    assert dispatcher.map.entity("toy2").pose == middle


@pytest.mark.parametrize(
    ("entities", "reason"),
    [
        (
            (toy("toy1", on="table1"), BENCH),
            "toy1: no entity before it in the file or in the map is named 'table1'",
        ),
        ((BENCH, toy("toy1", on="table1", at=[0, 0, 0])), "give only one of on and at"),
        ((BENCH, toy("toy1", in_="table1")), "there is no field 'in_'; did you mean in"),
        ((BENCH, {**toy("toy1", **{"in": "table1"})}), "table1 has no interior"),
    ],
)
def test_a_scene_with_a_placement_that_is_not_possible_adds_nothing(dispatcher, entities, reason):
    with pytest.raises(errors.SemmapError) as error:
        dispatcher.change(scene(*entities))
    assert reason in error.value.text
    assert not dispatcher.map.entities


@pytest.mark.parametrize("note", ["", "cup1 is close to the edge of table1"])
def test_each_note_about_the_room_of_a_scene_s_objects_is_reported_once(note):
    items = [
        (name, Described(class_="Cup", on="table1"), SimpleNamespace(place=False, model="cup"))
        for name in ("cup1", "cup2")
    ]
    table = entity("table1", Pose(position_m=(0.0, 0.0, 0.0)))
    asked = []

    def answer(call):
        asked.append(call)
        return Room(pose=Pose(position_m=(0.0, 0.0, 0.7)), note=note)

    placed, notes = run(place_described(items, {"table1": table}, replace=False), answer)
    assert notes == ((note,) if note else ())
    assert [(name, item.at, item.on) for name, item, _ in placed] == [
        ("cup1", (0.0, 0.0, 0.7), None),
        ("cup2", (0.0, 0.0, 0.7), None),
    ]
    assert [[other.name for other in call.others] for call in asked] == [[], ["cup1"]]
