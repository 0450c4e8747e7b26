"""Properties of clouds."""

from dataclasses import FrozenInstanceError

import numpy as np
import pytest

from semmap.nodes.perception_node.input.cloud import Cloud


def depths(values, rows=1):
    points = np.ones((rows, len(values) // rows, 3), np.float32)
    points[..., 2] = np.reshape(values, (rows, -1))
    return Cloud(points)


def test_a_cloud_of_several_rows_is_organised():
    assert depths([1.0, 2.0, 3.0, 4.0], rows=2).organised
    assert not depths([1.0, 2.0]).organised


def test_only_what_is_in_front_of_the_camera_was_measured():
    assert depths([1.0, np.nan, 0.0, -1.0, 2.0]).measured == 2


def test_near_is_what_a_twentieth_is_nearer_than():
    depth = np.linspace(1.0, 3.0, 16 * 101)
    assert depths(depth).near_m == pytest.approx(1.1, abs=0.01)
    assert depths(np.where(np.arange(len(depth)) % 32 == 0, np.nan, depth)).near_m == pytest.approx(
        1.1, abs=0.03
    )
    assert depths([np.nan] * 40).near_m == np.inf


def test_a_cloud_does_not_change():
    with pytest.raises(FrozenInstanceError):
        depths([1.0]).camera = "other"
