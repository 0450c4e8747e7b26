"""Body slots: spare bodies of a compiled model into which new bodies are written.

Compilation time grows with the square of the number of free bodies, so a model is compiled with some spare
bodies. A new body is written into a spare one by copying its rows from a model that contains only this body.
A deleted body is hidden, does not collide and is too heavy to move until the slot is reused.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np

from semmap.nodes.sim_node.bodies import BodyRecord, Floats, frame_of
from semmap.nodes.sim_node.models.library import Model
from semmap.nodes.sim_node.models.parts import rotation_matrix
from semmap.nodes.sim_node.physics import build, sleep
from semmap.schemas.entities import Pose

_BODY = ("mass", "inertia", "contype", "conaffinity", "sameframe")
_DOF = ("M0", "invweight0", "length", "damping")
_GEOM = (
    *("type", "dataid", "matid", "group", "contype", "conaffinity", "condim", "friction", "solimp"),
    *("size", "aabb", "rbound", "pos", "quat", "sameframe", "rgba"),
)
_NODE = ("depth", "child", "aabb")
_IMMOVABLE_KG = 1e9
_SPARES = (4, 32)
"""Minimum and maximum number of spare slots: one for every `_SPARE_OF` bodies in between."""

_SPARE_OF = 8
_SPARE_PARTS = (14, 14, 14, 28)
"""Nine models out of ten have at most 18 parts, three out of four at most 12."""


@dataclass(frozen=True)
class BodySlot:
    """Body number `body` of a model, without free joint if `static`.

    It has `geoms` geoms from number `geom` on, and `nodes` nodes of the bounding volume hierarchy from `node`
    on.
    """

    body: int
    static: bool
    geom: int
    geoms: int
    node: int
    nodes: int

    @staticmethod
    def of(model: mujoco.MjModel, name: str) -> BodySlot:
        """Return the slot of a named body in a newly compiled model."""
        body = model.body(name).id
        return BodySlot(
            body=body,
            static=bool(model.body_weldid[body] == 0),
            geom=int(model.body_geomadr[body]),
            geoms=int(model.body_geomnum[body]),
            node=int(model.body_bvhadr[body]),
            nodes=int(model.body_bvhnum[body]),
        )

    def has_room_for(self, alone: mujoco.MjModel, *, static: bool) -> bool:
        """Return whether a body fits."""
        return self.static == static and self.geoms >= alone.ngeom and self.nodes >= alone.body_bvhnum[1]


def spare_slots(bodies: int) -> list[tuple[bool, int]]:
    """Return the spare slots for this many bodies: for each whether it is static, and its number of parts."""
    least, most = _SPARES
    count = min(most, least + bodies // _SPARE_OF)
    return [(i % 6 == 5, _SPARE_PARTS[i % len(_SPARE_PARTS)]) for i in range(count)]


def fill_slot(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    slot: BodySlot,
    newcomer: tuple[BodyRecord, mujoco.MjModel],
    pose: Pose,
) -> None:
    """Write a body, whose model is `alone`, into a slot, at `pose` and awake."""
    (record, alone), body = newcomer, slot.body
    clear_slot(model, data, slot)
    for field in _BODY:
        getattr(model, f"body_{field}")[body] = getattr(alone, f"body_{field}")[1]
    geoms = slice(slot.geom, slot.geom + alone.ngeom)
    for field in _GEOM:
        getattr(model, f"geom_{field}")[geoms] = getattr(alone, f"geom_{field}")
    _copy_boxes(model, slot, alone)
    if record.ghost:
        model.geom_contype[geoms] = model.geom_conaffinity[geoms] = 0
        model.body_contype[body] = model.body_conaffinity[body] = 0
    position, quaternion = frame_of(pose, record.origin_m)
    model.body_pos[body], model.body_quat[body] = position, quaternion
    if not slot.static:
        dof = int(model.body_dofadr[body])
        for field in _DOF:
            getattr(model, f"dof_{field}")[dof : dof + 6] = getattr(alone, f"dof_{field}")
        model.body_invweight0[body] = alone.body_invweight0[1]
        joint = int(model.jnt_qposadr[model.body_jntadr[body]])
        data.qpos[joint : joint + 7] = np.concatenate([position, quaternion])
        sleep.wake(data, int(model.body_treeid[body]))
    _set_frames(model, data, slot, position, quaternion)


def clear_slot(model: mujoco.MjModel, data: mujoco.MjData, slot: BodySlot) -> None:
    """Clear a slot: it is invisible, does not collide or move, and has no name."""
    body = slot.body
    model.name_bodyadr[body] = model.nnames - 1  # the end of the last name; names are read-only
    geoms = slice(slot.geom, slot.geom + slot.geoms)
    model.geom_contype[geoms] = model.geom_conaffinity[geoms] = 0
    model.geom_group[geoms] = build.COLLISION_GROUP
    model.body_contype[body] = model.body_conaffinity[body] = 0
    data.xfrc_applied[body] = 0.0
    if not slot.static:
        model.name_jntadr[model.body_jntadr[body]] = model.nnames - 1
        dofs = slice(int(model.body_dofadr[body]), int(model.body_dofadr[body]) + 6)
        model.dof_M0[dofs] = _IMMOVABLE_KG
        data.qvel[dofs] = data.qacc_warmstart[dofs] = 0.0


def _copy_boxes(model: mujoco.MjModel, slot: BodySlot, alone: mujoco.MjModel) -> None:
    """Copy the bounding volume hierarchy, whose leaves refer to geoms by number."""
    count = int(alone.body_bvhnum[1])
    nodes = slice(slot.node, slot.node + count)
    for field in _NODE:
        getattr(model, f"bvh_{field}")[nodes] = getattr(alone, f"bvh_{field}")[:count]
    leaves = alone.bvh_nodeid[:count]
    model.bvh_nodeid[nodes] = np.where(leaves < 0, leaves, leaves + slot.geom)
    model.body_bvhnum[slot.body] = count


def _set_frames(
    model: mujoco.MjModel, data: mujoco.MjData, slot: BodySlot, position: Floats, quaternion: Floats
) -> None:
    """Set the frames, since MuJoCo's kinematics skips static and sleeping bodies."""
    rotation = rotation_matrix(quaternion.tolist())
    data.xpos[slot.body] = data.xipos[slot.body] = position
    data.xquat[slot.body] = quaternion
    data.xmat[slot.body] = data.ximat[slot.body] = rotation.ravel()
    for geom in range(slot.geom, slot.geom + slot.geoms):
        data.geom_xpos[geom] = position + rotation @ model.geom_pos[geom]
        data.geom_xmat[geom] = (rotation @ rotation_matrix(model.geom_quat[geom].tolist())).ravel()


@lru_cache(maxsize=256)
def compiled_alone(model: Model) -> mujoco.MjModel | None:
    """Return a MuJoCo model of only this body, free.

    None for a body with meshes or joints, which slots do not support.
    """
    if model.leaves or any(part.mesh for part in model.parts):
        return None
    spec = mujoco.MjSpec()
    x, y, z = model.inertial.centre_m
    record = BodyRecord(
        name="alone",
        class_=None,
        model=model.name,
        size_m=model.size_m,
        origin_m=(-x, -y, -z),
        ordered=Pose(position_m=(0.0, 0.0, 0.0)),
        fixed=False,
        entity=False,
        masks=[],
    )
    build.add_body(spec, record, model, record.ordered)
    return spec.compile()
