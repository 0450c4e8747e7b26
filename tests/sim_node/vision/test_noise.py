import numpy as np
import pytest

from semmap.nodes.sim_node.vision.noise import kinect_noise


@pytest.mark.parametrize(("distance_m", "sigma_m"), [(1.0, 0.003), (2.0, 0.010), (4.0, 0.035)])
def test_noise_grows_with_the_square_of_the_distance(distance_m, sigma_m):
    depth = kinect_noise(np.full((200, 200), distance_m, np.float32), np.random.default_rng(0))
    seen = depth[depth > 0]
    assert seen.mean() == pytest.approx(distance_m, rel=0.005)
    assert seen.std() == pytest.approx(sigma_m, rel=0.5)
    assert 0.98 < (depth > 0).mean() < 1.0


def test_depth_comes_in_steps():
    depth = kinect_noise(np.full((100, 100), 3.0, np.float32), np.random.default_rng(0))
    assert len(np.unique(depth)) < 12


def test_too_near_too_far_and_shadowed_is_lost():
    depth = np.full((50, 60), 2.0, np.float32)
    depth[:, :10], depth[:, 50:], depth[:, 30:40] = 0.3, 8.0, 1.0
    noisy = kinect_noise(depth, np.random.default_rng(0))
    assert not noisy[:, :10].any()
    assert not noisy[:, 50:].any()
    assert not noisy[:, 27:30].any()
    assert (noisy[:, 12:26] > 0).mean() > 0.97
