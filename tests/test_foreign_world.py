"""A world of third-party objects for minutes: objects at rest keep their name and place."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path

import pytest
from PIL import Image

from semmap.nodes import bus
from semmap.nodes.extern.client import Client
from semmap.nodes.training.scenes.foreign_things import ForeignThing, foreign_things
from semmap.schemas import keys
from semmap.schemas.changes import Change
from semmap.schemas.entities import Pose
from semmap.schemas.perception import Observations
from semmap.schemas.scenes import Scene, SceneQuery
from tests.conftest import running
from tests.data import data_folder

TOP_Z = 0.74
SETTLED_LOOKS = 40
"""The number of observations after which the tracks are stable."""
WATCHED_S, WATCHED_LOOKS = 120.0, 60
"""The duration of the observation afterwards."""
NEAR_M = 0.05
PLACES = (
    ("ycb 006_mustard_bottle", -0.45, 0.20, 0.4),
    ("ycb 002_master_chef_can", -0.15, 0.22, 0.0),
    ("ycb 004_sugar_box", 0.15, 0.22, 0.9),
    ("ycb 019_pitcher_base", 0.45, 0.18, 2.0),
    ("ycb 029_plate", -0.40, -0.15, 0.0),
    ("ycb 013_apple", -0.10, 0.00, 0.0),
    ("ycb 065-j_cups", 0.12, -0.02, 0.0),
    ("ycb 035_power_drill", 0.42, -0.12, -0.6),
    ("ycb 011_banana", -0.10, -0.20, 0.7),
    ("ycb 077_rubiks_cube", 0.15, -0.22, 0.3),
)
"""The things on the table, with positions from its middle [m] and yaw [rad]."""


@pytest.mark.long
def test_foreign_things_that_stand_still_are_each_known_once_and_left_alone(tmp_path):
    things = {thing.name: thing for thing in foreign_things(data_folder() / "foreign")}
    if not things:
        pytest.skip(f"no foreign things in {data_folder()}")
    world = tmp_path / "world.xml"
    world.write_text(written([(things[name], *place) for name, *place in PLACES], tmp_path))
    words = ("--world", world, "--truth", "perceived", "--perception", "--camera-noise", "--no-record")
    with running(tmp_path / "data", *words) as system, system.client() as client:
        looks: list[Observations] = []
        bus.follow(client.session, keys.OBSERVATIONS, lambda _, seen: looks.append(seen))
        await_looks(looks, SETTLED_LOOKS)
        known, began = poses(client), client.history(limit=1)[0].seq
        stand = stands(client)
        time.sleep(WATCHED_S)
        await_looks(looks, SETTLED_LOOKS + WATCHED_LOOKS)
        later = client.history(limit=200)
        assert not any(node.last_error for node in client.status().nodes)

    on_table = {name: pose for name, pose in known.items() if pose.position_m[2] > TOP_Z / 2}
    taken_for = {name: nearest(pose, stand) for name, pose in on_table.items()}
    assert len(set(taken_for.values())) == len(taken_for), f"doubles: {taken_for}"
    assert all(distance_m(on_table[name], stand[body]) < NEAR_M for name, body in taken_for.items())
    assert len(taken_for) >= len(PLACES) - 1, f"found: {taken_for}"

    since = [change for commit in later if commit.seq > began for change in commit.changes]
    assert not [(change.name, change.text) for change in since if change.kind in ("added", "removed", "pose")]
    assert not renamed_back(change for change in reversed(since) if change.kind == "class")


def test_a_class_that_returns_is_reported():
    def called(name: str, *classes: str) -> list[Change]:
        steps = pairwise(classes)
        return [Change(name=name, kind="class", was=was, now=now) for was, now in steps]

    assert not renamed_back([*called("a", "Object", "Cup"), *called("b", "Cup", "Object")])
    assert renamed_back(called("a", "Object", "Cup", "Object")) == {"a"}


def await_looks(looks: list[Observations], count: int) -> None:
    """Wait until perception has looked so often; on a busy machine that takes seconds each."""
    deadline = time.monotonic() + 8.0 * count
    while len(looks) < count:
        assert time.monotonic() < deadline, f"{len(looks)} looks of {count}"
        time.sleep(0.2)


def poses(client: Client) -> dict[str, Pose]:
    """Return the positions of things in the map."""
    return {entity.name: entity.pose for entity in client.list()}


def stands(client: Client) -> dict[str, Pose]:
    """Return the true positions of things."""
    scene = bus.ask(client.session, keys.SIM, "snapshot", SceneQuery(), Scene)
    return {body.name: body.pose for body in scene.bodies if body.name.startswith("foreign-")}


def nearest(pose: Pose, stand: dict[str, Pose]) -> str:
    return min(stand, key=lambda body: distance_m(pose, stand[body]))


def distance_m(one: Pose, other: Pose) -> float:
    """In the floor plan: how far a thing's middle is off."""
    return math.dist(one.position_m[:2], other.position_m[:2])


def renamed_back(changes: Iterable[Change]) -> set[str]:
    """Return the entities whose class changed back to an earlier one, the oldest change first."""
    were: dict[str, set[object]] = {}
    back = set()
    for change in changes:
        were.setdefault(change.name, set()).add(change.was)
        if change.now in were[change.name]:
            back.add(change.name)
    return back


def written(placed: list[tuple[ForeignThing, float, float, float]], folder: Path) -> str:
    """An MJCF world of a table with these on it, each a body with its own texture that falls and collides."""
    import trimesh

    assets, bodies = [], []
    for number, (thing, x, y, yaw) in enumerate(placed):
        low, high = trimesh.load_mesh(thing.mesh).bounds
        off = f"{-(low[0] + high[0]) / 2} {-(low[1] + high[1]) / 2} {-low[2]}"
        texture = folder / f"{number}.png"
        Image.open(thing.mesh.with_name("part0.jpg")).save(texture)
        assets.append(
            f'<mesh name="m{number}" file="{thing.mesh}" inertia="shell"/>'
            f'<texture name="t{number}" type="2d" file="{texture}"/>'
            f'<material name="t{number}" texture="t{number}" specular=".1"/>'
        )
        bodies.append(
            f'<body name="foreign-{number}" pos="{x} {y} {TOP_Z + 0.001}" euler="0 0 {math.degrees(yaw)}">'
            f'<freejoint/><geom type="mesh" mesh="m{number}" material="t{number}" pos="{off}" mass=".2"'
            ' condim="6" friction="1 .02 .02"/></body>'
        )
    return f"""<mujoco>
<visual><quality shadowsize="0" offsamples="0"/><headlight ambient=".4 .4 .4" diffuse=".5 .5 .5"/></visual>
<asset>{"".join(assets)}</asset>
<worldbody>
<light pos="0 0 3" dir="0 0 -1"/>
<geom name="floor" type="plane" size="4 4 .1" rgba=".8 .78 .72 1"/>
<geom name="top" type="box" size=".7 .45 .02" pos="0 0 {TOP_Z - 0.02}" rgba=".55 .4 .3 1"/>
<camera name="left" pos="-.9 -.9 1.6" xyaxes=".707 -.707 0 .4 .4 .82" fovy="45"/>
<camera name="right" pos=".9 -.9 1.6" xyaxes=".707 .707 0 -.4 .4 .82" fovy="45"/>
{"".join(bodies)}
</worldbody></mujoco>"""
