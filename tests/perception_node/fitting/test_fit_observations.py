"""Fits applied to the observations of a frame."""

from __future__ import annotations

import math
from importlib.util import find_spec

import numpy as np
import pytest
from msgspec import structs

from semmap.nodes.perception_node.fitting.fit import Fit, angle_between
from semmap.nodes.perception_node.fitting.fit_observations import fit_all, fit_of, lies_across, with_fit
from semmap.nodes.perception_node.fitting.model_surfaces import shipped as surfaces
from semmap.nodes.perception_node.pipeline import observe_clouds
from semmap.nodes.perception_node.recognition.recognition_model import shipped
from semmap.nodes.sim_node.models.parts import rotation_matrix
from semmap.schemas.entities import Pose, orientation_from_yaw
from tests.perception_node.fitting.seen import box, model, shown
from tests.perception_node.scenes import shot
from tests.perception_node.things import at, seen

needs_open3d = pytest.mark.skipif(find_spec("open3d") is None, reason="Open3D is not installed")


def fit(*, yaw=0.0, score=0.8, clear=True, fold=1, size_m=(0.2, 0.1, 0.1)):
    pose = Pose(position_m=(0, 0, 0.7), orientation_wxyz=orientation_from_yaw(yaw))
    return Fit("Book", pose, size_m, score, clear, fold)


@needs_open3d
def test_what_cameras_see_is_fitted_with_its_orientation():
    found = observe_clouds(shot().clouds, shipped())
    told = fit_all(shot().clouds, found, surfaces())
    cereals = next(o for o in told if o.class_ == "Cereals")
    true = next(body for body in shot().bodies if body.name == "cereals").pose
    said, right = (np.asarray(rotation_matrix(p.orientation_wxyz)) for p in (cereals.pose, true))
    assert math.degrees(angle_between(said, right, 2)) < 4.0
    assert cereals.fit > 0.5
    assert [o.class_ for o in told] == [o.class_ for o in found.observations.observations]


@needs_open3d
def test_only_what_has_a_model_and_enough_points_is_fitted():
    laptop = model("Laptop")
    pose, size_m = box(laptop, 0.3)
    whole = seen("Laptop", pose, size_m)
    points = shown(laptop, 0.3)
    assert fit_of(whole, points, [], surfaces()) is not None
    assert fit_of(whole, points[:20], [], surfaces()) is None
    assert fit_of(structs.replace(whole, class_="Object"), points, [], surfaces()) is None


def test_an_observation_takes_its_orientation_from_the_model():
    book = seen("Book", at(0, 0, yaw=0.1), (0.2, 0.1, 0.03))
    told = with_fit(book, fit(yaw=0.1 + math.pi / 2, fold=2))
    assert told.pose.yaw_rad == pytest.approx(0.1 + math.pi / 2)
    assert told.pose.position_m == book.pose.position_m
    assert told.size_m == (0.1, 0.2, 0.03)
    assert told.fit == 0.8


def test_what_is_not_clear_or_round_keeps_the_yaw_of_its_box():
    book = seen("Book", at(0, 0, yaw=0.1))
    for found in (fit(yaw=1.0, clear=False), fit(yaw=1.0, fold=0)):
        assert with_fit(book, found) == structs.replace(book, fit=0.8)
    assert with_fit(book, None) == book


def test_a_name_that_the_form_does_not_bear_out_is_taken_back():
    told = with_fit(seen("Book", at(0, 0)), fit(score=0.05))
    assert (told.class_, told.fit) == ("Object", 0.05)
    part = with_fit(seen("Book", at(0, 0), whole=False), fit(yaw=1.0, score=0.05))
    assert (part.class_, part.pose) == ("Book", at(0, 0))


def test_a_name_that_was_shown_is_not_taken_back():
    told = with_fit(structs.replace(seen("Book", at(0, 0)), shown=True), fit(yaw=1.0, score=0.05))
    assert (told.class_, told.pose, told.fit) == ("Book", at(0, 0), 0.05)


def test_a_model_does_not_lie_across_a_long_box():
    pose = at(0, 0, yaw=0.0)
    assert not lies_across(fit(yaw=math.pi), pose, (0.2, 0.1, 0.1))
    assert not lies_across(fit(yaw=math.pi / 2), pose, (0.1, 0.2, 0.1))
    assert lies_across(fit(yaw=math.pi / 2), pose, (0.2, 0.1, 0.1))
    assert lies_across(fit(yaw=0.8), pose, (0.2, 0.1, 0.1))
    assert not lies_across(fit(yaw=0.8), pose, (0.11, 0.1, 0.1))
