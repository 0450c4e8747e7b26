from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.recognition.features import SORTS, features_of
from semmap.nodes.perception_node.recognition.outlines import WIDTH
from semmap.nodes.perception_node.views.merged_thing import thing_of
from semmap.nodes.perception_node.views.segments import Segment
from semmap.nodes.perception_node.views.supports import Support

WIDE, HIGH, LONG = slice(0, 20), slice(20, 30), slice(30, 40)
OFF_A_CIRCLE, ITS_SIZE, THICK = slice(40, 44), slice(44, 48), slice(48, 52)


def thing(points, *, eye_m=(2.0, 0.0, 1.0)):
    points = np.asarray(points, np.float32)
    grey = np.full(points.shape, 90, np.uint8)
    return thing_of([Segment(points, grey, 1, np.array(eye_m), False, len(points))], [Support(0.0)])


def turned(profile, *, eye_m=(2.0, 0.0, 1.0), half=True):
    """Return the visible side of a solid of revolution, `profile` (radius, height) [m]."""
    heights = np.arange(0.001, profile[-1][1], 0.003)
    radii = np.interp(heights, [z for _, z in profile], [r for r, _ in profile])
    facing = np.arctan2(eye_m[1], eye_m[0])
    angles = facing + np.radians(np.arange(-90.0, 91.0, 3.0) if half else np.arange(0.0, 360.0, 3.0))
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    rings = [
        np.column_stack([r * around, np.full(len(around), z)]) for r, z in zip(radii, heights, strict=True)
    ]
    return thing(np.concatenate(rings), eye_m=eye_m)


def solid(x, y, z, *, at=(0.0, 0.0)):
    axes = (np.arange(0.0, extent, 0.004) for extent in (x, y, z))
    return thing(np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3) + np.array([*at, 0.0]))


def outline(*things):
    return features_of(things)[SORTS.index("outline")]


BOTTLE = [(0.035, 0.0), (0.035, 0.12), (0.012, 0.16), (0.012, 0.20)]


def test_a_row_a_thing_whatever_is_beside_it():
    bottle, block = turned(BOTTLE), solid(0.1, 0.06, 0.05)
    together = outline(bottle, block)
    assert together.shape == (2, WIDTH)
    assert np.isfinite(together).all()
    np.testing.assert_allclose(together[0], outline(bottle)[0])
    np.testing.assert_allclose(together[1], outline(block)[0])


def test_a_bottle_has_shoulders_from_whichever_side_it_is_seen():
    for eye_m in ((2.0, 0.0, 1.0), (-0.6, 1.0, 1.0), (0.5, -1.5, 0.8)):
        wide = outline(turned(BOTTLE, eye_m=eye_m))[0, WIDE]
        assert wide[:11] == pytest.approx(1.0, abs=0.1)
        assert wide[17:] == pytest.approx(0.34, abs=0.08)


def test_of_two_eyes_the_one_that_sees_a_slice_widest_counts():
    stepped = np.concatenate([solid(0.2, 0.05, 0.06).cells, solid(0.1, 0.05, 0.12).cells])
    seen = thing(stepped)
    of_eyes = {
        name: outline(replace(seen, eyes=np.array(eyes)))[0, WIDE]
        for name, eyes in {
            "end": [(5.0, 0.025, 1.0)],
            "side": [(0.1, 5.0, 1.0)],
            "both": [(5.0, 0.025, 1.0), (0.1, 5.0, 1.0)],
        }.items()
    }
    assert of_eyes["end"] == pytest.approx(1.0, abs=0.05)
    assert of_eyes["side"][-5:] == pytest.approx(0.5, abs=0.05)
    np.testing.assert_allclose(of_eyes["both"], of_eyes["side"])


def test_what_is_round_lies_on_a_circle_and_a_block_does_not():
    can = outline(turned([(0.04, 0.0), (0.04, 0.12)]))[0]
    block = outline(solid(0.08, 0.08, 0.12))[0]
    assert can[OFF_A_CIRCLE].max() < 0.08
    assert can[ITS_SIZE] == pytest.approx(1.0, abs=0.1)
    assert block[OFF_A_CIRCLE].min() > 0.2


def test_a_long_thing_is_the_same_from_either_end():
    handle, head = ((0.0, 0.2), (0.03, 0.05), 0.02), ((0.2, 0.26), (0.0, 0.08), 0.04)

    def grid(x, y, z):
        axes = np.arange(*x, 0.004), np.arange(*y, 0.004), np.arange(0.0, z, 0.004)
        return np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3)

    hammer = np.concatenate([grid(*handle), grid(*head)])
    one = outline(thing(hammer))[0]
    other = outline(thing(hammer * [-1.0, 1.0, 1.0]))[0]
    assert one[HIGH] == pytest.approx(other[HIGH], abs=0.12)
    assert one[LONG] == pytest.approx(other[LONG], abs=0.12)
    assert one[HIGH][0] > one[HIGH][-1] + 0.3
    assert one[LONG][0] > one[LONG][-1] + 0.3


def test_few_cells_tell_of_no_circle():
    scrap = thing([(0.0, 0.0, 0.01 * n) for n in range(8)])
    told = outline(scrap)[0]
    assert np.isfinite(told).all()
    assert (told[ITS_SIZE] == 0.0).all()
    assert (told[THICK] == 0.0).all()
