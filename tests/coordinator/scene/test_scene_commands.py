from concurrent.futures import Future
from types import SimpleNamespace

import pytest

from nodes.coordinator.scene.scene_commands import Running
from schemas import commands as c
from schemas.entities import Pose
from schemas.scenes import BodiesMoved, Body


def cup(z: float, *, ghost: bool = False) -> Body:
    return Body(
        name="cup1",
        class_="Cup",
        model="cup",
        pose=Pose(position_m=(1.0, 2.0, z)),
        size_m=(0.1, 0.1, 0.1),
        fixed=False,
        entity=True,
        ghost=ghost,
        resting=False,
        commit=1,
        shape_commit=1,
    )


def said_of_a_move(z: float, put: Body) -> str:
    """What is said of a hand's move to (1, 2, z) when the simulator answers that it `put` the cup so."""

    def ask(_):
        future = Future()
        future.set_result(BodiesMoved(bodies=(put,), failed={}))
        return future

    keeping = SimpleNamespace(scene=SimpleNamespace(bodies={"cup1": put}))
    door = SimpleNamespace(hands=SimpleNamespace(let_go=lambda command: None))
    running = Running("map", door, keeping, ask)
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
    ],
)
def test_a_hand_says_where_it_let_go(z, put, said):
    assert said_of_a_move(z, put).startswith(said)
