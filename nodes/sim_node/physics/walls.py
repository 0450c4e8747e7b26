"""The outlines of the world's static geometry, seen from above, without bodies."""

from __future__ import annotations

from collections.abc import Collection
from typing import Final

import mujoco
import numpy as np

from semmap.nodes.geometry import polygons
from semmap.nodes.sim_node.bodies import Floats
from semmap.schemas.plans import Outline

_FLOORS: Final = (int(mujoco.mjtGeom.mjGEOM_PLANE), int(mujoco.mjtGeom.mjGEOM_HFIELD))
_ROUND: Final = (int(mujoco.mjtGeom.mjGEOM_SPHERE), int(mujoco.mjtGeom.mjGEOM_CYLINDER))
_SIDES: Final = 16
_DIGITS: Final = 6
_DIRECTIONS: Final = 32


def walls(model: mujoco.MjModel, data: mujoco.MjData, bodies: Collection[int]) -> tuple[Outline, ...]:
    """Return the outlines of static colliding geometry, except of these bodies, by number.

    Planes and height fields are floors. Round shapes have sixteen corners.
    """
    found: list[Outline] = []
    for geom in range(model.ngeom):
        body = int(model.geom_bodyid[geom])
        if model.body_weldid[body] != 0 or int(model.body_rootid[body]) in bodies:
            continue
        if model.geom_type[geom] in _FLOORS or not (model.geom_contype[geom] or model.geom_conaffinity[geom]):
            continue
        if (outline := _outline(_points(model, data, geom))) is not None:
            found.append(outline)
    return tuple(found)


def _points(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> Floats:
    """Return points (N, 3) whose hull contains the geometry; map frame [m]."""
    kind = int(model.geom_type[geom])
    half = model.geom_aabb[geom, 3:]  # about the origin of a shape that is not a mesh
    if kind == int(mujoco.mjtGeom.mjGEOM_MESH):
        mesh = int(model.geom_dataid[geom])
        start = int(model.mesh_vertadr[mesh])
        own = np.asarray(model.mesh_vert[start : start + int(model.mesh_vertnum[mesh])], dtype=np.float64)
    elif kind in _ROUND:
        angle = np.arange(_SIDES) * (2.0 * np.pi / _SIDES)
        reach = half[0] / np.cos(np.pi / _SIDES)
        ring = np.stack([np.cos(angle) * reach, np.sin(angle) * reach, np.zeros(_SIDES)], axis=1)
        up = np.array([0.0, 0.0, half[2]])
        own = np.concatenate([ring - up, ring + up])
    else:
        signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
        own = signs * half
    rotation = data.geom_xmat[geom].reshape(3, 3)
    points: Floats = own @ rotation.T + data.geom_xpos[geom]
    return points


def _outline(points: Floats) -> Outline | None:
    """Return the outline seen from above; None if it has no area."""
    flat = outer_points(np.round(points[:, :2], _DIGITS) + 0.0)
    corners = polygons.hull([(x, y) for x, y in flat.tolist()])
    if polygons.area(corners) == 0.0:
        return None
    return Outline(
        corners=tuple(corners),
        low=round(float(points[:, 2].min()), _DIGITS),
        high=round(float(points[:, 2].max()), _DIGITS),
    )


def outer_points(points: Floats) -> Floats:
    """Return the points (M, 2) of (N, 2) that can be on the hull, because the hull of all is slow for a mesh.

    Points within the polygon of the farthest points in some directions are dropped.
    """
    angle = np.arange(_DIRECTIONS) * (2.0 * np.pi / _DIRECTIONS)
    corners = points[(points @ np.stack([np.cos(angle), np.sin(angle)])).argmax(axis=0)]
    edges = np.roll(corners, -1, axis=0) - corners
    is_within = np.full(len(points), edges.any())
    for (x, y), (along_x, along_y) in zip(corners.tolist(), edges.tolist(), strict=True):
        if along_x or along_y:
            is_within &= along_x * (points[:, 1] - y) > along_y * (points[:, 0] - x)
    outer: Floats = points[~is_within]
    return outer
