from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.recognition.features import SORTS, features_of
from semmap.nodes.perception_node.recognition.relief import RELIEF
from tests.perception_node.recognition.test_outlines import BOTTLE, solid, thing, turned

SIDE = 12


def pictures(*things):
    """Return for each thing the image from the front, (column, row from below), and that from above."""
    rows = features_of(things)[SORTS.index("relief")]
    return rows.reshape(len(things), 2, SIDE, SIDE)


def test_a_row_a_thing_whatever_is_beside_it():
    bottle, block = turned(BOTTLE), solid(0.1, 0.06, 0.05)
    together = pictures(bottle, block)
    assert together[0].size == RELIEF
    np.testing.assert_allclose(together[0], pictures(bottle)[0])
    np.testing.assert_allclose(together[1], pictures(block)[0])


@pytest.mark.parametrize("eye_m", [(2.0, 0.0, 1.0), (-0.6, 1.0, 1.0), (0.5, -1.5, 0.8)])
def test_a_bottle_stands_in_the_middle_of_its_picture_and_has_a_neck(eye_m):
    front, _ = pictures(turned(BOTTLE, eye_m=eye_m))[0]
    filled = front > 0.0
    body, neck = filled[:, 1:6].sum(axis=0), filled[:, 10:].sum(axis=0)
    assert (body >= 4).all()
    assert (neck <= 3).all()
    assert not filled[[0, -1]].any()


def test_what_is_nearer_to_the_camera_is_brighter():
    front, _ = pictures(turned(BOTTLE, eye_m=(2.0, 0.0, 0.3)))[0]
    columns = np.flatnonzero(front[:, 2] > 0.0)
    middle = front[columns[len(columns) // 2], 2]
    assert middle > front[columns[0], 2] + 0.05
    assert middle > front[columns[-1], 2] + 0.05


def test_it_is_the_nearest_camera_that_sees_the_front():
    seen = turned(BOTTLE, eye_m=(0.8, 0.0, 0.5))
    both = replace(seen, eyes=np.array([[0.0, 3.0, 1.0], [0.8, 0.0, 0.5]]))
    np.testing.assert_allclose(pictures(both)[0, 0], pictures(seen)[0, 0])


def test_a_cup_is_hollow_from_above():
    around = np.radians(np.arange(0.0, 360.0, 3.0))
    wall = [(0.04 * np.cos(a), 0.04 * np.sin(a), z) for a in around for z in np.arange(0.0, 0.09, 0.003)]
    floor = [(x, y, 0.004) for x in np.arange(-0.03, 0.03, 0.003) for y in np.arange(-0.03, 0.03, 0.003)]
    _, top = pictures(thing(wall + floor))[0]
    assert top[6, 6] < 0.5
    assert top.max() == pytest.approx(1.8, abs=0.05)


def test_a_handle_is_on_the_same_side_wherever_it_points():
    grid = np.stack(np.meshgrid(*(np.arange(0.0, end, 0.004) for end in (0.12, 0.08, 0.09))), axis=-1)
    x, y, z = cells = grid.reshape(-1, 3).T
    handle = (np.abs(y - 0.04) < 0.003) & (z > 0.029) & (z < 0.06)
    cup = cells.T[(x < 0.08) | handle]
    right, left = pictures(thing(cup, eye_m=(0.06, -2.0, 0.5)), thing(cup, eye_m=(0.06, 2.0, 0.5)))
    filled, other = right[0] > 0.0, left[0] > 0.0
    assert filled[:6].sum() > filled[6:].sum()
    assert (filled != other).sum() <= 14
