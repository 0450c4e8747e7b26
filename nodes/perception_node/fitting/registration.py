"""Registration of observed points with a standing or lying model, by Open3D."""

from __future__ import annotations

import numpy as np

from semmap.nodes.perception_node.fitting.initial_poses import InitialPose
from semmap.nodes.perception_node.views.boxes import Numbers

_RINGS = (0.9, 1.4)
_STEPS = 24
_ITERATIONS = 30
_REACH = 0.3
"""Maximum distance of paired points, as a share of the model's largest extent."""
_REACH_M = (0.02, 0.08)
_FINE = 0.4


def register(points: Numbers, start: InitialPose, pose: Numbers, within_m: float, *, fine: bool) -> Numbers:
    """Return the pose (4, 4) of the model's frame in the map after registration, starting at `pose`.

    Point-to-plane ICP from the view to the model, since the model is complete and the view is not. Points of
    the support around the thing, in both, keep it on its support. `fine`: use a small search radius.
    """
    import open3d

    registration = open3d.pipelines.registration
    model = start.model
    reach = float(max(model.size_m))
    ring = _ring(reach)
    up = np.tile([0.0, 0.0, 1.0], (len(ring), 1))
    share = _FINE if fine else 1.0
    result = registration.registration_icp(
        _cloud(np.concatenate([points, ring @ start.pose[:3, :3].T + start.pose[:3, 3]])),
        _cloud(np.concatenate([model.points, ring]), np.concatenate([model.normals, up])),
        share * float(np.clip(_REACH * reach, *_REACH_M)),
        np.linalg.inv(pose),
        registration.TransformationEstimationPointToPlane(registration.TukeyLoss(k=4.0 * share * within_m)),
        registration.ICPConvergenceCriteria(max_iteration=_ITERATIONS),
    )
    return np.asarray(np.linalg.inv(result.transformation))


def _ring(reach_m: float) -> Numbers:
    """Return points of the support around a thing, in its own frame."""
    angles = np.linspace(0.0, 2.0 * np.pi, _STEPS, endpoint=False)
    rings = [
        np.stack([r * reach_m * np.cos(angles), r * reach_m * np.sin(angles), 0.0 * angles], axis=1)
        for r in _RINGS
    ]
    return np.concatenate(rings)


def _cloud(points: Numbers, normals: Numbers | None = None) -> object:
    import open3d

    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(np.ascontiguousarray(points)))
    if normals is not None:
        cloud.normals = open3d.utility.Vector3dVector(np.ascontiguousarray(normals))
    return cloud
