"""Doors: the cost of joints at rest, the latency of commits, and the agreement of map and scene."""

from __future__ import annotations

import json
import random
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from statistics import median
from time import thread_time

from benchmarks.sim.generated_scenes import p50_p95_ms
from benchmarks.sim.system import Watch
from benchmarks.table import Row
from semmap.nodes import bus
from semmap.nodes.coordinator.config import Thresholds
from semmap.nodes.extern.client import Client
from semmap.nodes.extern.testing import own_system
from semmap.nodes.sim_node.models.library import Model, assemble, build
from semmap.nodes.sim_node.models.parts import Vec3
from semmap.nodes.sim_node.order_validation import ModelSource
from semmap.nodes.sim_node.physics import sleep
from semmap.nodes.sim_node.world import World
from semmap.schemas import keys
from semmap.schemas.entities import Entity
from semmap.schemas.joints import IS_OPEN, OPEN_FROM, OPENING, in_words, openness, stated
from semmap.schemas.scenes import BodyOrder, JointOrder, Scene, SceneQuery

CLASSES = ("Fridge", "Oven", "Microwave", "Dishwasher", "WashingMachine", "Cabinet", "Wardrobe", "Desk")
_BARE = ("--no-record", "--world", "empty", "--abox", "none")
_DOORS = 40
_CHECK_S = 30.0
_ROUND_S = 0.25
_PATIENCE_S = 60.0
_IN_A_ROW = 5
_STEP_S = 0.01
_THERE_RAD = 0.001
_OFF = Thresholds().share + 0.002
"""The deviation beyond which a joint disagrees with the map; it exceeds the reconciler's tolerance."""


def measure(folder: Path, *, quick: bool) -> list[Row]:
    """The cost of joints, and the latency of commits."""
    with own_system(folder / "flat", "--no-record", "--no-sim") as client:
        things = [e for e in client.list() if e.pose is not None and not e.place]
    rows = at_rest(things, 20 if quick else 200)
    with own_system(folder / "fridge", *_BARE) as client:
        return [*rows, *soon(client, 6 if quick else 30)]


def measure_at_random(folder: Path, minutes: float) -> list[Row]:
    """Measure forty doors for so many simulated minutes, which take longer on a busy machine."""
    with own_system(folder / "doors", *_BARE) as client:
        return [at_random(client, folder, minutes)]


def at_rest(things: Sequence[Entity], trials: int) -> list[Row]:
    """Measure real-time factors with and without joints at rest, in turn; and while awake."""
    worlds = [_furnished(things, models) for models in (build, rigid)]
    joints = len(worlds[0].poses().joints)
    factors = [_in_turn(worlds, trials, awake=awake) for awake in (False, True)]
    with_, without = factors[0]
    return [
        Row(f"real-time factor at rest, the flat with its {joints} joints", with_, "times"),
        Row("  the same without joints", without, "times"),
        Row("  of the one to the other", with_ / without, "", 0.8, 0.95, more=True),
        Row("  likewise while all of it is kept awake", factors[1][0] / factors[1][1], ""),
    ]


def rigid(name: str, size_m: Vec3 | None) -> Model:
    """Return a shipped model without moving parts."""
    model = build(name, size_m)
    if not model.leaves:
        return model
    return assemble(name, [replace(part, joint=None) for part in model.parts], model.mass_kg)


def _furnished(things: Sequence[Entity], models: ModelSource) -> World:
    world = World(models=models)
    world.spawn([_order(thing) for thing in things])
    world.step(5.0)
    return world


def _order(thing: Entity) -> BodyOrder:
    assert thing.pose is not None
    return BodyOrder(
        name=thing.name,
        class_=thing.class_,
        model=thing.model,
        pose=thing.pose,
        size_m=thing.size_m,
        fixed=thing.fixed,
        commit=1,
    )


def _in_turn(worlds: Sequence[World], trials: int, *, awake: bool) -> tuple[float, float]:
    """Return the real-time factors of two worlds, in the simulator's steps of 10 ms."""
    took: list[list[float]] = [[] for _ in worlds]
    for _ in range(trials):
        for world, times in zip(worlds, took, strict=True):
            if awake:
                mark_awake(world)
            started = thread_time()
            for _ in range(5):
                world.step(0.01)
            world.poses()
            times.append(thread_time() - started)
    first, second = (0.05 / median(times) for times in took)
    return first, second


def mark_awake(world: World) -> None:
    """Wake all movable bodies."""
    for tree in range(world.model.ntree):
        sleep.wake(world.data, tree)


