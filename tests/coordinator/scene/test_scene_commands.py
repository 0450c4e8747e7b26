import math
from concurrent.futures import Future
from types import SimpleNamespace

import pytest
from msgspec import structs

from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.scene.completion import Completion
from semmap.nodes.coordinator.scene.scene_commands import SceneCommands
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.bridge import Room
from semmap.schemas.entities import BodyState, Pose
from semmap.schemas.replies import Done
from semmap.schemas.scenes import BodiesMoved, Body, DriveBase, Driven, PictureQuery
from tests.coordinator.reconciler.test_reconcile import at, entity


def cup(z: float, *, ghost: bool = False, in_the_way: str = "") -> Body:
    return Body(
        name="cup1",
        class_="Cup",
        model="cup",
        pose=Pose(position_m=(1.0, 2.0, z)),
        size_m=(0.1, 0.1, 0.1),
        fixed=False,
        entity=True,
        ghost=ghost,
        in_the_way=in_the_way,
        resting=False,
        commit=1,
        shape_commit=1,
    )


def running_with(bodies, ask, register):
    scene = SimpleNamespace(bodies=bodies, add=lambda bodies: None, run="", stamp_ns=0)
    reconciler = SimpleNamespace(scene=scene, when_placed=lambda name, execute: execute())
    dispatcher = SimpleNamespace(
        manual_moves=SimpleNamespace(register=register), map=SimpleNamespace(entities={})
    )
    return SceneCommands("map", dispatcher, reconciler, Completion("map", dispatcher, reconciler), ask, ask)


def said_of_a_move(z: float, put: Body) -> str:
    """Return the reply to a move to (1, 2, z), if the simulator `put` the cup there."""

    def ask(_):
        future = Future()
        future.set_result(BodiesMoved(bodies=(put,), failed={}))
        return future

    running = running_with({"cup1": put}, ask, lambda command, load: None)
    return running.move(c.Move(name="cup1", at=(1.0, 2.0, z))).result().text


@pytest.mark.parametrize(
    ("z", "put", "said"),
    [
        (0.5, cup(0.5), "put cup1 at (1, 2, 0.5) and released it"),
        (0.74, cup(0.7505), "put cup1 at (1, 2, 0.74) and released it"),
        (-3.0, cup(0.0005), "put cup1 at (1, 2, 0.00), the lowest free place there, and released it"),
        (
            0.5,
            cup(0.5, ghost=True),
            "put cup1 at (1, 2, 0.5), where it overlaps another body, so it does not",
        ),
        (
            0.5,
            cup(0.5, ghost=True, in_the_way="fridge1"),
            "put cup1 at (1, 2, 0.5), where it overlaps fridge1, so",
        ),
    ],
)
def test_a_move_reports_where_the_body_was_released(z, put, said):
    assert said_of_a_move(z, put).startswith(said)


def test_a_move_with_contents_keeps_their_relative_poses():
    """They move like a rigid body, by the poses of the bodies."""
    tray = structs.replace(cup(0.74), name="tray1")
    beside = structs.replace(cup(0.76), pose=Pose(position_m=(1.2, 2.0, 0.76)))
    asked, registered = [], []

    def answer(call):
        asked.append(call)
        future = Future()
        if call.VERB == "load-of":
            future.set_result(("cup1", "gone1"))
        else:
            moved = tuple(structs.replace(tray, name=p.name, pose=p.pose) for p in call.placements)
            future.set_result(BodiesMoved(bodies=moved, failed={}))
        return future

    running = running_with(
        {"tray1": tray, "cup1": beside}, answer, lambda command, load: registered.append(load)
    )
    move = c.Move(name="tray1", at=(5.0, 5.0, 0.5), yaw=math.pi / 2, carry=True, leave=("milk1",))
    said = running.move(move).result()
    assert said.text == "put tray1 at (5, 5, 0.5) and released it; cup1 moved with tray1"
    assert asked[0].leave == ("milk1",)
    there = {p.name: p.pose for p in asked[1].placements}
    assert there["cup1"].position_m == pytest.approx((5.0, 5.2, 0.52))
    assert there["cup1"].yaw_rad == pytest.approx(math.pi / 2, abs=1e-5)
    assert registered == [["cup1"]]


