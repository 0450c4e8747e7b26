import numpy as np
import pytest

from nodes.perception_node.recognition.features import SORTS, features_of
from nodes.perception_node.views.merged_thing import thing_of
from nodes.perception_node.views.segments import Segment
from nodes.perception_node.views.supports import Support

TRIMMED = slice(22, None)
"""The columns of `geometry` that leave 3 % of the cells and more out at each end."""


def block(*corners_m):
    """A thing of points all through boxes (low, high), one for each 8 mm."""
    grids = [np.meshgrid(*(np.arange(a, b, 0.008) for a, b in zip(*of, strict=True))) for of in corners_m]
    points = np.concatenate([np.stack(grid, axis=-1).reshape(-1, 3) for grid in grids]).astype(np.float32)
    segment = Segment(
        points, np.full(points.shape, 90, np.uint8), 1, np.array([1.0, 0.0, 1.0]), False, len(points)
    )
    return thing_of([segment], [Support(0.0)])


ALONE = block(((0.0, 0.0, 0.0), (0.2, 0.1, 0.1)))
WITH_A_SCRAP = block(((0.0, 0.0, 0.0), (0.2, 0.1, 0.1)), ((0.2, 0.04, 0.04), (0.3, 0.05, 0.05)))


def test_one_row_a_thing_for_each_sort():
    features = features_of([ALONE, WITH_A_SCRAP])
    assert [len(of) for of in features] == [2] * len(SORTS)
    assert all(np.isfinite(of).all() for of in features)


def test_a_scrap_of_the_neighbour_hardly_changes_what_is_trimmed():
    alone, with_a_scrap = features_of([ALONE, WITH_A_SCRAP])[0]
    assert with_a_scrap[0] - alone[0] > 0.3
    assert with_a_scrap[TRIMMED] == pytest.approx(alone[TRIMMED], abs=0.05)
