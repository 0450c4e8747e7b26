"""Records of the simulator's bodies, and their poses as arrays."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import mujoco
import numpy as np
from msgspec import Struct, structs
from numpy.typing import NDArray

from semmap.nodes.sim_node.models.parts import Vec3, rotation_matrix
from semmap.schemas.entities import Pose
from semmap.schemas.joints import Joint
from semmap.schemas.scenes import Body

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
_BALL = int(mujoco.mjtJoint.mjJNT_BALL)


@dataclass(kw_only=True)
class BodyRecord:
    """The static data of one body of the scene; its motion is in MuJoCo's data.

    `origin_m` is the bottom centre in the frame of the MuJoCo body. `ordered` is the pose from the map or the
    world file. `masks` are contype and conaffinity of each geom while the body collides. `joints` have their
    ordered positions, and `joint_names` are their names in MuJoCo.
    """

    name: str
    class_: str | None
    model: str
    size_m: Vec3
    origin_m: Vec3
    ordered: Pose
    fixed: bool
    entity: bool
    masks: list[tuple[int, int]]
    ghost: bool = False
    in_the_way: str = ""
    """The body that occupies the place of a non-colliding body."""
    commit: int = 0
    shape_commit: int = 0
    joints: tuple[Joint, ...] = ()
    joint_names: tuple[str, ...] = ()
    joint_commit: int = 0
    part_of: str = ""
    """The body of a world file of which it is a part."""
    anchored: bool = False
    """Whether a joint or its parent body fixes it, so that it cannot be moved manually."""
    body: str = ""
    """Its name in MuJoCo, which can be invalid as the name of an entity; by default `name`."""
    label: str = ""
    """The words of its name, if they are not a label of its class."""
    is_sure: bool = True
    """Whether its name or the world file determines its class."""
    robot: bool = False
    surface: str = ""
    """The digest of its surface, if it is in the world file and visible."""
    held_by: str = ""
    grip: Pose | None = None
    """Its pose in the frame of the bottom centre of the body to which it is attached."""
    grip_commit: int = -1

    def __post_init__(self) -> None:
        """Set the name in MuJoCo."""
        self.body = self.body or self.name

    @property
    def static(self) -> bool:
        """Return whether it has no free joint."""
        return self.fixed or self.ghost

    def message(self, pose: Pose, *, resting: bool, positions: Iterable[float] = ()) -> Body:
        """Return the message for the body; `positions` are the current positions of its joints."""
        return Body(
            name=self.name,
            class_=self.class_,
            model=self.model,
            pose=pose,
            size_m=self.size_m,
            fixed=self.fixed,
            entity=self.entity,
            ghost=self.ghost,
            in_the_way=self.in_the_way if self.ghost else "",
            resting=resting,
            commit=self.commit,
            shape_commit=self.shape_commit,
            joints=tuple(
                structs.replace(joint, position=position)
                for joint, position in zip(self.joints, positions, strict=True)
            ),
            joint_commit=self.joint_commit,
            part_of=self.part_of,
            body="" if self.body == self.name else self.body,
            label=self.label,
            robot=self.robot,
            surface=self.surface,
            held_by=self.held_by,
            grip=self.grip,
            grip_commit=self.grip_commit,
        )


class StoredBody(Struct, frozen=True, forbid_unknown_fields=True):
    """The state of one body, which can be restored after a restart.

    `joints` has the coordinates in MuJoCo of each joint, by its name there. `held_by` is the body that it is
    attached to, and `grip` its pose in that body's frame.
    """

    pose: Pose
    joints: dict[str, tuple[float, ...]] = {}
    held_by: str = ""
    grip: Pose | None = None


@dataclass(frozen=True)
class BodyIndex:
    """The positions of bodies in the arrays of a compiled model.

    The N bodies are in the order of `names` and `records`. `qpos` and `dof` (N,) are the addresses of the
    free joint, -1 for a static body. `tree` (N,) is the kinematic tree, -1 for a static body. `ghost` (N,)
    marks non-colliding bodies.

    The J joints of bodies are ordered by body. `joint` (J,) is the number in the model, `joint_body` the row
    of the body, `joint_qpos` and `joint_dof` the addresses. `joint_ball` marks ball joints, and `joint_row`
    maps names in MuJoCo to rows.
    """

    names: tuple[str, ...]
    records: tuple[BodyRecord, ...] = field(repr=False)
    row: dict[str, int]
    body: Ints
    qpos: Ints
    dof: Ints
    tree: Ints
    ghost: NDArray[np.bool_]
    origin_m: Floats = field(repr=False)
    joint: Ints
    joint_body: Ints
    joint_qpos: Ints
    joint_dof: Ints
    joint_ball: NDArray[np.bool_]
    joint_row: dict[str, int]

    @staticmethod
    def of(model: mujoco.MjModel, records: Mapping[str, BodyRecord], numbers: Mapping[str, int]) -> BodyIndex:
        """Build the index of the records' bodies in `model`, given their `numbers` there."""
        names = tuple(records)
        body = np.array([numbers[name] for name in names], dtype=np.int64)
        static = np.array([records[name].static for name in names], dtype=bool)
        joint = np.where(static, -1, model.body_jntadr[body]) if names else np.empty(0, np.int64)
        jointed = [(row, records[name]) for row, name in enumerate(names) if records[name].joints]
        joint_names = [joint_name for _, record in jointed for joint_name in record.joint_names]
        joints = np.array([model.joint(joint_name).id for joint_name in joint_names], dtype=np.int64)
        return BodyIndex(
            names=names,
            records=tuple(records.values()),
            row={name: row for row, name in enumerate(names)},
            body=body,
            qpos=_at(model.jnt_qposadr, joint),
            dof=_at(model.jnt_dofadr, joint),
            tree=model.body_treeid[body].astype(np.int64) if names else joint,
            ghost=np.array([records[name].ghost for name in names], dtype=bool),
            origin_m=np.array([records[name].origin_m for name in names], dtype=float).reshape(-1, 3),
            joint=joints,
            joint_body=np.array([row for row, record in jointed for _ in record.joints], dtype=np.int64),
            joint_qpos=model.jnt_qposadr[joints].astype(np.int64),
            joint_dof=model.jnt_dofadr[joints].astype(np.int64),
            joint_ball=model.jnt_type[joints] == _BALL,
            joint_row={joint_name: row for row, joint_name in enumerate(joint_names)},
        )

    def positions(self, data: mujoco.MjData) -> Floats:
        """Return (J,) joint positions [rad, m]; for a ball joint, the angle from its reference."""
        positions = data.qpos[self.joint_qpos]
        if self.joint_ball.any():
            positions[self.joint_ball] = 2.0 * np.arccos(np.minimum(1.0, np.abs(positions[self.joint_ball])))
        return np.asarray(positions)

    def owners(self, model: mujoco.MjModel) -> NDArray[np.object_]:
        """Return (nbody,) for each body of `model` the name of its body or parent in the index, or ""."""
        names = np.full(model.nbody, "", dtype=object)
        names[self.body] = self.names
        for body in np.flatnonzero(names == ""):  # wholes have lower numbers than their parts
            names[body] = names[model.body_parentid[body]]
        return names

    def joint_coordinates(self, name: str) -> dict[str, slice]:
        """Return where the coordinates of each joint of a body are in `qpos`, by its name in MuJoCo."""
        rows = {joint: self.joint_row[joint] for joint in self.records[self.row[name]].joint_names}
        return {
            joint: slice(start := int(self.joint_qpos[row]), start + (4 if self.joint_ball[row] else 1))
            for joint, row in rows.items()
        }

    def poses(self, data: mujoco.MjData) -> Floats:
        """Return (N, 7) bottom centre [m] and quaternion wxyz of each body, map frame."""
        frames = np.concatenate([data.xpos[self.body], data.xquat[self.body]], axis=1)
        free = self.qpos >= 0
        frames[free] = data.qpos[self.qpos[free, None] + np.arange(7)]
        frames[:, :3] += rotated(frames[:, 3:], self.origin_m)
        return frames


