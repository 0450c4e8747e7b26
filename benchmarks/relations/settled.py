"""Random settled scenes of the library's models, with supports by MuJoCo's contact forces."""

from __future__ import annotations

import copy
import math
import random
from typing import NamedTuple

import mujoco
import numpy as np

from semmap.nodes.sim_node.models.library import build
from semmap.nodes.sim_node.world import World
from semmap.schemas.entities import Entity, Pose, Provenance, orientation_from_yaw
from semmap.schemas.scenes import BodyOrder

SUPPORTS = (
    "table", "desk", "counter", "bench", "bed", "couch", "stool", "chair", "bedstand",
    "bookshelf", "cabinet", "washing_machine",
)  # fmt: skip
THINGS = (
    "book", "cup", "can", "bottle", "bowl", "plate", "apple", "box", "lamp", "laptop", "phone", "glass",
    "pan", "pot",
    "basket", "cushion", "keyboard", "remote", "orange", "lemon", "clock", "newspaper", "tray",
)  # fmt: skip
STEEPEST = math.cos(math.radians(30.0))
LEAST_SHARE = 0.05
"""The share of a thing's weight that a contact must carry to count as support."""

_NOBODY = Provenance(commit=1, stamp_ns=0, source="scene")


class Settled(NamedTuple):
    """A scene at rest: the entities of a map, and the ground truth."""

    entities: list[Entity]
    on: set[tuple[str, str]]
    """Upper and lower body of every resting contact."""
    touching: set[frozenset[str]]
    steeply: set[tuple[str, str]]
    """Upper and lower body of the steeper contacts of things without any resting contact, including the
    floor."""


def settled_scene(seed: int, things: int = 14, settle_s: float = 4.0) -> Settled:
    """Return furniture in a row with things dropped on it, on one another, and beside it."""
    rng = random.Random(seed)
    world = World()
    orders = [
        _order(f"{model}{i}", model, (2.2 * i, 0.0, 0.0), rng.uniform(-math.pi, math.pi))
        for i, model in enumerate(rng.sample(SUPPORTS, 3))
    ]
    world.spawn(orders)
    world.step(0.5)
    for k in range(things):
        model = rng.choice(THINGS)
        below = rng.choice(orders if k < 5 or rng.random() < 0.7 else orders[3:] or orders)
        size = build(below.model, None).size_m
        x, y, _ = below.pose.position_m
        top = build(below.model, None).size_m[2] + below.pose.position_m[2]
        spread = 0.45 if rng.random() < 0.85 else 0.75
        at = (
            x + rng.uniform(-spread, spread) * size[0],
            y + rng.uniform(-spread, spread) * size[1],
            top + rng.uniform(0.0, 0.06),
        )
        orders.append(_order(f"{model}_{k}", model, at, rng.uniform(-math.pi, math.pi)))
        world.spawn(orders[-1:])
        world.step(0.6)
        orders[-1] = _order(orders[-1].name, model, _position(world, orders[-1].name), 0.0)
    world.step(settle_s)
    return _looked_at(world)


def _position(world: World, name: str) -> tuple[float, float, float]:
    (body,) = (body for body in world.scene().bodies if body.name == name)
    return body.pose.position_m


def _order(name: str, model: str, at: tuple[float, float, float], yaw: float) -> BodyOrder:
    pose = Pose(position_m=at, orientation_wxyz=orientation_from_yaw(yaw))
    return BodyOrder(name=name, class_=model, model=model, pose=pose, commit=1)


def _looked_at(world: World) -> Settled:
    bodies = [body for body in world.scene().bodies if not body.ghost]
    known = {body.name for body in bodies}
    entities = [
        Entity(
            name=body.name, class_=body.class_ or "", iri=f"urn:{body.name}", types=(), pose=body.pose,
            size_m=body.size_m, model=body.model, provenance=_NOBODY, pose_provenance=_NOBODY,
            shape_provenance=_NOBODY, reference_provenance=_NOBODY,
        )
        for body in bodies
    ]  # fmt: skip
    model = copy.copy(world.model)
    model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    data = mujoco.MjData(model)
    data.qpos[:] = world.data.qpos
    mujoco.mj_forward(model, data)
    owner = world.body_names()
    weight = dict.fromkeys(known, 0.0)
    for geom, name in enumerate(owner):
        if name in weight:
            weight[name] = float(model.body_subtreemass[model.geom_bodyid[geom]]) * 9.81
    on: set[tuple[str, str]] = set()
    touching: set[frozenset[str]] = set()
    carried: dict[tuple[str, str], float] = {}
    steeply: dict[tuple[str, str], float] = {}
    on_floor: set[str] = set()
    force = np.zeros(6)
    for index in range(data.ncon):
        contact = data.contact[index]
        one, other = owner[contact.geom1], owner[contact.geom2]
        if one == other or not (one in known or other in known):
            continue
        normal = contact.frame[:3]  # from geom1 to geom2
        lower, upper = (one, other) if normal[2] > 0.0 else (other, one)
        if lower not in known or upper not in known:
            if upper in known and abs(normal[2]) >= STEEPEST:
                on_floor.add(upper)
            continue
        touching.add(frozenset((one, other)))
        mujoco.mj_contactForce(model, data, index, force)
        newtons = float(force[0]) * abs(float(normal[2]))
        kind = carried if abs(normal[2]) >= STEEPEST else steeply
        kind[upper, lower] = kind.get((upper, lower), 0.0) + newtons
    for (upper, lower), newtons in carried.items():
        if newtons >= LEAST_SHARE * weight[upper]:
            on.add((upper, lower))
    borne = on_floor | {upper for upper, _ in on}
    held = {
        (upper, lower)
        for (upper, lower), newtons in steeply.items()
        if upper not in borne and newtons >= LEAST_SHARE * weight[upper]
    }
    return Settled(entities, on, touching, held)
