"""The geoms of a world as triangles: its walls, and the bodies of its file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import mujoco
import numpy as np
from numpy.typing import NDArray

from semmap.nodes.sim_node.models.facets import facets
from semmap.nodes.sim_node.models.parts import Floats, Mesh, Part, Shape
from semmap.nodes.sim_node.physics.build import COLLISION_GROUP
from semmap.schemas.scenes import Surface

_SHAPES = {
    mujoco.mjtGeom.mjGEOM_BOX: Shape.BOX,
    mujoco.mjtGeom.mjGEOM_SPHERE: Shape.ELLIPSOID,
    mujoco.mjtGeom.mjGEOM_ELLIPSOID: Shape.ELLIPSOID,
    mujoco.mjtGeom.mjGEOM_CYLINDER: Shape.CYLINDER,
    mujoco.mjtGeom.mjGEOM_CAPSULE: Shape.CAPSULE,
    mujoco.mjtGeom.mjGEOM_MESH: Shape.MESH,
}


_MOST_TRIANGLES: Final = 100_000
"""A body of more triangles is not drawn in detail."""


def world_surface(model: mujoco.MjModel, data: mujoco.MjData, names: Sequence[str]) -> Surface:
    """Return the surface, in the map frame, of geoms of no body, which are "" in `names` (ngeom,).

    Planes, height fields and invisible geoms are omitted.
    """
    return _surface(
        model, data, [geom for geom, name in enumerate(names) if not name], np.zeros(3), np.eye(3)
    )


def body_surface(
    model: mujoco.MjModel, data: mujoco.MjData, names: Sequence[str], name: str, pose: Floats
) -> Surface | None:
    """Return the surface of a body of the world file, with its parts as they are now, in its frame.

    `names` (ngeom,) is the body of each geom, and `pose` (7,) that of the body: position [m] and quaternion
    wxyz, map frame. Returns None if it is invisible or has too many triangles.
    """
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, np.asarray(pose[3:], dtype=float))
    geoms = [geom for geom, whose in enumerate(names) if whose == name]
    surface = _surface(model, data, geoms, pose[:3], turn.reshape(3, 3))
    return surface if 0 < len(surface.triangles) <= 12 * _MOST_TRIANGLES else None


def _surface(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: Sequence[int], origin: Floats, frame: Floats
) -> Surface:
    """Return the surface of these geoms in a frame.

    `origin` (3,) [m] is its origin, and the columns of `frame` (3, 3) are its axes.
    """
    points, normals, colours, triangles, count = [], [], [], [], 0
    for geom in geoms:
        if (part := _part(model, geom)) is None:
            continue
        piece, turn = facets(part), frame.T @ data.geom_xmat[geom].reshape(3, 3)
        points.append(piece.points @ turn.T + (data.geom_xpos[geom] - origin) @ frame)
        normals.append(piece.normals @ turn.T)
        colours.append(np.tile(part.colour, (len(piece.points), 1)))
        triangles.append(piece.triangles + count)
        count += len(piece.points)
    return Surface(
        points=_rows(points).astype("<f4").tobytes(),
        normals=_rows(normals).astype("<f4").tobytes(),
        colours=np.round(255.0 * _rows(colours)).astype("u1").tobytes(),
        triangles=_rows(triangles).astype("<u4").tobytes(),
    )


def _rows(pieces: Sequence[NDArray[Any]]) -> NDArray[Any]:
    return np.concatenate(pieces) if pieces else np.empty((0, 3))


def _part(model: mujoco.MjModel, geom: int) -> Part | None:
    """Return a geom in its own frame; None if it is not drawn."""
    shape = _SHAPES.get(mujoco.mjtGeom(model.geom_type[geom]))
    red, green, blue, alpha = _rgba(model, geom)
    if shape is None or alpha == 0.0 or model.geom_group[geom] >= COLLISION_GROUP:
        return None
    a, b, c = (float(value) for value in model.geom_size[geom])
    match mujoco.mjtGeom(model.geom_type[geom]):
        case mujoco.mjtGeom.mjGEOM_SPHERE:
            a, b, c = a, a, a
        case mujoco.mjtGeom.mjGEOM_CYLINDER | mujoco.mjtGeom.mjGEOM_CAPSULE:
            a, b, c = a, a, b
    mesh = _mesh(model, int(model.geom_dataid[geom])) if shape is Shape.MESH else None
    return Part(shape, (a, b, c), (0.0, 0.0, 0.0), (red, green, blue), mesh=mesh)


def _rgba(model: mujoco.MjModel, geom: int) -> tuple[float, float, float, float]:
    material = int(model.geom_matid[geom])
    red, green, blue, alpha = model.mat_rgba[material] if material >= 0 else model.geom_rgba[geom]
    return float(red), float(green), float(blue), float(alpha)


def _mesh(model: mujoco.MjModel, mesh: int) -> Mesh:
    first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
    start, faces = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
    return Mesh(
        key=str(mesh),
        vertices=model.mesh_vert[first : first + count].astype(float),
        faces=model.mesh_face[start : start + faces],
    )
