"""Training pairs for segmentation."""

from __future__ import annotations

import functools

import numpy as np

from semmap.nodes.perception_node.segmentation.pairs import NAMES
from semmap.nodes.training.segmentation.examples import example, joined, own_way, right_way
from semmap.nodes.training.segmentation.fit import fit
from tests.perception_node.segmentation.scenes import boxes_on_table
from tests.perception_node.segmentation.test_patches import SCENES


@functools.cache
def examples():
    return [example(*boxes_on_table(*boxes)) for boxes in SCENES.values()]


def test_the_right_way_ends_with_the_objects():
    for one in examples()[1:]:
        rows = right_way(one, np.random.default_rng(0))
        assert rows.features.shape == (len(rows.one), len(NAMES))
        assert rows.one.any()
        assert not rows.one.all()
        assert ((rows.weight > 0) & (rows.weight <= 1)).all()


def test_a_model_learns_it_and_its_own_way_is_met():
    rows = joined([right_way(one, np.random.default_rng(n)) for n in range(4) for one in examples()])
    trees = fit(rows, trees=20)
    assert ((trees.probability(rows.features) > 0.5) == rows.one).mean() > 0.95
    own = own_way(examples()[0], trees.probability)
    assert len(own.one) > 0


def test_scenes_without_pairs_have_no_rows():
    one = example(*boxes_on_table())
    assert len(one.overlap) == len(right_way(one, np.random.default_rng(0)).one) == 0
