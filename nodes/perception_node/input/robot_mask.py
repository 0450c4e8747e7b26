"""Leaves the robot's own body out of clouds, by its model, its joints and the pose of its base."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from semmap.nodes.perception_node.input.cloud import Cloud, Transform
from semmap.nodes.perception_node.input.files.camera_files import pose_of
from semmap.schemas import codec
from semmap.schemas.entities import Radians
from semmap.schemas.errors import BadFile
from semmap.schemas.nesting import NotWellFormed, require_shallow_xml
from semmap.schemas.wording import few, sentence

_MARGIN_M = 0.02
"""Points up to here from the visible surface of the model are the robot's: noise, cables, inexact joints."""
_OTHER_GROUP = 5


class _State(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The file: `model` is a path from its folder; `joints` are in rad or m, and those left out are 0."""

    model: str
    joints: dict[str, Radians] = {}
    map_from_base: tuple[Any, ...] | None = None


class RobotBody:
    """The surfaces of a robot, at first with all joints at 0 and its base at the map's origin."""

    def __init__(self, model: Path) -> None:
        """Load an MJCF or URDF file. Raises BadFile if it is not valid."""
        import mujoco

        self._name = model.name
        try:
            with suppress(NotWellFormed):  # which MuJoCo reports
                require_shallow_xml(model.read_bytes())
            self._model: Any = mujoco.MjModel.from_xml_path(str(model))
        except OSError as error:
            raise BadFile(f"the robot's model {model} cannot be read: {error.strerror}") from None
        except ValueError as error:
            reason = " ".join(str(error).split())
            raise BadFile(f"{model} cannot be read as MJCF or URDF: {reason}") from None
        self._data: Any = mujoco.MjData(self._model)
        single = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)
        self._places = {
            self._model.joint(n).name: self._model.jnt_qposadr[n]
            for n in range(self._model.njnt)
            if self._model.jnt_type[n] in single
        }
        self.set_state({}, np.eye(4))
        unbounded = int(mujoco.mjtGeom.mjGEOM_PLANE), int(mujoco.mjtGeom.mjGEOM_HFIELD)
        groups = np.minimum(self._model.geom_group, _OTHER_GROUP - 1)
        groups[np.isin(self._model.geom_type, unbounded)] = _OTHER_GROUP
        self._model.geom_group[:] = groups

    def set_state(self, joints: Mapping[str, float], map_from_base: Transform) -> None:
        """Move the base and the joints [rad, m], those left out to 0. Raises BadFile for an unknown joint."""
        import mujoco

        if unknown := sorted(joints.keys() - self._places.keys()):
            own = few(sorted(self._places), 5)
            raise BadFile(f"{self._name} has no joint '{unknown[0]}'; its joints: {own}")
        for name, place in self._places.items():
            self._data.qpos[place] = joints.get(name, 0.0)
        mujoco.mj_kinematics(self._model, self._data)
        self._base_from_map = np.linalg.inv(map_from_base)

    def remove_from(self, cloud: Cloud, *, is_in_view: bool = True) -> Cloud:
        """Return a cloud without the points on the robot, with a note if none are and `is_in_view` is set.

        Raises BadFile if the pose of the camera is unknown.
        """
        if cloud.map_from_camera is None:
            raise BadFile("--mask-robot requires the camera's pose: --pose, or map_from_camera in its file")
        points = cloud.points_camera
        seen = points[..., 2] > 0
        own = np.zeros(seen.shape, np.bool_)
        own[seen] = self._covers(points[seen], self._base_from_map @ cloud.map_from_camera)
        if not own.any():
            if not is_in_view:
                return cloud
            note = "the robot's model covers no point: check its joints, map_from_base and the camera's pose"
            return replace(cloud, notes=(*cloud.notes, note))
        return replace(cloud, points_camera=np.where(own[..., None], np.nan, points).astype(points.dtype))

    def _covers(self, points: NDArray[np.floating], base_from_camera: Transform) -> NDArray[np.bool_]:
        """Return (N,) which points (N, 3) are behind the model's visible surface, or close to it."""
        import mujoco

        ranges = np.linalg.norm(points, axis=1)
        rays = points.astype(float) / ranges[:, None]
        hits, geoms = np.empty(len(points)), np.empty(len(points), np.int32)
        groups = np.array([1] * _OTHER_GROUP + [0], np.uint8)
        mujoco.mj_multiRay(
            self._model,
            self._data,
            base_from_camera[:3, 3],
            (rays @ base_from_camera[:3, :3].T).ravel(),
            groups,
            1,
            -1,
            geoms,
            hits,
            None,
            len(points),
            mujoco.mjMAXVAL,
        )
        on = geoms >= 0
        covered: NDArray[np.bool_] = on & (ranges >= hits - _MARGIN_M)
        if on.any():
            surface = cKDTree(rays[on] * hits[on, None])
            rest = np.flatnonzero(~covered)
            covered[rest] = np.isfinite(surface.query(points[rest], distance_upper_bound=_MARGIN_M)[0])
        return covered


def read_robot(path: Path) -> RobotBody:
    """Read a JSON file of a robot's state: `model`, `joints` and `map_from_base`. Raises BadFile."""
    try:
        state = codec.decode_json(codec.decode_text(path.read_bytes()))
        of = msgspec.convert(state, codec.prepared(_State))
        base = pose_of(of.map_from_base, "map_from_base")
    except OSError as error:
        raise BadFile(f"{path} cannot be read: {error.strerror}") from None
    except ValueError as error:
        readable = isinstance(error, (msgspec.MsgspecError, UnicodeError))
        why = sentence(error, _State) if readable else str(error)
        raise BadFile(f"{path} is not the state of a robot (model, joints, map_from_base): {why}") from None
    body = RobotBody(path.parent / of.model)
    body.set_state(of.joints, np.eye(4) if base is None else base)
    return body