def soon(client: Client, trials: int) -> list[Row]:
    """Measure the latency from the end of a fridge door's motion to the arrival of its commit.

    The duration of the motion is known from the same door in this process, with exact simulated time.
    """
    client.add("Fridge", "fridge1", at=(0.0, 0.0, 0.0), wait=True)
    watch = Watch(client)
    swings = (0.5, 0.0)
    try:
        # one way and back, twice, before anything counts: the door begins where the map states it
        for to in swings:
            client.open("fridge1", to=to, joint="door")
        lasts_s = dict(zip(swings, _lasts_s(client.get("fridge1"), swings), strict=True))
        late = []
        for trial in range(trials):
            to = swings[trial % 2]
            watch.followed_ns.pop("fridge1", None)
            started_ns = time.time_ns()
            client.open("fridge1", to=to, joint="door", wait=False)
            watch.wait(lambda: "fridge1" in watch.followed_ns)
            late.append((watch.followed_ns["fridge1"] - started_ns) * 1e-9 - lasts_s[to])
            time.sleep(0.3)
    finally:
        watch.close()
    p50, p95 = p50_p95_ms(late)
    return [
        Row("joint command to map, fridge door: after it rests, p50", p50, "ms", 50.0, 20.0),
        Row("  p95", p95, "ms"),
        Row("  the door's own motion", 1e3 * lasts_s[swings[0]], "ms"),
    ]


def _lasts_s(fridge: Entity, swings: Sequence[float]) -> list[float]:
    """Return the durations of these openings in turn [s of simulated time]."""
    world = World()
    world.spawn([_order(fridge)])
    world.step(2.0)
    lasts = []
    for to in swings:
        world.move_joints([JointOrder(name=fridge.name, joint="door", openness=to)])
        stood = []
        for _ in range(500):
            world.step(_STEP_S)
            stood.append(world.poses().joints[0])
        there = next(i for i, position in enumerate(stood) if abs(position - stood[-1]) < _THERE_RAD)
        lasts.append(_STEP_S * (there + 1))
    return lasts


def at_random(client: Client, folder: Path, minutes: float) -> Row:
    """Open and close doors manually and by commands; count disagreements of map and joints at rest."""
    described = [
        {"class": CLASSES[i % len(CLASSES)], "name": f"door{i}", "at": [3.0 * (i % 8), 3.0 * (i // 8), 0.0]}
        for i in range(_DOORS)
    ]
    path = folder / "doors.json"
    path.write_text(json.dumps({"entities": described}))
    client.load(path)
    _quiet(client)
    dice, wrong, done = random.Random(0), 0, 0
    began_s = now_s = _scene(client).sim_time_s
    while (left_s := began_s + 60.0 * minutes - now_s) > 0.0:
        check_s = now_s + min(left_s, _CHECK_S)
        while _scene(client).sim_time_s < check_s:
            _turn(client, f"door{dice.randrange(_DOORS)}", dice)
            done += 1
            time.sleep(_ROUND_S)
        at_odds = [_told(client.get(name)) for name in _quiet(client)]
        wrong += len(at_odds)
        now_s = _scene(client).sim_time_s
        told = f"{now_s - began_s:.0f} simulated s, {done} orders: at odds: {', '.join(at_odds) or 'none'}"
        print(told, flush=True)
    what = f"{_DOORS} doors, {minutes:g} simulated minutes, {done} orders: map and joints disagree"
    return Row(what, float(wrong), "", 0.0, 0.0)


def _turn(client: Client, name: str, dice: random.Random) -> None:
    to = dice.choice((0.0, 1.0, round(dice.random(), 2)))
    match dice.randrange(3):
        case 0:
            client.open(name, to=to, wait=False)
        case 1:
            client.set(name, "openness", to)
        case _:
            client.set(name, "isOpen", to > 0.5)


def _quiet(client: Client) -> list[str]:
    """Wait until nothing moves and all is committed; return the names that disagree.

    Only disagreements that persist after a while count.
    """
    deadline_s = time.monotonic() + _PATIENCE_S
    agreed, doors = 0, tuple(f"door{i}" for i in range(_DOORS))
    while agreed < _IN_A_ROW and time.monotonic() < deadline_s:
        rests = all(body.resting for body in _scene(client).bodies)
        agreed = agreed + 1 if rests and client.status(names=doors).in_agreement else 0
        time.sleep(0.2)
    return [name for name in doors if not agrees(client.get(name))]


def _told(entity: Entity) -> str:
    """Return the asserted and the actual joint positions of a thing."""
    said = {name: entity.properties[name] for name in OPENING if name in entity.properties}
    stands = ", ".join(in_words(joint) for joint in entity.body.joints) if entity.body else "no body"
    return f"{entity.name} (said: {said}; it stands: {stands})"


def _scene(client: Client) -> Scene:
    """Return the current scene."""
    scene: Scene = bus.ask(client.session, keys.SIM, SceneQuery.VERB, SceneQuery(), Scene)
    return scene


def agrees(entity: Entity) -> bool:
    """Return whether its joints are as asserted, or in their initial position without an assertion.

    If only `isOpen` is asserted, any position that counts as open is correct.
    """
    if entity.body is None or not entity.body.joints:
        return False
    joints, properties = entity.body.joints, entity.properties
    share = openness(joints)
    is_open = share is not None and properties.get(IS_OPEN, share > OPEN_FROM) is (share > OPEN_FROM)
    if properties.keys() & {*OPENING} == {IS_OPEN}:
        return is_open
    wanted = stated(joints, properties) or {joint.name: joint.initial for joint in joints}
    near_the_limit = share is not None and abs(share - OPEN_FROM) < _OFF
    stands = all(
        abs((j.openness or 0.0) - (j.openness_at(wanted.get(j.name, j.position)) or 0.0)) < _OFF
        for j in joints
    )
    return stands and (is_open or near_the_limit)
