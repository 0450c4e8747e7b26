import math
from concurrent.futures import Future
from types import SimpleNamespace

import pytest
from msgspec import structs

from semmap.nodes.coordinator.scene.completion import Completion
from semmap.nodes.coordinator.scene.scene_commands import SceneCommands
from semmap.schemas import commands as c
from semmap.schemas.entities import Pose
from semmap.schemas.scenes import BodiesMoved, Body


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
