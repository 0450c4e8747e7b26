"""Boosted trees that are fitted with scikit-learn and converted to plain arrays."""

from __future__ import annotations

from typing import Any

import numpy as np

from semmap.nodes.perception_node.segmentation.trees import LEAVES, Trees
from semmap.nodes.training.segmentation.examples import Rows

TREES = 150


def fit(rows: Rows, trees: int = TREES) -> Trees:
    """Train trees that classify whether pairs belong to one object."""
    from sklearn.ensemble import HistGradientBoostingClassifier  # takes longer to import than all else

    model = HistGradientBoostingClassifier(
        max_iter=trees,
        learning_rate=0.1,
        max_leaf_nodes=LEAVES,
        min_samples_leaf=20,
        l2_regularization=1.0,
        max_features=0.4,
        random_state=0,
    )
    model.fit(rows.features, rows.one, sample_weight=rows.weight)
    grown = [predictors[0].nodes for predictors in model._predictors]
    return trees_of(grown, float(model._baseline_prediction.item()))


def trees_of(grown: list[Any], bias: float) -> Trees:
    """From scikit-learn's arrays of nodes, one a tree."""
    feature: list[int] = []
    threshold: list[float] = []
    keeps: list[int] = []
    first: list[int] = []
    value = np.zeros((len(grown), LEAVES), np.float32)
    for tree, nodes in enumerate(grown):
        first.append(len(feature))
        leaves = 0

        def descend(node: int) -> int:
            """Number the leaves from the left; returns how many bits they have below this node."""
            nonlocal leaves
            at = nodes[node]  # noqa: B023
            if at["is_leaf"]:
                value[tree, leaves] = at["value"]  # noqa: B023
                leaves += 1
                return leaves
            mine, start = len(feature), leaves
            feature.append(at["feature_idx"])
            threshold.append(at["num_threshold"])
            keeps.append(0)
            end = descend(at["left"])
            keeps[mine] = 0xFFFF & ~((1 << end) - (1 << start))
            return descend(at["right"])

        descend(0)
        if len(feature) == first[-1]:  # a tree of one leaf asks nothing
            feature.append(0)
            threshold.append(np.inf)
            keeps.append(0xFFFF)
    return Trees(
        feature=np.array(feature, np.int32),
        threshold=np.nextafter(np.array(threshold), np.inf).astype(np.float32),
        keeps=np.array(keeps, np.uint16),
        first=np.array(first, np.int32),
        value=value,
        bias=bias,
    )
