import numpy as np
import pytest

from semmap.nodes.training.scenes.placements import overlap, spread


@pytest.mark.parametrize(
    ("other", "gap", "meets"),
    [
        ((0.0, 0.0, 0.1, 0.1, 0.0), 0.0, True),
        ((0.2, 0.0, 0.1, 0.1, 0.0), 0.0, False),
        ((0.2, 0.0, 0.1, 0.1, 0.0), 0.12, True),
        ((0.15, 0.0, 0.1, 0.1, np.pi / 4), 0.0, False),
        ((0.115, 0.0, 0.1, 0.1, np.pi / 4), 0.0, True),
        ((0.115, 0.115, 0.1, 0.1, np.pi / 4), 0.0, False),
    ],
)
def test_rectangles_meet_or_not(other, gap, meets):
    assert overlap((0.0, 0.0, 0.1, 0.1, 0.0), other, gap) is meets


@pytest.mark.parametrize("crowded", [False, True])
def test_things_never_stand_in_one_another(crowded):
    for seed in range(8):
        taken = [p for p in _placements(seed, crowded=crowded) if p]
        assert len(taken) > 4
        assert not any(overlap(a, b, 0.0) for n, a in enumerate(taken) for b in taken[:n])


def test_what_is_pushed_together_touches():
    touching = [_touching([p for p in _placements(seed, crowded=True) if p]) for seed in range(8)]
    assert sum(touching) >= 3
    assert not any(_touching([s for s in _placements(seed, crowded=False) if s]) for seed in range(8))


def _placements(seed, *, crowded):
    sizes = [(0.1, 0.2, 0.1), (0.08, 0.08, 0.2), (0.3, 0.2, 0.2)] * 3
    rng = np.random.default_rng(seed)
    return spread(sizes, (1.0, 1.5), 0.03, rng, crowded=crowded)


def _touching(placements):
    """Whether each is within half a centimetre of another."""
    return all(any(overlap(a, b, 0.005) for b in placements if b is not a) for a in placements)
