"""Pairs of patches with ground truth, from scenes with known objects."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.segmentation.merging import merge
from semmap.nodes.perception_node.segmentation.pairs import NAMES, features
from semmap.nodes.perception_node.segmentation.segment import split_into_patches
from semmap.nodes.perception_node.segmentation.statistics import Indices, Statistics
from semmap.nodes.perception_node.segmentation.working_image import spread


@dataclass(frozen=True)
class Example:
    """A scene taken apart. `overlap`: (P, objects + 1) points of each patch on each object, 0 being none."""

    statistics: Statistics
    overlap: NDArray[np.float64]


class Rows(NamedTuple):
    """Pairs: features (N, F), whether they are one object (N,), and how pure both are (N,)."""

    features: NDArray[np.float32]
    one: NDArray[np.bool_]
    weight: NDArray[np.float64]


def example(cloud: Cloud, truth: NDArray[np.int32]) -> Example:
    """`truth`: (H, W) the number of the object of each point, 0 for background."""
    parts = split_into_patches(cloud)
    of_patch = spread(parts.grid, parts.of_patch)
    shape = (int(of_patch.max(initial=0)) + 1, int(truth.max(initial=0)) + 1)
    pairs = of_patch.ravel() * shape[1] + truth.ravel()
    overlap = np.bincount(pairs, minlength=shape[0] * shape[1]).reshape(shape)
    return Example(parts.statistics, overlap[1:].astype(np.float64))


def right_way(of: Example, rng: np.random.Generator) -> Rows:
    """Return the pairs encountered when only correct merges are made, in random order."""
    return _met(of, lambda _, one: np.where(one, rng.uniform(0.6, 1.0, len(one)), 0.0))


def own_way(of: Example, probability: Callable[[NDArray[np.float32]], NDArray[np.float32]]) -> Rows:
    """Return the pairs encountered when a model decides, including those after its errors."""
    return _met(of, lambda rows, _: probability(rows))


def _met(
    of: Example, decide: Callable[[NDArray[np.float32], NDArray[np.bool_]], NDArray[np.floating]]
) -> Rows:
    met: list[Rows] = []

    def judge(known: Statistics, a: Indices, b: Indices) -> NDArray[np.float32]:
        overlap = np.zeros_like(of.overlap)
        np.add.at(overlap, known.owner, of.overlap)
        share = overlap / np.maximum(overlap.sum(axis=1, keepdims=True), 1)
        best, purity = share.argmax(axis=1), share.max(axis=1)
        one = (best[a] == best[b]) & (best[a] > 0)
        rows = features(known, a, b)
        told = (best[a] > 0) | (best[b] > 0)  # what parts of the table are to one another is not asked
        met.append(Rows(rows, one, purity[a] * purity[b] * told))
        return decide(rows, one).astype(np.float32)

    merge(of.statistics.copy(), judge)
    return joined(met)


NO_ROWS = Rows(np.zeros((0, len(NAMES)), np.float32), np.zeros(0, np.bool_), np.zeros(0))


def joined(parts: Iterable[Rows]) -> Rows:
    """Join the rows of all parts."""
    columns = zip(NO_ROWS, *parts, strict=True)
    return Rows._make(np.concatenate(column) for column in columns)
