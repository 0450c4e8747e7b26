import numpy as np
import pytest

from semmap.nodes.training.scenes.paint import Paint, any_paint, painted, printed_on

POINTS = np.random.default_rng(0).uniform(-1.0, 1.0, (500, 3)).astype(np.float32)
SHADED = (np.linspace(60, 180, 500)[:, None] * [1.0, 0.2, 0.2]).astype(np.uint8)


def test_own_colours_stay_but_for_their_brightness():
    assert painted(SHADED, POINTS, Paint(None)).tolist() == SHADED.tolist()
    assert painted(SHADED, POINTS, Paint(None, 0.5)).mean() == pytest.approx(SHADED.mean() / 2, abs=1.0)


def test_paint_keeps_light_and_shade_and_nothing_of_the_old_hue():
    grey = painted(SHADED, POINTS, Paint(lambda points: np.full(points.shape, 0.5, np.float32)))
    assert (np.ptp(grey, axis=1) == 0).all()
    assert (np.diff(grey[:, 0].astype(int)) >= 0).all()
    assert grey[:100].mean() < 0.8 * grey[-100:].mean()


def test_all_cameras_see_the_same_paint():
    for seed in range(40):
        paint = any_paint(np.random.default_rng(seed), 0.3)
        if paint.pattern is not None:
            order = np.random.default_rng(seed).permutation(500)
            np.testing.assert_array_equal(paint.pattern(POINTS[order]), paint.pattern(POINTS)[order])


def test_paints_are_of_every_sort():
    rng = np.random.default_rng(1)
    found = [painted(SHADED, POINTS, any_paint(rng, 0.3)) for _ in range(200)]
    brightness = np.array([one.mean() for one in found])
    assert (brightness < 50).sum() > 5
    assert (brightness > 150).sum() > 5
    assert sum(len(np.unique(one // 64, axis=0)) > 3 for one in found) > 30


def test_so_many_keep_their_own_colours():
    rng = np.random.default_rng(2)
    texture = printed_on(POINTS, POINTS)
    kept = [any_paint(rng, 0.3, texture) for _ in range(1000)]
    assert 250 < sum(paint.pattern is texture for paint in kept) < 350
    assert all(paint.pattern is texture for paint in (any_paint(rng, 1.0, texture) for _ in range(20)))
    assert all(paint.pattern is not None for paint in (any_paint(rng, 0.0) for _ in range(20)))


def test_a_texture_gives_each_point_the_colour_of_the_vertex_next_to_it():
    red_below, blue_above = (
        np.array([[0.0, 0.0, -0.5], [0.0, 0.0, 0.5]]),
        np.array([[1.0, 0, 0], [0, 0, 1.0]]),
    )
    pattern = printed_on(red_below.astype(np.float32), blue_above.astype(np.float32))
    assert (pattern(POINTS) == np.where(POINTS[:, 2:] > 0.0, [0, 0, 1.0], [1.0, 0, 0])).all()
    grey = np.full((500, 3), 120, np.uint8)
    half = painted(grey, POINTS, Paint(pattern, 0.5)).max(axis=1)
    assert set(half.tolist()) == {127}