def _at(addresses: NDArray[np.int32], joint: Ints) -> Ints:
    if not len(addresses):
        return np.full(len(joint), -1, dtype=np.int64)
    return np.where(joint >= 0, addresses[np.maximum(joint, 0)], -1).astype(np.int64)


def rotated(quaternions: Floats, vectors: Floats) -> Floats:
    """Return vectors (N, 3), each rotated by its quaternion wxyz (N, 4)."""
    w, axis = quaternions[:, :1], quaternions[:, 1:]
    twice = 2.0 * _cross(axis, vectors)
    return vectors + w * twice + _cross(axis, twice)


def _cross(a: Floats, b: Floats) -> Floats:
    """Return the cross product; for few vectors ten times as fast as np.cross."""
    (ax, ay, az), (bx, by, bz) = a.T, b.T
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=1)


def frame_of(pose: Pose, origin_m: Vec3) -> tuple[Floats, Floats]:
    """Return position (3,) and quaternion (4,) of the MuJoCo body whose bottom centre is at `pose`."""
    quaternion = np.asarray(pose.orientation_wxyz, dtype=float)
    quaternion = quaternion / np.linalg.norm(quaternion)
    position = np.asarray(pose.position_m) - rotation_matrix(quaternion) @ np.asarray(origin_m)
    return position, quaternion


def pose_of(row: Floats) -> Pose:
    """Return one row of `BodyIndex.poses` as a message."""
    x, y, z, *quaternion = (float(value) for value in row)
    return Pose(
        position_m=(x, y, z), orientation_wxyz=(quaternion[0], quaternion[1], quaternion[2], quaternion[3])
    )
