"""Models that are aligned with points of their own surface, as a camera sees them."""

from pathlib import Path

import numpy as np

from semmap.nodes.perception_node.fitting.evidence import spacing_m, verified_share, visible_share
from semmap.nodes.perception_node.fitting.fit import angle_between, fit_models, quaternion, thinned
from semmap.nodes.perception_node.fitting.initial_poses import (
    choice_distance,
    in_proportion,
    initial_poses,
    placed,
    size_mismatch,
    stretch,
)
from semmap.nodes.perception_node.fitting.model_surfaces import shipped
from semmap.nodes.perception_node.fitting.registration import register
from semmap.schemas.entities import Pose, orientation_from_yaw
from tests.perception_node.drawn import check, cloud, summary

FOLDER = Path(__file__).parent / "stages"
CLASSES = ("Cup", "Bottle", "Book", "Chair")
AT = (0.2, 0.1, 0.7)
YAW_RAD = 0.5


def seen_surface(model):
    """Return the points of a model on the table that face the camera at the left."""
    turn = placed(YAW_RAD, Pose(position_m=AT))
    points = model.points @ turn[:3, :3].T + turn[:3, 3]
    normals = model.normals @ turn[:3, :3].T
    eye = cloud("left").map_from_camera[:3, 3]
    return points[((eye - points) * normals).sum(axis=1) > 0]


def starts_of_models():
    found = {}
    for name in CLASSES:
        for number, model in enumerate(shipped()[name][:2]):
            size = tuple((model.size_m * (1.1, 0.9, 1.05)).tolist())
            starts = list(
                initial_poses(model, Pose(position_m=AT, orientation_wxyz=orientation_from_yaw(0.4)), size)
            )
            found[f"{name} {number}"] = [
                len(model.points),
                model.fold,
                spacing_m(model),
                *model.size_m.tolist(),
                len(starts),
                *(
                    v
                    for s in starts
                    for v in (stretch(s), int(s.lying), *s.laid_m.tolist(), *s.pose[0].tolist())
                ),
            ]
            turned = model.rotated(np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]]))
            wide = model.scaled(model.size_m * (2.0, 1.0, 1.0))
            found[f"{name} {number} changed"] = [
                *summary(turned.points),
                *summary(turned.normals),
                *turned.size_m.tolist(),
                turned.fold,
                *summary(wide.points),
                *summary(wide.normals),
                *wide.size_m.tolist(),
                wide.fold,
            ]
    sizes = [np.array(size) for size in ((0.1, 0.1, 0.2), (0.3, 0.1, 0.1), (0.1, 0.3, 0.1), (0.2, 0.2, 0.05))]
    found["mismatch"] = [size_mismatch(one, other) for one in sizes for other in sizes]
    found["distance"] = [choice_distance(one, other) for one in sizes for other in sizes]
    found["proportion"] = [v for one in sizes for other in sizes for v in in_proportion(one, other).tolist()]
    return found


def evidence_and_fits():
    found, view = {}, cloud("left")
    for name in CLASSES:
        models = shipped()[name]
        model, pose = models[0], placed(YAW_RAD, Pose(position_m=AT))
        points = seen_surface(model)
        off = pose.copy()
        off[0, 3] += 0.01
        found[f"{name} evidence"] = [
            len(points),
            verified_share(points, model, pose, 0.008),
            verified_share(points, model, off, 0.008),
            visible_share(model, pose, [view], 0.012),
            visible_share(model, off, [view, cloud("right")], 0.012),
        ]
        start = next(
            iter(
                initial_poses(
                    model,
                    Pose(position_m=AT, orientation_wxyz=orientation_from_yaw(YAW_RAD)),
                    tuple(model.size_m.tolist()),
                )
            )
        )
        for fine in (False, True):
            made = register(thinned(points), start, off, 0.008, fine=fine)
            found[f"{name} registered {fine}"] = made.ravel().tolist()
        box = Pose(position_m=AT, orientation_wxyz=orientation_from_yaw(YAW_RAD))
        fit = fit_models(name, models, points, box, tuple(model.size_m.tolist()), [])
        found[f"{name} fit"] = [
            *fit.pose.position_m,
            *fit.size_m,
            fit.score,
            int(fit.clear),
            fit.fold,
            int(fit.is_verified),
            int(fit.lying),
        ]
    found["no clouds"] = [visible_share(model, pose, [], 0.012)]
    found["few points"] = [fit_models("Cup", shipped()["Cup"], points[:59], box, (0.1, 0.1, 0.1), [])]
    return found


def rotations():
    found = {}
    for name, turn in {
        "none": np.eye(3),
        "half z": np.diag([-1.0, -1, 1]),
        "half x": np.diag([1.0, -1, -1]),
        "half y": np.diag([-1.0, 1, -1]),
        "quarter": placed(np.pi / 2, Pose(position_m=AT))[:3, :3],
        "third": placed(2.0, Pose(position_m=AT))[:3, :3],
    }.items():
        found[name] = [*quaternion(turn), *(angle_between(np.eye(3), turn, fold) for fold in (0, 1, 2, 4))]
    return found


def test_a_model_is_tried_in_all_orientations_that_fit_the_box():
    check(starts_of_models(), FOLDER / "starts.json")


def test_a_model_fits_the_points_of_its_own_surface():
    check(evidence_and_fits(), FOLDER / "fits.json")


def test_the_angle_between_orientations_depends_on_the_symmetry():
    check(rotations(), FOLDER / "rotations.json")
