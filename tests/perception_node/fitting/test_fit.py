"""Models fitted to the points of one camera."""

from __future__ import annotations

import math
from importlib.util import find_spec

import numpy as np
import pytest

from semmap.nodes.perception_node.fitting.fit import (
    MOST_POINTS,
    Fit,
    angle_between,
    available,
    fit_models,
    quaternion,
    thinned,
)
from semmap.nodes.perception_node.fitting.model_surfaces import shipped
from semmap.nodes.sim_node.models.parts import rotation_matrix
from semmap.schemas.entities import Pose
from tests.perception_node.fitting.seen import EYE, TOP_M, box, model, rotation, shown

pytestmark = pytest.mark.skipif(find_spec("open3d") is None, reason="Open3D is not installed")


def fit(class_, yaw, said_yaw, said_class=None):
    surface = model(class_)
    pose, size_m = box(surface, said_yaw)
    said = said_class or class_
    return fit_models(said, [model(said)], shown(surface, yaw), pose, size_m, [])


def test_models_are_fitted_where_open3d_is_installed():
    assert available()


def off_deg(found, yaw):
    said = np.asarray(rotation_matrix(found.pose.orientation_wxyz))
    return math.degrees(angle_between(said, rotation(yaw), found.fold))


@pytest.mark.parametrize(("class_", "yaw"), [("Laptop", 2.2), ("Iron", -0.5), ("Shoes", 0.9)])
@pytest.mark.parametrize("said", [0.05, math.pi])
def test_a_front_is_found_whichever_way_the_box_was_taken(class_, yaw, said):
    found = fit(class_, yaw, yaw + said)
    assert off_deg(found, yaw) < 3.0
    assert found.clear
    assert found.has_orientation
    assert found.score > 0.6
    np.testing.assert_allclose(found.pose.position_m, [0.1, 0.2, TOP_M], atol=0.006)


def test_what_has_an_axis_is_turned_by_half_a_turn_at_will():
    found = fit("Cereals", 0.7, 0.75)
    assert found.fold == 2
    assert found.clear
    assert off_deg(found, 0.7) < 2.0


def test_what_is_round_has_no_orientation():
    found = fit("Bottle", 1.0, 0.0)
    assert found.fold == 0
    assert not found.has_orientation
    assert found.score > 0.6


def of_all_forms(shape, yaw):
    pose, size_m = box(shape, yaw + 0.1)
    points = shown(shape, yaw)
    return fit_models("Bottle", shipped()["Bottle"], points, pose, size_m, [])


def test_a_thing_is_fitted_with_the_form_that_fits_it():
    usual, _, spray, _ = shipped()["Bottle"]
    found = of_all_forms(spray, 0.6)
    pose, size_m = box(spray, 0.7)
    assert found.score > 1.1 * fit_models("Bottle", [usual], shown(spray, 0.6), pose, size_m, []).score
    assert found.has_orientation
    assert off_deg(found, 0.6) < 4.0
    assert not of_all_forms(usual, 0.6).has_orientation


def test_a_thing_of_quite_another_form_does_not_bear_its_name_out():
    laptop = model("Laptop")
    pose, size_m = box(laptop, 0.0)
    wall = np.random.default_rng(0).uniform([-0.2, -0.1, 0.7], [0.4, 0.5, 1.3], (400, 3))
    found = fit_models("Laptop", [laptop], wall, pose, size_m, [])
    assert not found.is_verified
    assert not found.has_orientation
    assert fit("Laptop", 0.0, 0.0).is_verified


def test_a_lying_bottle_lies():
    bottle = model("Bottle")
    laid = bottle.rotated(np.array([[0, 0, 1.0], [0, 1.0, 0], [-1.0, 0, 0]]))  # its top to +x
    yaw = 0.6
    points = laid.points @ rotation(yaw).T + [0.1, 0.2, TOP_M]
    facing = ((EYE - points) * (laid.normals @ rotation(yaw).T)).sum(axis=1) > 0.0
    pose, size_m = box(laid, yaw)
    found = fit_models("Bottle", [bottle], points[facing], pose, size_m, [])
    assert found.lying
    axis = np.asarray(rotation_matrix(found.pose.orientation_wxyz))[:, 2]
    assert axis @ [math.cos(yaw), math.sin(yaw), 0.0] > math.cos(math.radians(5.0))
    foot = np.array([0.1, 0.2, TOP_M + laid.size_m[2] / 2]) - laid.size_m[0] / 2 * axis
    np.testing.assert_allclose(found.pose.position_m, foot, atol=0.015)


def test_too_little_is_not_fitted():
    cup = model("Cup")
    pose, size_m = box(cup, 0.0)
    assert fit_models("Cup", [cup], shown(cup, 0.0)[:20], pose, size_m, []) is None
    assert fit_models("Cup", [cup], np.full((500, 3), np.nan), pose, size_m, []) is None


@pytest.mark.parametrize("yaw", [0.0, 1.3, math.pi, -3.0])
def test_rotations_are_quaternions(yaw):
    w, x, y, z = quaternion(rotation(yaw))
    assert (x, y) == pytest.approx((0.0, 0.0))
    assert math.remainder(2.0 * math.atan2(z, w) - yaw, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("count", "left"),
    [
        (0, 0),
        (MOST_POINTS, MOST_POINTS),
        (MOST_POINTS + 2, MOST_POINTS // 2 + 1),
        (2 * MOST_POINTS, MOST_POINTS),
    ],
)
def test_many_points_are_thinned_evenly(count, left):
    points = np.arange(3 * count, dtype=float).reshape(-1, 3)
    found = thinned(points)
    assert len(found) == left
    assert len(found) < 2 or len(set(np.diff(found[:, 0]))) == 1


@pytest.mark.parametrize(
    ("fold", "turned_deg", "angle_deg"),
    [
        (1, 90.0, 90.0),
        (1, -170.0, 170.0),
        (2, 180.0, 0.0),
        (2, 90.0, 90.0),
        (4, 90.0, 0.0),
        (4, 50.0, 40.0),
        (0, 77.0, 0.0),
    ],
)
def test_turns_of_a_symmetric_thing_do_not_count(fold, turned_deg, angle_deg):
    found = angle_between(rotation(0.3), rotation(0.3 + math.radians(turned_deg)), fold)
    assert math.degrees(found) == pytest.approx(angle_deg, abs=1e-4)


def test_a_round_thing_is_turned_by_the_angle_of_its_axis():
    lying = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    assert angle_between(rotation(1.0), lying, 0) == pytest.approx(math.pi / 2)


UPRIGHT = Pose(position_m=(0.0, 0.0, 0.0))
LYING = Pose(position_m=(0.0, 0.0, 0.0), orientation_wxyz=(math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0))


@pytest.mark.parametrize(
    ("score", "clear", "fold", "pose", "is_verified", "has_orientation"),
    [
        (0.15, True, 1, UPRIGHT, True, True),
        (0.14, True, 1, UPRIGHT, False, False),
        (0.9, False, 1, UPRIGHT, True, False),
        (0.9, True, 0, UPRIGHT, True, False),
        (0.9, True, 0, LYING, True, True),
    ],
)
def test_an_orientation_is_known_if_it_is_clear_and_not_symmetric(
    score, clear, fold, pose, is_verified, has_orientation
):
    found = Fit("Cup", pose, (0.1, 0.1, 0.1), score, clear, fold)
    assert (found.is_verified, found.has_orientation) == (is_verified, has_orientation)
    assert found.lying == (pose is LYING)
