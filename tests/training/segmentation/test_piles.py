"""Made-up scenes."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.sim_node.vision.camera import Eye
from semmap.nodes.training.segmentation.piles import pile, shadowed


@pytest.fixture(scope="module")
def eye():
    return Eye(graphics=False)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_pile_is_things_on_a_table(eye, seed):
    cloud, truth = pile(np.random.default_rng(seed), eye)
    assert cloud.points_camera.shape == (480, 640, 3)
    assert truth.shape == (480, 640)
    assert truth.max() >= 1
    assert not truth[np.isnan(cloud.points_camera[..., 2])].any()
    assert (truth == 0).mean() > 0.2


def test_a_shadow_falls_to_the_left_and_is_as_wide_as_the_disparities_differ():
    depth_m = np.full((10, 400), 1.5, np.float32)
    depth_m[:, 200:260] = 0.75
    dark = shadowed(depth_m)
    width = 525 * 0.075 * (1 / 0.75 - 1 / 1.5)
    assert dark.any(axis=0).nonzero()[0].max() == 199
    assert dark.sum(axis=1) == pytest.approx(width, abs=2)


def test_no_shadow_on_a_slope_nor_where_nothing_is_seen():
    depth_m = np.linspace(0.8, 2.0, 640, dtype=np.float32)[None, :].repeat(4, axis=0)
    assert not shadowed(depth_m).any()
    assert not shadowed(np.zeros((4, 640), np.float32)).any()
