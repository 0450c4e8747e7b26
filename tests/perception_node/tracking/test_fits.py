"""The yaw of a fitted model."""

import math
from dataclasses import FrozenInstanceError

import pytest

from semmap.nodes.perception_node.tracking.fits import KnownFit
from semmap.schemas.entities import orientation_from_yaw
from tests.perception_node.things import at


@pytest.mark.parametrize(
    ("fold", "turn_deg", "turned"),
    [
        (1, 7.0, False),
        (1, 9.0, True),
        (1, -9.0, True),
        (1, 180.0, True),
        (2, 180.0, False),
        (2, 187.0, False),
        (2, 189.0, True),
        (2, 90.0, True),
        (4, 90.0, False),
        (4, 99.0, True),
        (0, 45.0, False),
    ],
)
def test_a_thing_is_turned_by_more_than_a_fit_is_off_by_and_not_where_it_looks_the_same(
    fold, turn_deg, turned
):
    fit = KnownFit("Cup", 0.9, orientation_from_yaw(0.5 + math.radians(turn_deg)), fold)
    assert fit.turned_from(at(1, 1, yaw=0.5)) is turned


def test_without_an_orientation_nothing_is_turned_and_what_was_told_stays():
    fit = KnownFit("Cup", 0.9, None, 1)
    assert not fit.turned_from(at(1, 1, yaw=2.0))
    with pytest.raises(FrozenInstanceError):
        fit.score = 1.0
