"""How well an image fits each class, and the file of what was learnt."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from semmap.nodes.perception_node.image_features.network import Outputs
from semmap.nodes.perception_node.recognition.perceptron import log_softmax
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.schemas.errors import BadFile

SHIPPED = Path(__file__).with_name("images.npz")

_FLOOR = 0.01
"""The least that an image says for a class, since most classes are not among those that it was trained on."""

_HALF = ("weights", "looks", "imagenet", "centre")
"""The arrays that are stored in half precision."""


@dataclass(frozen=True)
class ImageClassifier:
    """A linear classifier of looks, and the classes that have them.

    `leaves`: L classes of recognition. `weights`: (2 FEATURES, G) and `biases`: (G,) score the looks.
    `looks`: (G, L) and `imagenet`: (CLASSES, L), how far a thing with a look or of a class of ImageNet may be
    of each class, from 0 to 1. Classes of ImageNet without any of ours are not household things. `centre`:
    (FEATURES,) the mean features of images with grey surroundings, for comparisons of two of them.
    """

    leaves: tuple[str, ...]
    weights: Numbers
    biases: Numbers
    looks: Numbers
    imagenet: Numbers
    centre: Numbers
    story: str

    def __call__(self, whole: Outputs, alone: Outputs) -> Numbers:
        """Return (N, L) how well images of household things fit each leaf.

        The images `alone` show the same things with grey surroundings.
        """
        looks = np.exp(log_softmax(classifier_input(whole, alone) @ self.weights + self.biases))
        things = self.imagenet.any(axis=1)
        named = [np.exp(log_softmax(of.scores[:, things].astype(float))) for of in (whole, alone)]
        return np.asarray(looks @ self.looks + np.mean(named, axis=0) @ self.imagenet[things] + _FLOOR)

    def similarities(self, kept: Numbers, seen: Numbers) -> Numbers:
        """Return (V, N) cosines of stored features (V, FEATURES) and seen ones (N, FEATURES).

        They are relative to the mean of other things, and NaN where either are zeros.
        """
        return self._directions(kept) @ self._directions(seen).T

    def _directions(self, features: Numbers) -> Numbers:
        apart = np.where(features.any(axis=1, keepdims=True), features - self.centre, np.nan)
        return np.asarray(apart / np.linalg.norm(apart, axis=1, keepdims=True))

    @property
    def least(self) -> float:
        """Return how well an image fits a class that is not among the leaves."""
        return _FLOOR


def classifier_input(whole: Outputs, alone: Outputs) -> Numbers:
    """Return (N, 2 FEATURES) the features of both images, each of unit length."""
    return np.concatenate([unit_features(whole), unit_features(alone)], axis=1)


def unit_features(outputs: Outputs) -> Numbers:
    """Return (N, FEATURES) the features of images, each of unit length."""
    features = outputs.features.astype(float)
    return np.asarray(features / np.linalg.norm(features, axis=1, keepdims=True))


def save(learnt: ImageClassifier, path: Path) -> None:
    """Write the classifier as a compressed NumPy archive, with matrices in half precision."""
    arrays = {name: getattr(learnt, name).astype(np.float16) for name in _HALF}
    text = json.dumps({"story": learnt.story, "leaves": learnt.leaves})
    np.savez_compressed(path, description=np.array(text), biases=learnt.biases.astype(np.float32), **arrays)


def load(path: Path = SHIPPED) -> ImageClassifier:
    """Read a classifier that `save` wrote. Raises BadFile if it is invalid."""
    try:
        with np.load(path, allow_pickle=False) as arrays:
            text = json.loads(str(arrays["description"]))
            return ImageClassifier(
                leaves=tuple(text["leaves"]),
                story=text["story"],
                **{name: arrays[name].astype(float) for name in ("biases", *_HALF)},
            )
    except (OSError, EOFError, ValueError, KeyError) as error:
        raise BadFile(f"{path} is not a valid image classifier: {error}") from None


@lru_cache(maxsize=1)
def shipped() -> ImageClassifier:
    """Return the classifier that ships with semmap."""
    return load()
