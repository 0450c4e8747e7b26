"""A carton that seems to float above the floor, and the points around its foot."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.views.foot_supports import supports_at_feet
from semmap.nodes.perception_node.views.furniture_planes import EVERY
from semmap.nodes.perception_node.views.merged_thing import thing_of
from semmap.nodes.perception_node.views.segmented_view import SegmentedView
from semmap.nodes.perception_node.views.segments import Segment
from semmap.nodes.perception_node.views.supports import Support

TOP_M = 0.9
FLOOR = Support(0.0)
STEP_M = 0.01


def patch(height_m, *, slope=0.0, half_m=0.3, beyond=lambda x, y: True):
    """Return points (h, w, 3) around the map's z axis, NaN for no measurement."""
    side = np.arange(-half_m, half_m, STEP_M)
    x, y = np.meshgrid(side, side)
    points = np.dstack([x, y, height_m + slope * x])
    points[~(np.vectorize(beyond)(x, y))] = np.nan
    return points.astype(np.float32)


def carton(low_m=TOP_M, side_m=0.08, *, carrier=False):
    x, y, z = np.meshgrid(*[np.linspace(-side_m / 2, side_m / 2, 9)] * 2, np.linspace(low_m, low_m + 0.2, 20))
    points = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1).astype(np.float32)
    return Segment(points, None, 1, np.array([0.0, -1.0, 1.5]), False, len(points), carrier)


def sight(points):
    """Return a view of points by a camera along the map's axes, repeated `EVERY` times."""
    full = points.repeat(EVERY, axis=0).repeat(EVERY, axis=1)
    cloud = Cloud(full, None, camera="head", stamp_ns=1)
    nothing = np.zeros(full.shape[:2], np.int32)
    return SegmentedView(cloud, np.eye(4), nothing, frozenset(), nothing, (), np.zeros((0, 0), np.float32))


def found(points, segment=None, supports=(FLOOR,)):
    segment = segment or carton()
    return supports_at_feet([sight(points)], [thing_of([segment], supports)])


def test_a_level_ring_around_its_foot_bears_a_thing():
    (support,) = found(patch(TOP_M))
    assert support.height_m == pytest.approx(TOP_M, abs=0.005)
    assert thing_of([carton()], [FLOOR]).box.low[2] == pytest.approx(0.0)
    assert thing_of([carton()], [FLOOR, support]).box.low[2] == pytest.approx(TOP_M, abs=0.005)


def test_half_a_ring_is_enough_as_a_camera_does_not_see_behind_a_thing():
    assert len(found(patch(TOP_M, beyond=lambda x, y: y < 0.02))) == 1
    assert found(patch(TOP_M, beyond=lambda x, y: y < 0.0 and x > 0.02)) == []


def test_what_is_not_level_or_not_at_its_foot_bears_nothing():
    assert found(patch(TOP_M, slope=1.0)) == []
    assert found(patch(TOP_M - 0.1)) == []
    assert found(patch(TOP_M + 0.1)) == []


def test_without_a_moving_camera_nothing_is_asked():
    assert supports_at_feet([], [thing_of([carton()], [FLOOR])]) == []


def test_what_stands_already_or_is_large_or_a_top_is_not_asked_about():
    assert found(patch(TOP_M), supports=(FLOOR, Support(TOP_M))) == []
    assert found(patch(TOP_M, half_m=0.6), carton(side_m=0.8)) == []
    assert found(patch(TOP_M), carton(carrier=True)) == []
