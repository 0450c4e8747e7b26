"""Body slots: spare bodies of a compiled model that newcomers are written into.

To compile costs time with the square of the number of free bodies, so a model is compiled with some bodies
more than are asked for. A newcomer is written into one of these: the rows that it has in a model compiled of
it alone are copied. Who leaves is hidden, touches nothing and is too heavy to move, until another comes.
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
"""At least and at most so many are compiled to spare: one to every `_SPARE_OF` bodies in between."""

_SPARE_OF = 8
_SPARE_PARTS = (14, 14, 14, 28)
"""Nine models out of ten have no more than 18 parts, three out of four 12."""


@dataclass(frozen=True)
class BodySlot:
    """Body number `body` of a model, which stays where it is put if `static`.

    It has `geoms` geoms from number `geom` on and `nodes` nodes of the tree of bounding boxes from `node` on.
    """

    body: int
    static: bool
    geom: int
    geoms: int
    node: int
    nodes: int

    @staticmethod
    def of(model: mujoco.MjModel, name: str) -> BodySlot:
        """The body of that name in a model as it was compiled."""
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
        """Whether a body has room here."""
        return self.static == static and self.geoms >= alone.ngeom and self.nodes >= alone.body_bvhnum[1]


def spare_slots(bodies: int) -> list[tuple[bool, int]]:
    """The slots to compile beside so many bodies: for each whether it is static, and for how many parts."""
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
    """Make `slot` the body of the newcomer, whose model `alone` is, standing at `pose` and awake."""
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
    """Nobody is here: nothing to see, nothing to touch, nothing that moves, and no name."""
    body = slot.body
    model.name_bodyadr[body] = (
        model.nnames - 1
    )  # where the last name ends; names themselves cannot be written
    geoms = slice(slot.geom, slot.geom + slot.geoms)
    model.geom_contype[geoms] = model.geom_conaffinity[geoms] = 0
    model.geom_group[geoms] = build.FELT_GROUP
    model.body_contype[body] = model.body_conaffinity[body] = 0
    data.xfrc_applied[body] = 0.0
    if not slot.static:
        model.name_jntadr[model.body_jntadr[body]] = model.nnames - 1
        dofs = slice(int(model.body_dofadr[body]), int(model.body_dofadr[body]) + 6)
        model.dof_M0[dofs] = _IMMOVABLE_KG
        data.qvel[dofs] = data.qacc_warmstart[dofs] = 0.0


def _copy_boxes(model: mujoco.MjModel, slot: BodySlot, alone: mujoco.MjModel) -> None:
    """The tree of bounding boxes, whose leaves name geoms by number."""
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
    """What kinematics would work out; it passes over what is static or was asleep."""
    rotation = rotation_matrix(quaternion.tolist())
    data.xpos[slot.body] = data.xipos[slot.body] = position
    data.xquat[slot.body] = quaternion
    data.xmat[slot.body] = data.ximat[slot.body] = rotation.ravel()
    for geom in range(slot.geom, slot.geom + slot.geoms):
        data.geom_xpos[geom] = position + rotation @ model.geom_pos[geom]
        data.geom_xmat[geom] = (rotation @ rotation_matrix(model.geom_quat[geom].tolist())).ravel()


@lru_cache(maxsize=256)
def compiled_alone(model: Model) -> mujoco.MjModel | None:
    """A MuJoCo model of nothing but this one body, free.

    None if it has meshes, which no slot knows, or joints, whose bodies no slot has.
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
