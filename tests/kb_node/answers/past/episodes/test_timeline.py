"""Intervals of the past of a map."""

import pytest

from semmap.nodes.kb_node.answers.past.episodes.timeline import join_spans


@pytest.mark.parametrize(
    ("spans", "joined"),
    [
        ([(5, 7), (1, 3)], [(1, 3), (5, 7)]),
        ([(1, 3), (3, 5)], [(1, 5)]),
        ([(1, 6), (2, 4)], [(1, 6)]),
        ([(1, 3), (2, None)], [(1, None)]),
        ([(1, None), (2, 4)], [(1, None)]),
        ([(1, None), (5, None)], [(1, None)]),
    ],
)
def test_intervals_that_meet_are_one(spans, joined):
    assert join_spans(spans) == joined
