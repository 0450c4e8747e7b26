import numpy as np
import pytest

from semmap.nodes.perception_node.image_features.photographs import is_photograph
from tests.perception_node.scenes import shot

RNG = np.random.default_rng(0)
RENDERED = shot().clouds[0].colors


def noisy(colours, sigma):
    return np.clip(colours + RNG.normal(0, sigma, colours.shape), 0, 255).astype(np.uint8)


def with_holes(colours):
    """Return colours that are black where the depth camera sees nothing."""
    return np.where(np.arange(colours.shape[1])[:, None] < 0.8 * colours.shape[1], np.uint8(0), colours)


@pytest.mark.parametrize(
    ("colours", "taken"),
    [
        (RENDERED, False),
        (noisy(RENDERED, 1.5), True),
        (with_holes(noisy(RENDERED, 1.5)), True),
        (with_holes(RENDERED), False),
        (np.zeros((4, 4, 3), np.uint8), False),
    ],
    ids=["rendered", "noise", "noise with holes", "rendered with holes", "black"],
)
def test_noise_tells_photographs_from_renderings(colours, taken):
    assert is_photograph(colours) is taken
