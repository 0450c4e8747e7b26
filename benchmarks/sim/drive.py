"""A drive through the flat with the robot's head camera: the entities that perception creates.

In one process and in simulated time, so that a busy machine changes nothing: the simulator's world with its
robot and camera, perception with its association, and a map that applies all updates.
"""

from __future__ import annotations

import json
import math
import random
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import mean
from typing import NamedTuple

from benchmarks.perception.tracking import ObedientMap
from benchmarks.table import Row
from semmap.nodes.extern.testing import own_system
from semmap.nodes.perception_node.config import TrackingConfig
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.projection import cloud_of
from semmap.nodes.perception_node.observer import Observer
from semmap.nodes.perception_node.pipeline import shipped
from semmap.nodes.perception_node.tracking.association import associate
from semmap.nodes.perception_node.tracking.class_hierarchy import ClassHierarchy, hierarchy_of
from semmap.nodes.perception_node.tracking.occupancy import occupancy_in
from semmap.nodes.perception_node.tracking.tracks import Tracks
from semmap.nodes.runtime.class_names import ClassNames
from semmap.nodes.sim_node.config import RobotConfig
from semmap.nodes.sim_node.models.sources import Models
from semmap.nodes.sim_node.robots.robot import SHIPPED
from semmap.nodes.sim_node.vision.camera import Eye
from semmap.nodes.sim_node.world import World
from semmap.nodes.sim_node.world_file import open_world
from semmap.schemas.entities import ClassInfo, Entity
from semmap.schemas.scenes import DriveBase

ROOMS = ("kitchen1", "livingroom1")
_AT = (6.6, 1.6)
_COURSE = (
    *(((6.6, 1.6), yaw) for yaw in (0.4, -0.4, -1.4)),
    *(((6.6, 2.7), yaw) for yaw in (-0.1, -0.9)),
    ((6.9, 3.3), -0.2),
    ((6.6, 1.6), -0.2),
    *(((7.4, 1.4), yaw) for yaw in (0.0, -1.57)),
    *(((9.5, 1.3), yaw) for yaw in (-1.57, -2.5, 2.4)),
    *(((9.7, 3.3), yaw) for yaw in (-2.1, -2.8)),
    ((9.5, 1.3), math.pi),
    ((6.6, 1.6), math.pi),
    *(((5.0, 1.8), yaw) for yaw in (math.pi, 2.4, -2.4)),
    *(((3.6, 1.9), yaw) for yaw in (math.pi, 2.2, 1.4, -2.2, -1.4)),
)
"""The stops of the course: position [m] and viewing direction [rad]."""
_ASIDE_M, _TURNED_RAD = 0.08, 0.12
"""The maximum offsets of the stops on other courses, along both axes and in yaw."""
_LOOKS_S = 2.0
_NEAR_M = 0.6
_WRONG_M = 0.2

_FRAME_S = 0.25
_ROBOT, _CAMERA = "robot1", "robot1_head"


class Said(NamedTuple):
    """The demo flat: `classes` of its TBox, all things except doors, and the things to be found."""

    classes: tuple[ClassInfo, ...]
    everything: list[Entity]
    things: list[Entity]


class Course(NamedTuple):
    """The result of a drive: the perceived entities, and how often the robot got stuck.

    `frame_ms`: mean CPU time of perception per frame, over `frames`.
    """

    seen: list[Entity]
    stuck: int
    frames: int
    frame_ms: float


class Score(NamedTuple):
    """The numbers of things found, of duplicates, and of misplaced ones."""

    found: float
    doubles: float
    wrong: float


def measure(folder: Path, drives: int = 1) -> list[Row]:
    """Return the share of things found, the duplicates, and the share of misplaced ones.

    The figures are means of several drives; the first one is the course itself.
    """
    said = _said(folder)
    started = time.monotonic()
    courses = [_drive(_world(folder, said), said.classes, stops(seed)) for seed in range(drives)]
    loose = _mean([score(said.things, course.seen) for course in courses])
    known = hierarchy_of(said.classes, {})
    scores = [score(said.things, course.seen, known) for course in courses]
    strict, total = _mean(scores), len(said.things)
    several = f", mean of {drives} drives" if drives > 1 else ""
    return [
        Row(f"drive: found of {total} things{several}", strict.found / total, "", 0.80, 0.92, more=True),
        Row("  doubles", strict.doubles, "", 0.0, 0.0),
        Row("  in a wrong place, over 20 cm, of those found", _share(strict), "", 0.05, 0.02),
        Row("  the worst of the drives", max(map(_share, scores)), ""),
        Row("  found, whatever it is taken for", loose.found / total, ""),
        Row("  in a wrong place, of those", _share(loose), ""),
        Row("  seen that is none of these things", mean(len(c.seen) for c in courses) - loose.found, ""),
        Row("  courses on which it got stuck", float(sum(course.stuck for course in courses)), ""),
        Row(
            f"  a frame, mean of {sum(course.frames for course in courses)}, CPU time",
            mean(course.frame_ms for course in courses),
            "ms",
        ),
        Row("  took", time.monotonic() - started, "s"),
    ]