class World:
    """A scene with a robot and a cup: what is requested of the simulator, and how it replies."""

    def __init__(self, truth="map", *replies, known=True, state=None, room=None):
        self.asked, self.registered = [], []
        self._replies = list(replies)
        robot = structs.replace(cup(0.0), name="robot1", robot=True)
        self.bodies = {"cup1": cup(0.74), "robot1": robot} if known else {}
        scene = SimpleNamespace(bodies=self.bodies, add=lambda bodies: None, run="", stamp_ns=0, known=known)
        view = MapView()
        room1 = entity("room1", at(1.0, 2.0, 0.5, math.pi / 6), place=True)
        view.entities = {
            "shelf1": entity("shelf1", None),
            "room1": structs.replace(room1, size_m=(4.0, 2.0, 2.5)),
        }
        reconciler = SimpleNamespace(
            scene=scene,
            when_placed=lambda name, execute: execute(),
            body_state=lambda _: state or BodyState(status="none", detail="no model"),
            is_following=lambda names: False,
            place_all=lambda: self._answer(BodiesMoved(bodies=(cup(0.7),) * 3, failed={})),
        )
        dispatcher = SimpleNamespace(
            manual_moves=SimpleNamespace(
                register=lambda command, load=(): self.registered.append(command),
                renew=lambda: None,
                forget=lambda names: None,
            ),
            map=view,
        )
        self.commands = SceneCommands(
            truth,
            dispatcher,
            reconciler,
            Completion(truth, dispatcher, reconciler),
            self._ask,
            lambda call: self._answer(room),
        )

    def _ask(self, call):
        self.asked.append(call)
        return self._answer(self._replies.pop(0) if self._replies else None)

    @staticmethod
    def _answer(reply):
        if isinstance(reply, Future):
            return reply
        future = Future()
        if isinstance(reply, Exception):
            future.set_exception(reply)
        else:
            future.set_result(reply)
        return future


def driven(outcome, x=3.0, yaw=math.pi / 2):
    return Driven(name="robot1", outcome=outcome, pose=at(x, 2.0, 0.0, yaw))


THERE = c.Drive(name="robot1", to=((3.0, 2.0),), yaw=1.5, speed=0.2)


@pytest.mark.parametrize(
    ("command", "outcome", "text"),
    [
        (THERE, "driving", "robot1 is on its way from (3.00, 2.00), facing 90°"),
        (THERE, "there", "robot1 is at (3.00, 2.00), facing 90°"),
        (c.Drive(name="robot1", stop=True), "stopped", "robot1 stopped at (3.00, 2.00), facing 90°"),
    ],
)
def test_a_drive_without_wait_is_answered_by_the_simulator(command, outcome, text):
    world = World("map", driven(outcome))
    assert world.commands.drive(command).result().text == text
    assert world.asked == [
        DriveBase(name="robot1", to=command.to, yaw=command.yaw, speed=command.speed, wait=False)
    ]
    assert world.registered == [command]


@pytest.mark.parametrize(
    ("outcome", "reason"),
    [
        ("blocked", r"^robot1 is blocked at \(3\.00, 2\.00\) by an obstacle$"),
        ("fallen", r"^robot1 has fallen over at \(3\.00, 2\.00\); .* semmap move robot1"),
    ],
)
@pytest.mark.parametrize("wait", [False, True])
def test_a_drive_that_does_not_arrive_is_an_error(outcome, reason, wait):
    world = World("map", driven(outcome))
    with pytest.raises(errors.Refused, match=reason):
        world.commands.drive(structs.replace(THERE, wait=wait)).result()


def test_a_drive_with_wait_is_registered_while_it_is_under_way():
    ended = Future()
    world = World("map", ended)
    reply = world.commands.drive(structs.replace(THERE, wait=True))
    assert (reply.done(), len(world.registered)) == (False, 1)
    assert world.asked[0].wait
    ended.set_result(structs.replace(driven("there"), paused=True))
    assert reply.result().text == "robot1 is at (3.00, 2.00), facing 90°"


def test_a_simulator_that_ends_during_a_drive_is_an_error():
    world = World("map", errors.NoAnswer("the simulator ended"))
    with pytest.raises(errors.NoAnswer, match="the simulator ended"):
        world.commands.drive(structs.replace(THERE, wait=True)).result()


def test_a_drive_has_a_target_or_stops():
    world = World()
    for command in (c.Drive(name="robot1"), structs.replace(THERE, stop=True)):
        with pytest.raises(errors.BadRequest, match=r"use --to X Y, or --stop"):
            world.commands.drive(command)
    assert world.asked == []


def test_an_entity_without_a_body_is_not_driven_or_moved():
    world = World()
    with pytest.raises(errors.Refused, match=r"^shelf1 has no body to drive: no model$"):
        world.commands.drive(c.Drive(name="shelf1", to=((1.0, 1.0),)))
    with pytest.raises(errors.Refused, match=r"^shelf1 has no body to move: no model$"):
        world.commands.move(c.Move(name="shelf1", at=(1.0, 1.0, 0.0)))
    with pytest.raises(errors.UnknownName, match="no entity is named 'shelf2'; did you mean shelf1"):
        world.commands.move(c.Move(name="shelf2", at=(1.0, 1.0, 0.0)))


@pytest.mark.parametrize(
    ("name", "reason"), [("shelf1", "it is waiting"), ("shelf2", "no entity is named 'shelf2'")]
)
def test_a_body_that_is_still_to_be_created_may_fail(name, reason):
    world = World(state=BodyState(status="pending", detail="it is waiting"))
    with pytest.raises(errors.SemmapError, match=reason):
        world.commands.move(c.Move(name=name, at=(1.0, 1.0, 0.0)))


