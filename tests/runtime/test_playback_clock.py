"""Timing of a playback."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.runtime import playback_clock
from semmap.schemas import errors

S = 1_000_000_000


def test_waits_are_those_between_the_commits_divided_by_the_speed_and_none_is_too_long():
    stamps = [0, 1 * S, 1 * S, 5 * S, 3600 * S]
    assert [*playback_clock.waits_s(stamps)] == [1.0, 0.0, 3.0, 3.0]
    assert [*playback_clock.waits_s(stamps, speed=4.0, longest_s=10.0)] == [0.25, 0.0, 1.0, 10.0]


def test_there_is_no_wait_after_the_clock_was_set_back():
    assert [*playback_clock.waits_s([10 * S, 4 * S, 5 * S])] == [0.0, 1.0]


@given(st.lists(st.integers(0, 1 << 62), max_size=6), st.floats(1e-3, 1e6), st.floats(0.0, 60.0))
def test_there_is_a_wait_between_each_two_and_it_is_never_longer_than_allowed(stamps, speed, longest_s):
    waits = [*playback_clock.waits_s(stamps, speed=speed, longest_s=longest_s)]
    assert len(waits) == max(0, len(stamps) - 1)
    assert all(0.0 <= wait <= longest_s for wait in waits)


@pytest.mark.parametrize("speed", [0.0, -1.0, float("nan"), float("inf")])
def test_an_invalid_speed_is_rejected(speed):
    with pytest.raises(errors.BadRequest, match="speed must be greater than 0"):
        playback_clock.require_speed(speed)


def test_a_negative_longest_wait_is_rejected():
    assert playback_clock.require_longest(0.0) == 0.0
    with pytest.raises(errors.BadRequest, match="0 seconds or more, not -1"):
        playback_clock.require_longest(-1.0)


def test_commits_within_the_least_time_are_shown_together():
    stamps = [0, 1 * S, 1 * S + 1, 2 * S, 4 * S]
    assert playback_clock.next_position(stamps, 0) == (1, 1.0)
    assert playback_clock.next_position(stamps, 1, least_s=0.5) == (2, 0.5)
    assert playback_clock.next_position(stamps, 0, speed=10.0, least_s=0.25) == (3, 0.25)
    assert playback_clock.next_position(stamps, 3, longest_s=1.5) == (4, 1.5)
    assert playback_clock.next_position(stamps, 4) == (4, 0.0)


@given(st.lists(st.integers(0, 1 << 50), min_size=1, max_size=30), st.floats(0.01, 1e4), st.floats(0.0, 1.0))
def test_playback_always_reaches_the_end(stamps, speed, least_s):
    place = 0
    for _ in stamps:
        place, wait_s = playback_clock.next_position(sorted(stamps), place, speed=speed, least_s=least_s)
        assert wait_s >= least_s
    assert place == len(stamps) - 1
