"""A television on a cabinet whose top is not visible as a plane."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.perception_node.views.merged_thing import thing_of
from semmap.nodes.perception_node.views.object_supports import supports_of_things
from semmap.nodes.perception_node.views.segments import Segment
from semmap.nodes.perception_node.views.supports import Support

FLOOR = Support(0.0)
CABINET_M = (1.4, 0.4, 0.5)


def block(size_m, low_m=0.0, *, at=(0.0, 0.0), carrier=False):
    """Return the visible front and top of a box."""
    x, y, z = (np.arange(0.0, extent + 1e-9, 0.02) for extent in size_m)
    front = np.stack(np.meshgrid(x, [0.0], z), axis=-1).reshape(-1, 3)
    top = np.stack(np.meshgrid(x, y, [size_m[2]]), axis=-1).reshape(-1, 3)
    corner = np.array([at[0] - size_m[0] / 2, at[1] - size_m[1] / 2, low_m])
    points = np.concatenate([front, top]) + corner
    eye = np.array([0.0, -2.0, 1.3])
    segment = Segment(points.astype(np.float32), None, 1, eye, False, len(points), carrier)
    return thing_of([segment], [FLOOR])


def television(at=(0.0, 0.0), low_m=0.5, **of):
    return block((1.0, 0.1, 0.65), low_m, at=at, **of)


def test_a_thing_stands_on_the_top_of_one_that_is_below_it():
    screen = television()
    assert screen.box.low[2] == pytest.approx(0.0)
    (support,) = supports_of_things([screen, block(CABINET_M)])
    assert support.height_m == pytest.approx(0.5, abs=0.02)
    assert thing_of(screen.segments, [FLOOR, support]).box.low[2] == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize(
    ("screen", "other"),
    [
        pytest.param(television(at=(1.3, 0.0)), block(CABINET_M), id="beside it"),
        pytest.param(television(low_m=0.9), block(CABINET_M), id="far below"),
        pytest.param(television(), block((1.4, 0.4, 1.2)), id="higher than its foot"),
        pytest.param(television(), block((0.3, 0.4, 0.5)), id="below a small part of it"),
        pytest.param(television(low_m=0.05), block((1.4, 0.4, 0.05)), id="it stands already"),
        pytest.param(television(carrier=True), block(CABINET_M), id="a top itself"),
    ],
)
def test_on_nothing_else(screen, other):
    assert supports_of_things([screen, other]) == []


def test_a_thing_does_not_stand_on_itself():
    assert supports_of_things([television()]) == []
