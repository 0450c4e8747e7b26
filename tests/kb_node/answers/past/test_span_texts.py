"""Intervals in words."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.answers.past.span_texts import describe_spells, lasted_s
from semmap.schemas.map_history import Spell

S = 1_000_000_000


def spell(since, since_s, until=None, until_s=None):
    return Spell(
        since=since, since_ns=since_s * S, until=until, until_ns=None if until_s is None else until_s * S
    )


@pytest.mark.parametrize(
    ("spells", "text"),
    [
        ([], "cup1 was never on table1"),
        ([spell(4, 80)], "cup1 has been on table1 since commit 4 (for 20 s)"),
        (
            [spell(0, 70)],
            "cup1 has been on table1 since before the history begins (for at least 30 s)",
        ),
        (
            [spell(1, 10, 3, 30)],
            "cup1 is no longer on table1; it was from commit 1 until commit 3 (for 20 s, until 70 s ago)",
        ),
        (
            [spell(0, 10, 3, 30), spell(5, 60)],
            "cup1 has been on table1 since commit 5 (for 40 s); before that from before the history begins"
            " until commit 3 (for at least 20 s, until 70 s ago); 2 times, 60 s in all",
        ),
        (
            [spell(1, 10, 2, 20), spell(3, 30, 4, 40)],
            "cup1 is no longer on table1; it was from commit 1 until commit 2 (for 10 s, until 80 s ago),"
            " from commit 3 until commit 4 (for 10 s, until 60 s ago); 2 times, 20 s in all",
        ),
    ],
)
def test_the_text_has_the_present_first_then_the_earlier_intervals_and_their_sum(spells, text):
    assert describe_spells("cup1", "on table1", spells, 100 * S) == text


def many(count):
    return [spell(2 * n + 1, 2 * n, 2 * n + 2, 2 * n + 1) for n in range(count)]


def test_ten_intervals_are_listed_and_of_eleven_the_first_and_last_three():
    ten = describe_spells("cup1", "on table1", many(10), 100 * S)
    assert ten.count("from commit") == 10
    assert "more times" not in ten
    eleven = describe_spells("cup1", "on table1", many(11), 100 * S)
    assert eleven.count("from commit") == 6
    assert "from commit 5 until commit 6 (for 1 s, until 95 s ago), 5 more times, from commit 17" in eleven
    assert eleven.endswith("; 11 times, 11 s in all")


def test_an_open_interval_lasts_until_now():
    assert lasted_s(spell(1, 10), 25 * S) == 15.0
    assert lasted_s(spell(1, 10, 2, 12), 25 * S) == 2.0