def stops(seed: int) -> list[tuple[tuple[float, float], float]]:
    """Return the stops of a drive, (x, y) [m] and yaw [rad]; a seed adds random offsets."""
    if not seed:
        return list(_COURSE)
    chance = random.Random(seed)

    def about(value: float, spread: float) -> float:
        return value + chance.uniform(-spread, spread)

    return [((about(x, _ASIDE_M), about(y, _ASIDE_M)), about(yaw, _TURNED_RAD)) for (x, y), yaw in _COURSE]


def _said(folder: Path) -> Said:
    with own_system(folder / "said", "--no-record", "--no-sim") as client:
        doors = {e.name for e in client.list("Door")}  # they would be shut
        everything = [e for e in client.list() if not e.place and e.pose is not None and e.name not in doors]
        things = [e for name in ROOMS for e in client.list(in_=name) if _may_be_seen(e)]
        return Said(tuple(client.classes()), everything, things)


def _may_be_seen(thing: Entity) -> bool:
    return not thing.place and thing.pose is not None and not thing.fixed


def _described(thing: Entity) -> dict[str, object]:
    assert thing.pose is not None
    described: dict[str, object] = {
        "class": thing.class_,
        "name": thing.name,
        "at": thing.pose.position_m,
        "orientation": thing.pose.orientation_wxyz,
    }
    return described if thing.size_m is None else {**described, "size": thing.size_m}


def _world(folder: Path, said: Said) -> World:
    """Return the flat without walls and doors, with the robot."""
    path = folder / "world.json"
    path.write_text(json.dumps({"cameras": [], "entities": [_described(e) for e in said.everything]}))
    robot = RobotConfig(SHIPPED["porter"], _ROBOT, (*_AT, 0.0))
    return open_world(path, Models(None, None), classes=ClassNames(said.classes), robot=robot)


def _drive(
    world: World, classes: tuple[ClassInfo, ...], course: Sequence[tuple[tuple[float, float], float]]
) -> Course:
    """Drive along a course with an observation at each stop."""
    learnt = shipped()
    observer, hierarchy = Observer(learnt), hierarchy_of(classes, learnt.usual_m)
    believed, tracks, config = ObedientMap(), Tracks(), TrackingConfig()
    eye, stuck, frames, spent_s = Eye(), 0, 0, 0.0
    for at, yaw in course:
        world.drive(DriveBase(name=_ROBOT, to=(at,), yaw=yaw, speed=0.4))
        for cloud in _filmed(world, eye):
            started = time.process_time()
            look = observer([cloud])
            told = associate(
                believed.entities,
                tracks,
                look.observations.observations,
                occupancy_in([cloud]),
                hierarchy,
                config.for_moving_camera if look.camera_moves else config,
            )
            tracks = told.tracks
            for command in told.commands:
                believed.obey(command)
            spent_s, frames = spent_s + time.process_time() - started, frames + 1
        here = world.pose(_ROBOT).position_m
        stuck += math.dist(here[:2], at) > _NEAR_M
    return Course(list(believed.entities.values()), stuck, frames, 1000.0 * spent_s / frames)


def _filmed(world: World, eye: Eye) -> Iterator[Cloud]:
    """Yield the frames of the head camera on the way and for a while at its end."""
    still_s = 0.0
    while still_s < _LOOKS_S:
        world.step(_FRAME_S)
        if still_s or world.ended():
            still_s += _FRAME_S
        frame = eye.frame(world.model, world.data, _CAMERA, 640, 480)
        stamp_ns = int(frame.sim_time_s * 1e9)
        yield cloud_of(
            frame.depth_m,
            frame.rgb,
            frame.intrinsics,
            frame.map_from_camera,
            camera=_CAMERA,
            stamp_ns=stamp_ns,
        )


def score(things: list[Entity], seen: list[Entity], known: ClassHierarchy | None = None) -> Score:
    """Return the numbers of things found, of duplicates, and of misplaced ones.

    A thing is found if an entity within 60 cm has its class or a more general one: its
    class, one above it, or Object, as `known` tells. Without `known` any class will do. Pairs are made by
    distance, the nearest first; a double is seen at a thing that something else has found.
    """
    pairs = sorted(
        (apart, i, j)
        for i, thing in enumerate(things)
        for j, other in enumerate(seen)
        if (apart := _apart_m(thing, other)) < _NEAR_M
        and (known is None or known.is_a(thing.class_, other.class_))
    )
    matched: dict[int, float] = {}
    taken: set[int] = set()
    for apart, i, j in pairs:
        if i not in matched and j not in taken:
            matched[i] = apart
            taken.add(j)
    doubles = sum(
        any(_apart_m(things[i], other) < _WRONG_M and things[i].class_ == other.class_ for i in matched)
        for j, other in enumerate(seen)
        if j not in taken
    )
    return Score(len(matched), doubles, sum(apart > _WRONG_M for apart in matched.values()))


def _mean(scores: Sequence[Score]) -> Score:
    return Score(*(mean(column) for column in zip(*scores, strict=True)))


def _share(of: Score) -> float:
    return of.wrong / max(1, of.found)


def _apart_m(one: Entity, other: Entity) -> float:
    if one.pose is None or other.pose is None:
        return math.inf
    return math.dist(one.pose.position_m, other.pose.position_m)
