"""The geoms of a world as triangles: its walls, and the bodies of its file."""

from __future__ import annotations

import copy
import hashlib
from collections.abc import Iterator, Sequence
from typing import Any, Final, Literal

import mujoco
import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from semmap.nodes.sim_node.models.facets import facets
from semmap.nodes.sim_node.models.parts import Floats, Mesh, Part, Shape, Vec3
from semmap.nodes.sim_node.physics.build import COLLISION_GROUP
from semmap.schemas import codec
from semmap.schemas.scenes import Leaf, Surface

_SHAPES = {
    mujoco.mjtGeom.mjGEOM_BOX: Shape.BOX,
    mujoco.mjtGeom.mjGEOM_SPHERE: Shape.ELLIPSOID,
    mujoco.mjtGeom.mjGEOM_ELLIPSOID: Shape.ELLIPSOID,
    mujoco.mjtGeom.mjGEOM_CYLINDER: Shape.CYLINDER,
    mujoco.mjtGeom.mjGEOM_CAPSULE: Shape.CAPSULE,
    mujoco.mjtGeom.mjGEOM_MESH: Shape.MESH,
}

_LEAF_KINDS: Final[dict[int, Literal["hinge", "slide"]]] = {
    int(mujoco.mjtJoint.mjJNT_HINGE): "hinge",
    int(mujoco.mjtJoint.mjJNT_SLIDE): "slide",
}
_MOST_TRIANGLES: Final = 100_000
"""A body of more triangles is not drawn in detail."""
_DECIMALS: Final = 5
"""Coordinates are rounded [m], so that equal bodies at different places have equal surfaces."""


def world_surface(model: mujoco.MjModel, data: mujoco.MjData, names: Sequence[str]) -> Surface:
    """Return the surface, in the map frame, of geoms of no body, which are "" in `names` (ngeom,).

    Planes, height fields and invisible geoms are omitted.
    """
    geoms = [geom for geom, name in enumerate(names) if not name]
    return _surface(model, data, geoms, np.zeros(3), np.eye(3))[0]


def close_joints(model: mujoco.MjModel, data: mujoco.MjData) -> mujoco.MjData:
    """Return a copy of the state with all hinges and slides at 0."""
    closed = copy.copy(data)
    closed.qpos[model.jnt_qposadr[np.isin(model.jnt_type, list(_LEAF_KINDS))]] = 0.0
    mujoco.mj_kinematics(model, closed)
    return closed


def body_surface(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: Sequence[int], body: int, pose: Floats
) -> Surface | None:
    """Return the surface of a body of the world file in its frame; in `data`, all joints are at 0.

    `geoms` are its geoms in ascending order, `body` is its number in the model, and `pose` (7,) its position
    [m] and quaternion wxyz in the map frame. Each joint of its parts moves a leaf. Returns None if it is
    invisible or has too many triangles.
    """
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, np.asarray(pose[3:], dtype=float))
    origin, frame = pose[:3], turn.reshape(3, 3)
    surface, starts = _surface(model, data, geoms, origin, frame)
    if not 0 < len(surface.triangles) <= 12 * _MOST_TRIANGLES:
        return None
    moved = {geom: list(_parts_above(model, int(model.geom_bodyid[geom]), body)) for geom in geoms}
    leaves = []
    for part in sorted({part for parts in moved.values() for part in parts}):
        rows = [row for row, geom in enumerate(geoms) if part in moved[geom]]
        first, end = starts[rows[0]], starts[rows[-1] + 1]
        leaves += [
            Leaf(
                joint=model.joint(joint).name,
                kind=_LEAF_KINDS[int(model.jnt_type[joint])],
                axis=_vector(data.xaxis[joint] @ frame),
                anchor=_vector((data.xanchor[joint] - origin) @ frame),
                first=first,
                count=end - first,
            )
            for joint in range(model.body_jntadr[part], model.body_jntadr[part] + model.body_jntnum[part])
            if int(model.jnt_type[joint]) in _LEAF_KINDS and end > first
        ]
    return structs.replace(surface, leaves=tuple(leaves))


def digest_of(surface: Surface) -> str:
    """Return the digest of a surface, which is equal for equal surfaces only."""
    return hashlib.blake2b(codec.encode(surface), digest_size=16).hexdigest()


def _parts_above(model: mujoco.MjModel, part: int, body: int) -> Iterator[int]:
    """Yield the bodies with joints from `part` up, below `body`, whose own joints move all of it."""
    while part not in (0, body):
        if model.body_jntnum[part]:
            yield part
        part = int(model.body_parentid[part])


def _surface(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: Sequence[int], origin: Floats, frame: Floats
) -> tuple[Surface, list[int]]:
    """Return the surface of these geoms in a frame, and the first row of each geom's points, and the end.

    `origin` (3,) [m] is its origin, and the columns of `frame` (3, 3) are its axes.
    """
    points, normals, colours, triangles, starts = [], [], [], [], [0]
    for geom in geoms:
        if (part := _part(model, geom)) is None:
            starts.append(starts[-1])
            continue
        piece, turn = facets(part), frame.T @ data.geom_xmat[geom].reshape(3, 3)
        points.append(piece.points @ turn.T + (data.geom_xpos[geom] - origin) @ frame)
        normals.append(piece.normals @ turn.T)
        colours.append(np.tile(part.colour, (len(piece.points), 1)))
        triangles.append(piece.triangles + starts[-1])
        starts.append(starts[-1] + len(piece.points))
    surface = Surface(
        points=_rounded(points).astype("<f4").tobytes(),
        normals=_rounded(normals).astype("<f4").tobytes(),
        colours=np.round(255.0 * _rows(colours)).astype("u1").tobytes(),
        triangles=_rows(triangles).astype("<u4").tobytes(),
    )
    return surface, starts


def _rounded(pieces: Sequence[NDArray[Any]]) -> NDArray[Any]:
    return np.round(_rows(pieces), _DECIMALS) + 0.0  # no negative zeros, which are other bytes


def _vector(values: Floats) -> Vec3:
    x, y, z = (float(value) for value in np.round(values, _DECIMALS) + 0.0)
    return x, y, z


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
