"""Similarity of views: how likely a visible thing is one that was shown before.

A view is a row of features: geometry, shape and colour, see `features`. Outlines are not included, so that
exemplars of earlier versions remain valid.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Floats
from semmap.nodes.perception_node.segmentation.trees import Trees
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.schemas.errors import BadFile

SHIPPED = Path(__file__).with_name("likeness.npz")

GEOMETRY, SHAPE, COLOUR = slice(0, 35), slice(35, 95), slice(95, 129)
WIDTH = COLOUR.stop
"""The number of features of a view."""

_MEASURES = [*range(6), *range(19, 31)]
"""Logarithms of whole and trimmed extents, of which the sign of the difference matters."""
_HEIGHT = 2
_HOW_SEEN = slice(14, 19)
_FROM, _TO = COLOUR.start, COLOUR.stop
_HUES, _GREYS = slice(_FROM, _FROM + 12), slice(_FROM + 12, _FROM + 16)
_MEAN, _SPREAD = slice(_FROM + 16, _FROM + 19), slice(_FROM + 19, _FROM + 22)
_BANDS = slice(_FROM + 22, _TO)
_LEVELS, _DISTANCES = slice(35, 43), slice(85, 95)
_DARKEST = 0.05


_ARRAYS = ("feature", "threshold", "keeps", "first", "value")
_FAR = 1.1
"""Views whose log heights differ by more than this are not compared."""


@dataclass(frozen=True)
class Similarity:
    """Estimates how likely two views are of the same thing. `story` describes the training data."""

    trees: Trees
    story: str

    def __call__(self, kept: Numbers, seen: Numbers) -> Numbers:
        """Return (V, N) similarities of stored views (V, WIDTH) and seen ones (N, WIDTH)."""
        like = np.zeros((len(kept), len(seen)))
        rows, columns = np.nonzero(np.abs(kept[:, _HEIGHT, None] - seen[:, _HEIGHT]) < _FAR)
        if len(rows):
            like[rows, columns] = self.trees.probability(pair_features(kept[rows], seen[columns]))
        return like


def save(similarity: Similarity, path: Path) -> None:
    """Write the model as a compressed NumPy archive."""
    text = {"story": similarity.story, "bias": similarity.trees.bias, "width": WIDTH}
    arrays = {name: getattr(similarity.trees, name) for name in _ARRAYS}
    np.savez_compressed(path, description=np.array(json.dumps(text)), **arrays)


def load(path: Path = SHIPPED) -> Similarity:
    """Read a model that `save` wrote. Raises BadFile if it is invalid or uses other features."""
    try:
        with np.load(path, allow_pickle=False) as arrays:
            text = json.loads(str(arrays["description"]))
            if text["width"] != WIDTH:
                raise ValueError("it uses other features; run: make train-perception")
            trees = Trees(**{name: arrays[name] for name in _ARRAYS}, bias=float(text["bias"]))
            return Similarity(trees, text["story"])
    except (OSError, EOFError, ValueError, KeyError) as error:
        raise BadFile(f"{path} is not a valid similarity model: {error}") from None


@lru_cache(maxsize=1)
def shipped() -> Similarity:
    """Return the model that ships with semmap."""
    return load()


def views_of(features: Sequence[Numbers]) -> Numbers:
    """Return views (N, WIDTH) of things, given their features by sort."""
    return np.concatenate(features, axis=1)[:, :WIDTH]


def pair_features(kept: Numbers, seen: Numbers) -> Floats:
    """Return features (N, F) of pairs of views (N, WIDTH): their differences, and how each was seen."""
    difference = seen - kept
    apart = np.abs(difference)
    return np.column_stack(
        [
            apart,
            difference[:, _MEASURES],
            *(apart[:, part].sum(axis=1) for part in (_HUES, _GREYS, _BANDS, _LEVELS, _DISTANCES)),
            *(np.linalg.norm(difference[:, part], axis=1) for part in (_MEAN, _SPREAD)),
            np.abs(_tint(seen) - _tint(kept)),
            np.abs(_tint(seen) - _tint(kept)).sum(axis=1),
            kept[:, _HOW_SEEN],
            seen[:, _HOW_SEEN],
            np.maximum(kept[:, :3], seen[:, :3]),
            kept[:, _SPREAD].sum(axis=1),
            kept[:, _HUES].sum(axis=1),
        ]
    ).astype(np.float32)


def _tint(views: Numbers) -> NDArray[np.float64]:
    """Return (N, 3) the mean colours without brightness."""
    mean = views[:, _MEAN] + _DARKEST
    return np.asarray(mean / mean.sum(axis=1, keepdims=True))
