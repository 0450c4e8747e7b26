"""Initial poses of standing and lying models in the observed box."""

import math

import numpy as np
import pytest

from semmap.nodes.perception_node.fitting.initial_poses import (
    choice_distance,
    in_proportion,
    initial_poses,
    placed,
    size_mismatch,
    stretch,
)
from semmap.nodes.perception_node.fitting.model_surfaces import ModelSurface
from tests.perception_node.things import at

CORNERS = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0.0, 1.0)])


def model(size_m, fold=1):
    size = np.array(size_m, float)
    return ModelSurface(CORNERS * size, np.tile([0.0, 0.0, 1.0], (8, 1)), size, fold)


def found(size_m, seen_m, fold=1, yaw=0.0):
    return list(initial_poses(model(size_m, fold), at(1, 2, 0.5, yaw=yaw), seen_m))


def yaws(some):
    return [math.atan2(start.pose[1, 0], start.pose[0, 0]) for start in some]


def test_boxes_are_alike_whichever_way_they_are_turned():
    one, other = np.array([0.1, 0.2, 0.4]), np.array([0.2, 0.1, 0.4])
    assert size_mismatch(one, other) == pytest.approx(0.0)
    assert choice_distance(one, other) == pytest.approx(0.0)
    assert size_mismatch(one, np.array([0.1, 0.2, 0.8])) == pytest.approx(math.log(2) / 3)
    assert size_mismatch(2 * one, one) == pytest.approx(math.log(2))


def test_extents_are_off_by_their_squared_logarithms_and_once_more_by_proportions():
    one = np.array([0.1, 0.2, 0.4])
    assert choice_distance(2 * one, one) == pytest.approx(3 * math.log(2) ** 2)  # in proportion
    third = math.log(2) / 3
    expected = math.log(2) ** 2 + (2 * third) ** 2 + 2 * third**2
    assert choice_distance(one * (1, 1, 2), one) == pytest.approx(expected)


def test_in_proportion_a_model_is_as_large_and_as_high_as_what_was_seen():
    size = in_proportion(np.array([1.0, 2.0, 5.0]), np.array([0.4, 0.2, 0.3]))
    assert size == pytest.approx((0.2, 0.4, 0.3))


def test_what_is_placed_stands_at_the_position_turned_by_the_yaw():
    transform = placed(math.pi / 2, at(1, 2, 0.5))
    assert transform @ [1.0, 0.0, 0.0, 1.0] == pytest.approx((1.0, 3.0, 0.5, 1.0))
    assert transform @ [0.0, 1.0, 2.0, 1.0] == pytest.approx((0.0, 2.0, 2.5, 1.0))


@pytest.mark.parametrize(("fold", "turns"), [(0, 1), (4, 2), (2, 4), (1, 8)])
def test_a_model_starts_at_every_eighth_of_a_turn_that_looks_different(fold, turns):
    some = found((0.2, 0.3, 0.4), (0.2, 0.3, 0.4), fold)
    assert sorted({round(yaw % (2 * math.pi), 3) for yaw in yaws(some)}) == pytest.approx(
        [round(math.pi / 4 * n, 3) for n in range(turns)]
    )
    assert len(some) == turns + (turns + 1) // 2  # each in proportion, and the quarters as the box is
    assert not any(start.lying for start in some)


def test_turns_begin_at_the_yaw_that_was_seen():
    assert yaws(found((0.2, 0.3, 0.4), (0.2, 0.3, 0.4), 0, yaw=0.3)) == pytest.approx([0.3, 0.3])


def test_a_quarter_turned_model_fills_the_box_the_other_way():
    some = found((0.2, 0.3, 0.4), (0.22, 0.33, 0.44))
    swapped = {
        round(math.degrees(yaw))
        for yaw, start in zip(yaws(some), some, strict=True)
        if start.model.size_m[0] > start.model.size_m[1]
    }
    assert swapped == {90, -90}
    assert {tuple(np.round(sorted(start.model.size_m), 6)) for start in some} == {(0.22, 0.33, 0.44)}


def test_a_tall_thing_seen_flat_lies_and_one_that_was_seen_tall_does_not():
    lying = [start for start in found((0.08, 0.08, 0.3), (0.3, 0.08, 0.08)) if start.lying]
    assert lying
    for start in lying:
        assert abs(start.turn[2, 2]) < 1e-9
        assert sorted(start.laid_m) == pytest.approx([0.08, 0.08, 0.3])
        assert start.laid_m[2] == pytest.approx(0.08)
        assert np.linalg.det(start.turn) == pytest.approx(1.0)
    assert len({tuple(start.turn.ravel()) for start in lying}) == 4
    assert not any(start.lying for start in found((0.08, 0.08, 0.3), (0.08, 0.08, 0.3)))


def test_what_is_like_neither_stands():
    assert not any(start.lying for start in found((0.08, 0.08, 0.3), (0.5, 0.5, 0.5)))


def test_a_model_that_is_drawn_out_is_stretched_by_the_logarithm_of_that():
    some = found((0.2, 0.2, 0.4), (0.4, 0.2, 0.4), 0)
    assert sorted(stretch(start) for start in some) == pytest.approx([0.0, math.log(2)])
