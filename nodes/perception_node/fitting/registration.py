"""Open3D's registration of what was seen with a model that stands or lies on something."""

from __future__ import annotations

import numpy as np

from semmap.nodes.perception_node.fitting.initial_poses import InitialPose
from semmap.nodes.perception_node.views.boxes import Numbers

_RINGS = (0.9, 1.4)
_STEPS = 24
_ITERATIONS = 30
_REACH = 0.3
"""Points pair with what is nearer than this share of the model's largest extent."""
_REACH_M = (0.02, 0.08)
_FINE = 0.4


def registered(points: Numbers, start: InitialPose, pose: Numbers, within_m: float, *, fine: bool) -> Numbers:
    """(4, 4) where the model's frame is in the map, nearer to the points (N, 3) than at `pose`.

    From points to planes, and from the view to the model: the model is whole, the view is not. Points
    of the support around it, in both, keep it on its support. `fine`: from near, to the end.
    """
    import open3d

    register = open3d.pipelines.registration
    model = start.model
    reach = float(max(model.size_m))
    ring = _ring(reach)
    up = np.tile([0.0, 0.0, 1.0], (len(ring), 1))
    share = _FINE if fine else 1.0
    result = register.registration_icp(
        _cloud(np.concatenate([points, ring @ start.pose[:3, :3].T + start.pose[:3, 3]])),
        _cloud(np.concatenate([model.points, ring]), np.concatenate([model.normals, up])),
        share * float(np.clip(_REACH * reach, *_REACH_M)),
        np.linalg.inv(pose),
        register.TransformationEstimationPointToPlane(register.TukeyLoss(k=4.0 * share * within_m)),
        register.ICPConvergenceCriteria(max_iteration=_ITERATIONS),
    )
    return np.asarray(np.linalg.inv(result.transformation))


def _ring(reach_m: float) -> Numbers:
    """Points of the support around a thing, in its own frame."""
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
