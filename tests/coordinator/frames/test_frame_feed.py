"""Commands and replies in frames, without Zenoh."""

from __future__ import annotations

from concurrent.futures import Future
from types import SimpleNamespace

import pytest
from msgspec import structs

from semmap.nodes.coordinator.frames.feed import Frames
from semmap.nodes.runtime.futures import settle
from semmap.schemas import commands as c
from semmap.schemas import errors, keys
from semmap.schemas.commits import Effects
from semmap.schemas.entities import Pose
from semmap.schemas.frames import FramePose
from semmap.schemas.relations import Described
from semmap.schemas.scenes import CameraPose
from tests.coordinator.reconciler.test_scene_report import body, entity
from tests.fake_node import FakeNode, FakeStream

PART = {"isDirectPartOf": "cart1"}


def at(x):
    return Pose(position_m=(x, 0.0, 0.0))


class Room:
    """A map with a cart, its tray and a box, the published frame `tool1` on the cart, and a camera."""

    def __init__(self, monkeypatch):
        self.stream = FakeStream()
        monkeypatch.setattr("semmap.nodes.bus.NewestSamples", lambda *_, **__: self.stream)
        self.entities = {
            "cart1": entity("cart1", pose=at(10.0)),
            "tray1": entity("tray1", pose=at(10.5), properties=PART),
            "box1": entity("box1", pose=at(3.0)),
        }
        live = SimpleNamespace(live_pose=lambda one: None, scene_age_s=lambda: 0.0)
        self.scene = SimpleNamespace(known=False, bodies={})
        self.cameras, self.asked, self.made = (), [], None
        kb = SimpleNamespace(ask_later=self.ask_kb)
        scheduler = SimpleNamespace(run_after=lambda execute: execute())
        self.frames = Frames(
            FakeNode(lambda call: None),
            2.0,
            SimpleNamespace(entities=self.entities),
            live,
            self.scene,
            self.ask_sim,
            kb,
            scheduler,
        )
        self.handled = []
        self.do = self.frames.in_map_frame(self.handle)

    def ask_sim(self, call):
        self.asked.append(call)
        future = Future()
        if isinstance(self.cameras, Exception):
            future.set_exception(self.cameras)
        else:
            future.set_result(self.cameras)
        return future

    def ask_kb(self, call):
        future = Future()
        settle(future, lambda: (self.made,))
        return future

    def handle(self, command):
        self.handled.append(command)
        if isinstance(command, c.Get):
            return described(self.entities[command.name])
        return tuple(self.entities.values()) if isinstance(command, c.List) else "done"

    def publish(self, name, x, parent="cart1"):
        self.stream.samples.append((keys.frame_key(name), FramePose(at=(x, 0.0, 0.0), parent=parent)))


def described(one):
    return Described(**{name: getattr(one, name) for name in one.__struct_fields__ if name != "in_space"})


@pytest.fixture
def room(monkeypatch):
    return Room(monkeypatch)


ADD = c.Add(class_="Cup", at=(1.0, 0.0, 0.0), frame="cart1")


def test_a_position_is_converted_from_the_frame_of_an_entity_or_of_a_publisher(room):
    assert room.do(ADD) == "done"
    assert room.handled[-1] == structs.replace(ADD, at=(11.0, 0.0, 0.0), frame=None)
    room.publish("tool1", 2.0)
    room.do(structs.replace(ADD, frame="tool1"))
    assert room.handled[-1].at == (13.0, 0.0, 0.0)
    assert room.asked == []


def test_a_command_without_a_frame_is_handled_as_it_is(room):
    plain = structs.replace(ADD, frame=None)
    assert room.do(plain) == "done"
    assert room.handled == [plain]


def test_a_frame_without_a_position_or_an_unknown_one_is_an_error(room):
    with pytest.raises(errors.BadRequest, match="position in cart1 is missing"):
        room.do(c.Add(class_="Cup", frame="cart1"))
    with pytest.raises(errors.UnknownName, match="unknown frame 'crat1'"):
        room.do(structs.replace(ADD, frame="crat1"))
    assert room.handled == []


CAMERA = CameraPose(camera="eye1", part_of="cart1", pose=at(11.0))


def test_the_simulator_is_asked_for_cameras_if_a_frame_is_missing(room):
    room.scene.known, room.cameras = True, (CAMERA,)
    made = room.do(structs.replace(ADD, frame="eye1"))
    assert made.result() == "done"
    assert room.handled[-1].at == (12.0, 0.0, 0.0)
    room.do(ADD)
    assert len(room.asked) == 1


def test_a_simulator_that_has_ended_has_no_cameras(room):
    room.scene.known, room.cameras = True, errors.NoAnswer("it has ended")
    with pytest.raises(errors.UnknownName, match="unknown frame 'eye1'"):
        room.do(structs.replace(ADD, frame="eye1")).result()


def test_a_reply_is_in_the_frame_and_names_it(room):
    found = room.do(c.Get(name="box1", frame="cart1")).result()
    assert (found.frame, found.pose.position_m) == ("cart1", (-7.0, 0.0, 0.0))
    listed = room.do(c.List(frame="cart1")).result()
    assert [one.pose.position_m[0] for one in listed] == [0.0, 0.5, -7.0]


def test_a_part_is_where_its_whole_is_now(room):
    room.scene.bodies["cart1"] = body("cart1", pose=at(20.0), robot=True)
    tray = room.do(c.Get(name="tray1", frame="map")).result()
    assert tray.pose.position_m[0] == pytest.approx(20.5)
    assert room.do(c.Get(name="box1", frame="map")).result().pose == at(3.0)
    room.entities["tray1"] = structs.replace(room.entities["tray1"], tracked="stream")
    assert room.do(c.Get(name="tray1", frame="map")).result().pose == at(10.5)


@pytest.mark.parametrize(
    ("command", "repeats"),
    [
        (structs.replace(ADD, id="1", frame="gone1"), True),
        (c.Update(name="box1", at=(1.0, 0.0, 0.0), id="1", frame="gone1"), True),
        (structs.replace(ADD, frame="gone1"), False),
        (structs.replace(ADD, id="1", frame="gone1", dry_run=True), False),
        (c.Move(name="box1", at=(1.0, 0.0, 0.0), frame="gone1"), False),
    ],
)
def test_a_repeated_change_is_answered_though_its_frame_is_gone(room, command, repeats):
    room.made = Effects(seq=4, id="1", reason="add Cup cup1")
    if repeats:
        assert room.do(command).result().text == "already done: add Cup cup1"
        room.made = None
        with pytest.raises(errors.UnknownName):
            room.do(command).result()
    else:
        with pytest.raises(errors.UnknownName):
            room.do(command)


def test_all_frames_are_listed_with_those_of_cameras(room):
    room.publish("tool1", 2.0)
    assert [frame.name for frame in room.frames.list(c.ListFrames())] == [
        "map",
        "box1",
        "cart1",
        "tool1",
        "tray1",
    ]
    room.scene.known, room.cameras = True, (CAMERA,)
    listed = room.frames.list(c.ListFrames(name="eye1")).result()
    assert [(frame.name, frame.parent) for frame in listed] == [
        ("map", ""),
        ("cart1", "map"),
        ("eye1", "cart1"),
    ]


def test_invalid_frames_are_problems(room):
    room.stream.samples.append((keys.frame_key("tool1"), errors.BadRequest("malformed message")))
    room.frames.list(c.ListFrames())
    (problem,) = room.frames.problems()
    assert "malformed message" in problem
