"""Merging with a given judge."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.perception_node.segmentation import merging
from semmap.nodes.perception_node.segmentation.merging import merge
from tests.perception_node.segmentation.scenes import boxes_on_table
from tests.perception_node.segmentation.taken_apart import apart

BOXES = (((-0.1, -0.1, 0), (0, 0, 0.1)), ((0, -0.1, 0), (0.1, 0.02, 0.17)), ((0.2, 0, 0), (0.25, 0.05, 0.1)))


def test_a_judge_who_knows_the_truth_gives_the_objects():
    parts, owner = apart(boxes_on_table(*BOXES))
    judged = []

    def judge(known, a, b):
        judged.append(len(a))
        return (owner[a] == owner[b]).astype(np.float32)

    found = merge(parts.statistics.copy(), judge).number
    assert set(found) == {1, 2, 3}
    for number in (1, 2, 3):
        assert len(set(owner[found == number])) == 1
    assert len(judged) > 1


def test_a_judge_who_refuses_leaves_the_patches():
    parts, owner = apart(boxes_on_table(*BOXES))
    found = merge(parts.statistics.copy(), lambda known, a, b: np.zeros(len(a), np.float32)).number
    assert sorted(found) == list(range(1, len(owner) + 1))


def test_what_is_left_is_merged_too_when_a_merged_pair_has_no_other_neighbours():
    parts, _ = apart(boxes_on_table(*BOXES))
    first, second = (0, 1), (2, 3)  # that no other pair is near

    def judge(known, a, b):
        return np.array([{first: 0.8, second: 0.7}.get((x, y), 0.0) for x, y in zip(a, b, strict=True)])

    def two_pairs(known):
        may = np.zeros((len(known.inside),) * 2, bool)
        for a, b in (first, second):
            may[a, b] = may[b, a] = True
        return may

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(merging, "candidates", two_pairs)
        found = merge(parts.statistics, judge).number
    assert found[0] == found[1]
    assert found[2] == found[3]


def test_no_patches():
    parts, _ = apart(boxes_on_table())
    assert merge(parts.statistics, lambda known, a, b: np.ones(len(a), np.float32)).number.shape == (0,)
