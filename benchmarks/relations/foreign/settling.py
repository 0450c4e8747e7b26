"""A drawn world at rest in plain MuJoCo: poses, supports by contact forces, and solids as convex hulls."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from benchmarks.relations.foreign.drawing import ForeignWorld

Floats = NDArray[np.float64]
_LEAST_S, _MOST_S, _WATCH_S = 3.0, 12.0, 0.1
_CIRCLE = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
_FLAT = 1e-9
_SLOW = 0.02
"""Speeds of a world at rest [m/s, rad/s]."""


class Hull(NamedTuple):
    """A convex geom in the map frame."""

    planes: Floats
    """(F, 4) outward normals and offsets of its faces."""
    low: Floats
    high: Floats


@dataclass
class AtRest:
    """A world after its bodies have settled; bodies are grouped by the thing that they are parts of."""

    world: ForeignWorld
    model: mujoco.MjModel
    data: mujoco.MjData
    things: list[str]
    hulls: dict[str, list[Hull]]
    """The geoms of each thing."""
    bounds: dict[str, tuple[Floats, Floats]]
    lifted: dict[tuple[str, str], float] = field(default_factory=dict)
    """The mean share of the weight of the first thing that the second one carries."""
    falling: frozenset[str] = frozenset()
    """Things that are not fixed."""

    @property
    def is_calm(self) -> bool:
        """Return whether nothing moves."""
        return _is_calm(self.data)


def settle(world: ForeignWorld) -> AtRest:
    """Let a world come to rest, without any code of semmap."""
    model = mujoco.MjModel.from_xml_string(world.text())
    data = mujoco.MjData(model)
    for joint, position in world.open.items():
        data.qpos[model.joint(joint).qposadr[0]] = position
    while data.time < _LEAST_S or (data.time < _MOST_S and not _is_calm(data)):
        mujoco.mj_step(model, data)
    owners = world.owners()
    whose = [owners.get(model.body(model.geom_bodyid[geom]).name, "") for geom in range(model.ngeom)]
    found = AtRest(world, model, data, list(dict.fromkeys(owners.values())), {}, {})
    found.falling = frozenset(owners[model.body(b).name] for b in model.jnt_bodyid[model.jnt_type == 0])
    _watch_forces(found, whose)
    for thing in found.things:
        points = [_vertices(model, data, geom) for geom, its in enumerate(whose) if its == thing]
        found.hulls[thing] = [Hull(_faces(p), p.min(axis=0), p.max(axis=0)) for p in points]
        found.bounds[thing] = (np.vstack(points).min(axis=0), np.vstack(points).max(axis=0))
    return found


def _is_calm(data: mujoco.MjData) -> bool:
    return bool(np.abs(data.qvel).max(initial=0.0) < _SLOW)


def _watch_forces(rest: AtRest, whose: list[str]) -> None:
    """Average the upward forces between things for a while."""
    model, data, force = rest.model, rest.data, np.zeros(6)
    steps = round(_WATCH_S / model.opt.timestep)
    weight = dict.fromkeys(rest.things, 0.0)
    for geom, thing in enumerate(whose):
        body = model.geom_bodyid[geom]
        if thing and geom == model.body_geomadr[body]:
            weight[thing] += float(model.body_mass[body]) * 9.81
    for _ in range(steps):
        mujoco.mj_step(model, data)
        for number in range(data.ncon):
            contact = data.contact[number]
            one, other = whose[contact.geom1], whose[contact.geom2]
            if one == other or not (one and other):
                continue
            mujoco.mj_contactForce(model, data, number, force)
            up = float(contact.frame.reshape(3, 3)[:, 2] @ force[:3]) / steps  # on the second geom
            for pair, newtons in (((other, one), up), ((one, other), -up)):
                if weight[pair[0]] > 0.0:
                    rest.lifted[pair] = rest.lifted.get(pair, 0.0) + newtons / weight[pair[0]]


def _faces(points: Floats) -> Floats:
    found: Floats = np.unique(ConvexHull(points).equations.round(9), axis=0)
    return found


def _vertices(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> Floats:
    """Return points whose hull is a geom, in the map frame."""
    kind, size = mujoco.mjtGeom(int(model.geom_type[geom])), model.geom_size[geom]
    circle = np.stack([np.cos(_CIRCLE), np.sin(_CIRCLE)], axis=1)
    if kind == mujoco.mjtGeom.mjGEOM_MESH:
        mesh = int(model.geom_dataid[geom])
        first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        points = model.mesh_vert[first : first + count].astype(np.float64)
    elif kind == mujoco.mjtGeom.mjGEOM_BOX:
        points = size * np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, 8).T
    elif kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        points = np.vstack([np.c_[size[0] * circle, np.full(24, z)] for z in (-size[1], size[1])])
    else:  # a sphere, or a capsule of two half ones
        half = size[1] if kind == mujoco.mjtGeom.mjGEOM_CAPSULE else 0.0
        angles = np.linspace(0.0, np.pi / 2, 7)
        rings = [np.c_[size[0] * np.cos(a) * circle, np.full(24, size[0] * np.sin(a) + half)] for a in angles]
        points = np.vstack([*rings, *(ring * (1.0, 1.0, -1.0) for ring in rings)])
    found: Floats = points @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
    return found


def extents_at(hulls: list[Hull], points: Floats) -> tuple[Floats, Floats]:
    """Return where vertical lines through (N, 2) points enter and leave (G,) hulls: (G, N), NaN outside."""
    low, high = np.full((2, len(hulls), len(points)), np.nan)
    for row, hull in enumerate(hulls):
        near = np.flatnonzero(((points >= hull.low[:2]) & (points <= hull.high[:2])).all(axis=1))
        if not len(near):
            continue
        x, y = points[near, :1], points[near, 1:]
        a, b, c, d = hull.planes.T
        offset = x * a + y * b + d  # (N, F): offset + c z <= 0 inside
        with np.errstate(divide="ignore", invalid="ignore"):
            z = -offset / c
        enters = np.where(c < -_FLAT, z, -np.inf).max(axis=1)
        leaves = np.where(c > _FLAT, z, np.inf).min(axis=1)
        inside = (enters < leaves) & ~(offset[:, np.abs(c) <= _FLAT] > _FLAT).any(axis=1)
        low[row, near[inside]], high[row, near[inside]] = enters[inside], leaves[inside]
    return low, high
