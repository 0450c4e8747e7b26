"""Leaves the robot's own body out of clouds, by its model, its joints and the pose of its base."""

from __future__ import annotations

from collections.abc import Mapping
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
from semmap.schemas.errors import BadFile
from semmap.schemas.wording import few

_MARGIN_M = 0.02
"""Points up to here from the visible surface of the model are the robot's: noise, cables, inexact joints."""
_OTHER_GROUP = 5


class _State(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The file: `model` is a path from its folder; `joints` are in rad or m, and those left out are 0."""

    model: str
    joints: dict[str, float] = {}
    map_from_base: tuple[Any, ...] | None = None


class RobotBody:
    """The surfaces of a robot at some joint values."""

    def __init__(self, model: Path, joints: Mapping[str, float], map_from_base: Transform) -> None:
        """Load an MJCF or URDF file. Raises BadFile for a file or joints that are not valid."""
        import mujoco

        self._base_from_map = np.linalg.inv(map_from_base)
        try:
            self._model: Any = mujoco.MjModel.from_xml_path(str(model))
        except ValueError as error:
            raise BadFile(f"{model} cannot be read as MJCF or URDF: {error}") from None
        self._data: Any = mujoco.MjData(self._model)
        single = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)
        places = {
            self._model.joint(n).name: self._model.jnt_qposadr[n]
            for n in range(self._model.njnt)
            if self._model.jnt_type[n] in single
        }
        if unknown := sorted(joints.keys() - places.keys()):
            raise BadFile(f"{model.name} has no joint '{unknown[0]}'; its joints: {few(sorted(places))}")
        for name, value in joints.items():
            self._data.qpos[places[name]] = value
        mujoco.mj_kinematics(self._model, self._data)
        unbounded = int(mujoco.mjtGeom.mjGEOM_PLANE), int(mujoco.mjtGeom.mjGEOM_HFIELD)
        groups = np.minimum(self._model.geom_group, _OTHER_GROUP - 1)
        groups[np.isin(self._model.geom_type, unbounded)] = _OTHER_GROUP
        self._model.geom_group[:] = groups

    def remove_from(self, cloud: Cloud) -> Cloud:
        """Return a cloud without the points on the robot, with a note if there are none.

        Raises BadFile if the pose of the camera is unknown.
        """
        if cloud.map_from_camera is None:
            raise BadFile("--mask-robot requires the camera's pose: --pose, or map_from_camera in its file")
        points = cloud.points_camera
        seen = points[..., 2] > 0
        own = np.zeros(seen.shape, np.bool_)
        own[seen] = self._covers(points[seen], self._base_from_map @ cloud.map_from_camera)
        if not own.any():
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
    except ValueError as error:  # of msgspec, too
        raise BadFile(f"{path} is not the state of a robot (model, joints, map_from_base): {error}") from None
    return RobotBody(path.parent / of.model, of.joints, np.eye(4) if base is None else base)
