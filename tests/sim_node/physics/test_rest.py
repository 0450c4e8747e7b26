"""Rest detection of bodies and joints."""

import numpy as np
import pytest

from semmap.nodes.sim_node.models.parts import about
from semmap.nodes.sim_node.physics.rest import (
    ASLEEP_S,
    STILL_M,
    STILL_RAD,
    STILL_S,
    JointRestDetector,
    RestDetector,
)


def at(*places, turn_rad=0.0):
    return np.array([[*place, *about("z", turn_rad)] for place in places])


HERE = at((1.0, 2.0, 3.0))
AWAKE, ASLEEP = np.array([False]), np.array([True])


@pytest.mark.parametrize(("asleep", "after_s"), [(AWAKE, STILL_S), (ASLEEP, ASLEEP_S)])
def test_a_body_that_stays_rests_after_a_while_and_sooner_if_it_sleeps(asleep, after_s):
    watch = RestDetector(HERE, 10.0)
    assert not watch.update(HERE, 10.0 + after_s - 0.01, asleep)[0]
    assert watch.update(HERE, 10.0 + after_s + 1e-9, asleep)[0]


@pytest.mark.parametrize(
    ("now", "rests"),
    [
        (at((1.0 + 0.9 * STILL_M, 2.0, 3.0)), True),
        (at((1.0 + 1.1 * STILL_M, 2.0, 3.0)), False),
        (at((1.0, 2.0, 3.0 - 1.1 * STILL_M)), False),
        (at((1.0, 2.0, 3.0), turn_rad=0.9 * STILL_RAD), True),
        (at((1.0, 2.0, 3.0), turn_rad=1.1 * STILL_RAD), False),
        (-HERE * [-1, -1, -1, 1, 1, 1, 1], True),
    ],
    ids=["a hair", "a step", "down", "a hair's turn", "a turn", "the other quaternion of the same turn"],
)
def test_what_moves_or_turns_farther_than_the_tolerance_does_not_rest(now, rests):
    watch = RestDetector(HERE, 0.0)
    assert watch.update(now, 1.0, AWAKE).tolist() == [rests]


def test_small_steps_add_up():
    watch = RestDetector(HERE, 0.0)
    now = HERE.copy()
    for step in range(1, 11):
        now[0, 0] += 0.6 * STILL_M
        assert not watch.update(now, 0.1 * step, AWAKE)[0]
    assert not watch.update(now, 1.0 + STILL_S - 0.05, AWAKE)[0]
    assert watch.update(now, 1.0 + STILL_S + 0.01, AWAKE)[0]


def test_what_is_taken_in_hand_has_to_be_still_once_more_and_only_that():
    watch = RestDetector(at((0, 0, 0), (1, 0, 0)), 0.0)
    watch.disturb([1], 5.0)
    both = np.array([False, False])
    assert watch.update(at((0, 0, 0), (1, 0, 0)), 5.1, both).tolist() == [True, False]


def test_who_was_watched_before_stays_so_in_another_order_and_newcomers_begin():
    watch = RestDetector(at((0, 0, 0), (1, 0, 0)), 0.0)
    there = at((5, 0, 0), (1, 0, 0))
    carried = watch.carried_over(there, 5.0, np.array([-1, 1]))
    assert carried.update(there, 5.1, np.array([False, False])).tolist() == [False, True]
    moved = watch.carried_over(at((7, 0, 0)), 5.0, np.array([0]))  # it is compared with where it was
    assert not moved.update(at((7, 0, 0)), 5.1, AWAKE)[0]


def test_a_joint_rests_when_it_has_been_still():
    joints = JointRestDetector(np.array([0.5, 1.0]), 0.0)
    assert joints.update(np.array([0.5, 1.0]), ASLEEP_S - 0.01).tolist() == [False, False]
    now = np.array([0.5 + 0.9 * STILL_M, 1.0 - 1.1 * STILL_M])
    assert joints.update(now, ASLEEP_S + 0.01).tolist() == [True, False]
    assert joints.update(now, 2 * ASLEEP_S + 0.02).tolist() == [True, True]
    joints.disturb([0], 1.0)
    assert joints.update(now, 1.05).tolist() == [False, True]


def test_a_joint_that_has_arrived_rests_at_once_unless_it_moves_on():
    joints = JointRestDetector(np.array([0.0, 0.0]), 0.0)
    there = np.array([1.0, 1.0])
    joints.arrive([0, 1], there, 2.0)
    assert joints.update(np.array([1.0, 1.1]), 2.0 + 1e-9).tolist() == [True, False]
