"""The initial view, viewpoints, and the selection of labels."""

import math
import random

import numpy as np
import pytest

from semmap.nodes.extern.web.scene.camera import FOV_RAD, View, extent, first_view, fit_view, select_labels
from semmap.nodes.extern.web.scene.sensor_overlay import wxyz_of
from tests.extern.web.scene.sample_scenes import entity, pose


def looking(eye, target, width=800, height=600):
    ahead = np.subtract(target, eye) / np.linalg.norm(np.subtract(target, eye))
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right = right / np.linalg.norm(right)
    rotation = np.column_stack([right, np.cross(ahead, right), ahead])
    return View(tuple(eye), wxyz_of(rotation), FOV_RAD, width, height)


def test_the_target_is_projected_to_the_image_centre():
    view = looking((0.0, -5.0, 2.0), (0.0, 0.0, 0.0))
    at = view.project(np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)]))
    assert at[0] == pytest.approx((400.0, 300.0, math.hypot(5.0, 2.0)))
    assert at[1][0] > 400.0
    assert at[2][1] < 300.0


@pytest.mark.parametrize("aspect", [0.4, 1.0, 2.5])
@pytest.mark.parametrize("far", [(10.0, 8.0, 2.5), (3.0, 40.0, 1.0), (0.2, 0.2, 0.2)])
def test_the_initial_view_shows_everything(aspect, far):
    points = np.array([(x, y, z) for x in (0.0, far[0]) for y in (0.0, far[1]) for z in (0.0, far[2])])
    eye, target = first_view(points, aspect)
    at = looking(eye, target, 600 * aspect, 600).project(points)
    assert (at[:, 2] > 0.0).all()
    assert (at[:, :2] >= 0.0).all()
    assert (at[:, :2] <= (600 * aspect, 600)).all()


@pytest.mark.parametrize("back", [(0.0, -3.0, 2.0), (4.0, 1.0, 0.5), (-1.0, 1.0, -0.2), (0.1, 0.0, 9.0)])
def test_a_view_of_some_points_keeps_its_direction_and_shows_them(back):
    points = np.array([(x, y, z) for x in (7.0, 9.0) for y in (-3.0, 2.0) for z in (0.0, 1.0)])
    eye, target = fit_view(points, 1.5, back)
    direction = np.subtract(eye, target)
    assert np.cross(direction, back) == pytest.approx(np.zeros(3), abs=1e-6)
    assert direction @ back > 0.0
    at = looking(eye, target, 900, 600).project(points)
    assert (at[:, 2] > 0.0).all()
    assert (at[:, :2] >= 0.0).all()
    assert (at[:, :2] <= (900, 600)).all()


def test_a_view_from_straight_above_has_x_to_the_right():
    eye, target = fit_view(np.array([(1.0, 2.0, 0.0), (5.0, 3.0, 0.0)]), 1.0, (0.0, 0.0, 1.0))
    assert target == (3.0, 2.5, 0.0)
    assert eye[:2] == target[:2]
    assert eye[2] == pytest.approx(1.06 * 2.0 / math.tan(FOV_RAD / 2.0))


def test_an_empty_map_has_an_initial_view():
    eye, target = first_view(extent(()), 1.5)
    assert eye[2] > target[2]


def test_distant_outliers_are_ignored():
    near = [entity(f"chair{i}", at=pose(i, 0.0)) for i in range(5)]
    points = extent([*near, entity("lost", at=pose(5000.0, 0.0))])
    assert points[:, 0].max() < 10.0
    assert extent([*near, entity("away", at=pose(60.0, 0.0))])[:, 0].max() < 10.0


@pytest.mark.parametrize(("target", "yaw_rad"), [((1, 0, 0), 0.0), ((0, 1, 0), 1.5708), ((-1, 0, 0), 3.1416)])
def test_the_viewpoint_has_the_heading_of_the_view(target, yaw_rad):
    x, y, z, yaw = looking((0.0, 0.0, 1.5), (*target[:2], 1.0)).viewpoint
    assert (x, y, z) == (0.0, 0.0, 1.5)
    assert math.remainder(yaw - yaw_rad, math.tau) == pytest.approx(0.0, abs=1e-3)


def test_the_heading_of_a_top_view_is_the_image_top():
    rotation = np.column_stack([(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)])
    yaw = View((0.0, 0.0, 5.0), wxyz_of(rotation), FOV_RAD, 800, 600).viewpoint[3]
    assert yaw == pytest.approx(math.pi / 2.0)


def test_labels_do_not_overlap_and_the_nearest_is_shown():
    view = looking((0.0, -5.0, 2.0), (0.0, 0.0, 0.0))
    places = {"far": (0.0, 0.1, 0.0), "near": (0.0, 0.0, 0.0), "aside": (1.5, 0.0, 0.0)}
    labels = {name: (name, at) for name, at in places.items()}
    assert select_labels(view, labels) == ["near", "aside"]
    assert select_labels(view, labels, ["far"])[0] == "far"
    assert "near" not in select_labels(view, labels, ["far"])


def test_labels_outside_the_image_or_above_the_limit_are_not_shown():
    view = looking((0.0, -5.0, 2.0), (0.0, 0.0, 0.0))
    assert select_labels(view, {"behind": ("b", (0.0, -9.0, 0.0)), "beside": ("c", (90.0, 0.0, 0.0))}) == []
    many = {str(i): (str(i), (0.5 * (i % 5) - 1.0, 0.6 * (i // 5) - 1.0, 0.0)) for i in range(20)}
    assert len(select_labels(view, many, most=3)) == 3
    assert select_labels(view, {}) == []


def test_label_selection_equals_the_greedy_algorithm():
    view, dice = looking((0.0, -8.0, 4.0), (0.0, 0.0, 0.0)), random.Random(7)
    for _ in range(20):
        places = [tuple(dice.uniform(-4.0, 4.0) for _ in range(3)) for _ in range(120)]
        labels = {f"k{i}": ("Name" * dice.randint(1, 4), at) for i, at in enumerate(places)}
        first = dice.sample(sorted(labels), 5)
        at = view.project(np.array(places))
        ahead = dict(zip(labels, at, strict=True))
        taken: list[tuple[float, float, float]] = []
        expected = []
        for key in sorted(labels, key=lambda key: (first.index(key) if key in first else 5, ahead[key][2])):
            x, y, z = ahead[key]
            half = sum(10.0 if letter.isupper() else 7.0 for letter in labels[key][0]) / 2.0 + 5.0
            is_seen = z > 0.05 and half <= x <= view.width - half and 0.0 <= y <= view.height
            has_room = all(abs(x - u) >= half + w or abs(y - v) >= 17.0 for u, v, w in taken)
            if is_seen and has_room and len(expected) < 40:
                taken.append((x, y, half))
                expected.append(key)
        assert select_labels(view, labels, first) == expected
