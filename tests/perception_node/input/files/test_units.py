"""Detection of the unit of depth."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.perception_node.input.files.units import doubt

ROOM_M = np.linspace(0.7, 3.5, 200)


@pytest.mark.parametrize("scale_m", [1.0, 0.001, 0.0001])
def test_a_room_in_the_unit_that_was_said_is_not_doubted(scale_m):
    assert doubt(ROOM_M / scale_m, scale_m) is None
    assert doubt(np.zeros(9), scale_m) is None


@pytest.mark.parametrize(
    ("really", "said"), [(0.001, 1.0), (0.01, 1.0), (0.0001, 1.0), (0.0001, 0.001), (1.0, 0.001)]
)
def test_a_room_in_another_unit_is_doubted_and_the_unit_named(really, said):
    told = doubt(ROOM_M / really, said)
    assert told is not None
    assert told.scale_m == really


def test_far_walls_behind_something_near_are_not_doubted():
    assert doubt(np.concatenate([ROOM_M, np.full(1000, 60.0)]), 1.0) is None
