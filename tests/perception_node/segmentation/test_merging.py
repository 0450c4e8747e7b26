"""Merging follows its judge."""

from __future__ import annotations

import numpy as np

from nodes.perception_node.segmentation.merging import merge
from tests.perception_node.segmentation.scenes import boxes_on_table
from tests.perception_node.segmentation.taken_apart import apart

BOXES = (((-0.1, -0.1, 0), (0, 0, 0.1)), ((0, -0.1, 0), (0.1, 0.02, 0.17)), ((0.2, 0, 0), (0.25, 0.05, 0.1)))


def test_a_judge_who_knows_the_truth_gives_the_objects():
    parts, owner = apart(boxes_on_table(*BOXES))
    judged = []

    def judge(known, a, b):
        judged.append(len(a))
        return (owner[a] == owner[b]).astype(np.float32)

    found = merge(parts.statistics.copy(), judge)
    assert set(found) == {1, 2, 3}
    for number in (1, 2, 3):
        assert len(set(owner[found == number])) == 1
    assert len(judged) > 1


def test_a_judge_who_refuses_leaves_the_patches():
    parts, owner = apart(boxes_on_table(*BOXES))
    found = merge(parts.statistics.copy(), lambda known, a, b: np.zeros(len(a), np.float32))
    assert sorted(found) == list(range(1, len(owner) + 1))


def test_no_patches():
    parts, _ = apart(boxes_on_table())
    assert merge(parts.statistics, lambda known, a, b: np.ones(len(a), np.float32)).shape == (0,)
