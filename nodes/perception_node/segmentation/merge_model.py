"""The trained merge model and its file of arrays and a description, without code."""

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
    """Estimates how likely two patches are one object. `story` describes the training data."""

    trees: Trees
    story: str

    def __call__(self, known: Statistics, a: Indices, b: Indices) -> NDArray[np.float32]:
        """Return the probabilities (N,) of the pairs of patches (a, b)."""
        return self.trees.probability(features(known, a, b))


def save(learnt: MergeModel, path: Path) -> None:
    """Write the model as a compressed NumPy archive."""
    text = {"story": learnt.story, "bias": learnt.trees.bias, "features": NAMES}
    arrays = {name: getattr(learnt.trees, name) for name in _ARRAYS}
    np.savez_compressed(path, description=np.array(json.dumps(text)), **arrays)


def load(path: Path = SHIPPED) -> MergeModel:
    """Read a model that `save` wrote. Raises BadFile if it is invalid or uses other features."""
    try:
        with np.load(path, allow_pickle=False) as arrays:
            text = json.loads(str(arrays["description"]))
            if tuple(text["features"]) != NAMES:
                raise ValueError("it uses other features; run: make train-perception")
            trees = Trees(**{name: arrays[name] for name in _ARRAYS}, bias=float(text["bias"]))
            return MergeModel(trees, text["story"])
    except (OSError, EOFError, ValueError, KeyError) as error:
        raise BadFile(f"{path} is not a valid merge model: {error}") from None


@lru_cache(maxsize=1)
def shipped() -> MergeModel:
    """Return the model that ships with semmap."""
    return load()
