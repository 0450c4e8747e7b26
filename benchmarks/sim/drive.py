"""A drive through rooms of the flat by the robot's head camera: what the map then has of what is there."""

from __future__ import annotations

import json
import math
import time
from pathlib import Path

from benchmarks.table import Row
from nodes.extern.client import Client
from nodes.extern.testing import own_system
from schemas import errors
from schemas.entities import Entity

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
"""Where it stops to look, and which way it looks then: a place [m] and a yaw [rad]."""
_LOOKS_S = 2.0
_NEAR_M = 0.6
_WRONG_M = 0.2


def measure(folder: Path) -> list[Row]:
    """The share of things found, doubles, and the share of those found that are in a wrong place."""
    with own_system(folder / "said", "--no-record", "--no-sim") as client:
        things = [e for name in ROOMS for e in client.list(in_=name) if _may_be_seen(e)]
        doors = {e.name for e in client.list("Door")}  # they would be shut
        everything = [e for e in client.list() if not e.place and e.pose is not None and e.name not in doors]
    world = folder / "world.json"
    world.write_text(json.dumps({"cameras": [], "entities": [_described(e) for e in everything]}))
    words = ("--world", str(world), "--truth", "perceived", "--perception", "--camera-hz", "4", "--no-record")
    robot = ("--robot", "porter", "--robot-at", *(f"{value:g}" for value in (*_AT, 0.0)))
    started = time.monotonic()
    with own_system(folder / "driven", *words, *robot) as client:
        stuck = _drive(client)
        seen = [
            e for e in client.list() if e.tracked == "" and not e.place and not e.name.startswith("robot1")
        ]
    found, doubles, wrong = score(things, seen)
    return [
        Row(f"drive: found of {len(things)} things", found / len(things), "", 0.80, 0.92, more=True),
        Row("  doubles", float(doubles), "", 0.0, 0.0),
        Row("  in a wrong place, over 20 cm, of those found", wrong / max(1, found), "", 0.05, 0.02),
        Row("  courses on which it got stuck", float(stuck), ""),
        Row("  took", time.monotonic() - started, "s"),
    ]


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


def _drive(client: Client) -> int:
    """Along the course, with a look at each stop; how often it got stuck."""
    stuck = 0
    deadline = time.monotonic() + 30.0
    while not any(e.name == "robot1" for e in client.list()) and time.monotonic() < deadline:
        time.sleep(0.2)
    for at, yaw in _COURSE:
        try:
            client.drive("robot1", to=(at,), yaw=yaw, speed=0.4, wait=True)
        except errors.Refused:
            stuck += 1
        time.sleep(_LOOKS_S)
    return stuck


def score(things: list[Entity], seen: list[Entity]) -> tuple[int, int, int]:
    """How many things are found, how many of those seen are doubles of one, how many found are off.

    Pairs are made by distance, the nearest first; a double is what is seen within a thing that is found.
    """
    pairs = sorted(
        (apart, i, j)
        for i, thing in enumerate(things)
        for j, other in enumerate(seen)
        if (apart := _apart_m(thing, other)) < _NEAR_M
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
    return len(matched), doubles, sum(apart > _WRONG_M for apart in matched.values())


def _apart_m(one: Entity, other: Entity) -> float:
    if one.pose is None or other.pose is None:
        return math.inf
    return math.dist(one.pose.position_m, other.pose.position_m)
