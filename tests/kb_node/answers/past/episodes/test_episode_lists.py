"""Lists of events and intervals."""

import pytest

from semmap.nodes.kb_node.answers.past.episodes.episode_lists import (
    clip,
    find_common,
    find_overlaps,
    touches,
)
from semmap.schemas.episodes import Episode


def episode(since, until=None, what="on"):
    return Episode(
        subject="cup1",
        what=what,
        since=since,
        since_ns=since * 10,
        until=until,
        until_ns=None if until is None else until * 10,
    )


@pytest.mark.parametrize(
    ("first_ns", "last_ns", "kept"),
    [(0, 99, "abc"), (0, 9, ""), (0, 10, "a"), (20, 49, "b"), (19, 49, "ab"), (40, 50, "c")],
)
def test_episodes_of_a_period(first_ns, last_ns, kept):
    all_ = [episode(1, 2, "a"), episode(2, 4, "b"), episode(5, what="c")]
    assert "".join(e.what for e in clip(all_, first_ns, last_ns)) == kept


def test_events_at_the_same_time():
    one, other = [episode(1), episode(3)], [episode(2), episode(3, what="in")]
    assert find_common(None, other) == other
    assert find_common(one, other) == [episode(3, what="in")]


@pytest.mark.parametrize(
    ("span", "moves"),
    [(episode(2, 4), [2, 3, 4]), (episode(3), [3, 4, 5])],
)
def test_moves_that_touch_an_interval(span, moves):
    assert [since for since in range(1, 6) if touches(span, episode(since))] == moves


@pytest.mark.parametrize(
    ("other", "common"),
    [
        ((1, 3), (2, 3)),
        ((3, 4), (3, 4)),
        ((4, 9), (4, 5)),
        ((1, None), (2, 5)),
        ((3, None), (3, 5)),
        ((5, 9), None),
        ((1, 2), None),
    ],
)
def test_the_common_part_of_two_intervals(other, common):
    found = find_overlaps([episode(2, 5)], [episode(*other, what="near")])
    assert found == ([] if common is None else [episode(*common, what="on near")])
    assert find_overlaps([episode(2)], [episode(3)]) == [episode(3, what="on on")]
