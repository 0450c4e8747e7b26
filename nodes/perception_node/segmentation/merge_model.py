"""What training found, and its file: arrays and a description, no code."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.segmentation.pairs import NAMES, features
from semmap.nodes.perception_node.segmentation.statistics import Indices, Statistics
from semmap.nodes.perception_node.segmentation.trees import Trees
from semmap.schemas.errors import BadFile

SHIPPED = Path(__file__).with_name("segmentation.npz")

_ARRAYS = ("feature", "threshold", "keeps", "first", "value")


@dataclass(frozen=True)
class MergeModel:
    """Says how likely two patches are one object. `story`: what it was learnt from."""

    trees: Trees
    story: str

    def __call__(self, known: Statistics, a: Indices, b: Indices) -> NDArray[np.float32]:
        """(N,) of the pairs of patches (a, b)."""
        return self.trees.probability(features(known, a, b))


def save(learnt: MergeModel, path: Path) -> None:
    """Write it as a compressed NumPy archive."""
    text = {"story": learnt.story, "bias": learnt.trees.bias, "features": NAMES}
    arrays = {name: getattr(learnt.trees, name) for name in _ARRAYS}
    np.savez_compressed(path, description=np.array(json.dumps(text)), **arrays)


def load(path: Path = SHIPPED) -> MergeModel:
    """Read what `save` wrote. Raises BadFile for anything else, and for other features than today's."""
    try:
        with np.load(path, allow_pickle=False) as arrays:
            text = json.loads(str(arrays["description"]))
            if tuple(text["features"]) != NAMES:
                raise ValueError("it was learnt from other features; run make train-perception")
            trees = Trees(**{name: arrays[name] for name in _ARRAYS}, bias=float(text["bias"]))
            return MergeModel(trees, text["story"])
    except (OSError, EOFError, ValueError, KeyError) as error:
        raise BadFile(f"{path} does not hold what segmentation learnt: {error}") from None


@lru_cache(maxsize=1)
def shipped() -> MergeModel:
    """What ships with perception."""
    return load()
