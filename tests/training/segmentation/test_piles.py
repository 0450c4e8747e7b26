"""Made-up scenes."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.sim_node.vision.camera import Eye
from semmap.nodes.training.segmentation.piles import pile


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