def test_nothing_is_moved_in_a_replay_or_without_a_position():
    with pytest.raises(errors.Refused, match="this scene is a replay of the past"):
        World("replayed").commands.move(c.Move(name="cup1", at=(1.0, 1.0, 0.0)))
    with pytest.raises(errors.BadRequest, match="missing position; give one of --at"):
        World().commands.move(c.Move(name="cup1"))
    with pytest.raises(errors.BadRequest, match="--leave requires --carry"):
        World().commands.move(c.Move(name="cup1", at=(1.0, 1.0, 0.0), leave=("cup2",)))


def test_a_move_that_the_simulator_rejects_is_an_error_and_nobody_s_move():
    world = World("map", BodiesMoved(bodies=(), failed={"cup1": "cup1 is attached to hand1"}))
    with pytest.raises(errors.Refused, match=r"^cup1 is attached to hand1$"):
        world.commands.move(c.Move(name="cup1", at=(1.0, 1.0, 0.0))).result()
    assert world.registered == []


@pytest.mark.parametrize(("x", "notes"), [(1.5, 0), (900.0, 1)])
def test_a_move_far_away_from_all_others_is_noted(x, notes):
    world = World("map", BodiesMoved(bodies=(cup(0.0),), failed={}))
    moved = world.commands.move(c.Move(name="cup1", at=(x, 2.0, 0.0))).result()
    assert len(moved.notes) == notes


@pytest.mark.parametrize("note", ["", "table1 is almost full"])
def test_a_move_onto_another_is_made_where_there_is_room(note):
    put = BodiesMoved(bodies=(cup(0.75),), failed={})
    world = World("map", put, room=Room(pose=at(1.0, 2.0, 0.75), note=note))
    moved = world.commands.move(c.Move(name="cup1", on="room1")).result()
    assert world.asked[0].placements[0].pose.position_m == (1.0, 2.0, 0.75)
    assert moved.notes == ((note,) if note else ())


@pytest.mark.parametrize(
    ("truth", "text"), [("map", "3 bodies"), ("scene", "3 bodies"), ("perceived", "all")]
)
def test_a_reset_returns_bodies_to_the_map_or_to_the_start(truth, text):
    world = World(truth, Done(text="all"))
    assert text in world.commands.reset(c.Reset()).result().text
    assert len(world.asked) == (truth == "perceived")


def test_a_pause_is_forwarded_and_answers_moves_that_wait():
    world = World("map", BodiesMoved(bodies=(cup(0.0),), failed={}), Done(text="paused"))
    reply = world.commands.move(c.Move(name="cup1", at=(1.0, 2.0, 0.0), wait=True))
    assert not reply.done()
    assert world.commands.pause(c.Pause()).result() == Done(text="paused")
    assert reply.result().notes != ()


def test_after_a_pause_moves_are_waited_for_again():
    reply = BodiesMoved(bodies=(cup(0.0),), failed={})
    world = World("map", Done(text="paused"), Done(text="running"), reply)
    world.commands.pause(c.Pause())
    assert world.commands.pause(c.Pause(off=True)).result() == Done(text="running")
    assert not world.commands.move(c.Move(name="cup1", at=(1.0, 2.0, 0.0), wait=True)).done()


def test_an_undo_stops_a_drive_where_the_robot_is_or_else_undoes_a_commit():
    world = World("map", Future(), driven("stopped", 2.5))
    assert world.commands.undo(c.Undo(), lambda command: "undone") == "undone"
    world.commands.drive(structs.replace(THERE, wait=True))
    stopped = world.commands.undo(c.Undo(), lambda command: "undone").result()
    assert stopped.text.startswith("stopped the drive of robot1 at (2.50, 2.00)")
    assert world.asked[1] == DriveBase(name="robot1")


def test_a_picture_is_of_a_camera_or_of_the_box_around_a_place():
    world = World()
    world.commands.render(c.TakePicture(camera="door", labels=True, width=64, height=32))
    assert world.asked == [PictureQuery(camera="door", labels=True, width=64, height=32)]
    world.commands.render(c.TakePicture(place="room1"))
    (low, high) = world.asked[1].box
    across, along = 2 * math.cos(math.pi / 6) + 0.5, 1.0 + math.cos(math.pi / 6)
    assert low == pytest.approx((1.0 - across, 2.0 - along, 0.5), abs=1e-6)
    assert high == pytest.approx((1.0 + across, 2.0 + along, 3.0), abs=1e-6)


def test_a_picture_is_not_of_two_things_or_of_an_object():
    with pytest.raises(errors.BadRequest, match="give either a camera or a place"):
        World().commands.render(c.TakePicture(camera="door", place="room1"))
    with pytest.raises(errors.Refused, match="shelf1 is not a place with a position and a size"):
        World().commands.render(c.TakePicture(place="shelf1"))


def test_without_a_simulator_commands_to_the_scene_have_no_answer():
    commands = World(known=False).commands
    for ask in (
        lambda: commands.pause(c.Pause()),
        lambda: commands.step(c.StepOnce()),
        lambda: commands.render(c.TakePicture()),
        lambda: commands.drive(THERE),
    ):
        with pytest.raises(errors.NoAnswer, match="no simulator is running"):
            ask()
