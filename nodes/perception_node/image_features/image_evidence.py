"""What the images of things say about their classes."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from semmap.nodes.perception_node.image_features.crops import Bytes, LabelledImage, crops_of
from semmap.nodes.perception_node.image_features.efficientnet import FEATURES
from semmap.nodes.perception_node.image_features.image_classifier import (
    ImageClassifier,
    shipped,
    unit_features,
)
from semmap.nodes.perception_node.image_features.network import Outputs, available, load_network
from semmap.nodes.perception_node.recognition.recognition_model import RecognitionModel
from semmap.nodes.perception_node.views.boxes import Numbers

_KEPT = 256
_THUMBNAIL = 8
_SAME = 4.0
"""Images whose thumbnails differ by less on average (of 255) show the same."""

Network = Callable[[Sequence[Bytes]], Outputs]


class ImageResult(NamedTuple):
    """What the network finds in the images of a thing.

    `fits`: (L,) how well they fit each leaf of the classifier. `features`: (FEATURES,) of unit length, of the
    image with grey surroundings.
    """

    fits: Numbers
    features: Numbers


class ImageMemory:
    """The results of the last images, so that a thing that rests costs the network nothing. Thread-safe."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._known: deque[tuple[Numbers, ImageResult]] = deque(maxlen=_KEPT)

    def find(self, thumbnail: Numbers) -> ImageResult | None:
        """Return the result for an image that looks like this one, or None."""
        with self._lock:
            if not self._known:
                return None
            apart = [float(np.abs(known - thumbnail).mean()) for known, _ in self._known]
            nearest = int(np.argmin(apart))
            return self._known[nearest][1] if apart[nearest] < _SAME else None

    def keep(self, thumbnail: Numbers, result: ImageResult) -> None:
        """Store the result for an image."""
        with self._lock:
            self._known.append((thumbnail, result))


@dataclass(frozen=True)
class ImageEvidence:
    """The network and the classifier, for a running system with a memory of what they found."""

    network: Network
    classifier: ImageClassifier
    memory: ImageMemory | None = field(default=None, compare=False)

    def results(self, views: Sequence[LabelledImage], numbers: Sequence[int]) -> dict[int, ImageResult]:
        """Return the results of things by number, without those that no view shows.

        They come from memory where the things look the same as before.
        """
        crops = {number: pair for number in numbers if (pair := crops_of(views, number))}
        done: dict[int, ImageResult] = {}
        thumbnails = {n: _thumbnail(*pair) for n, pair in crops.items()}
        if self.memory is not None:
            known = {n: self.memory.find(thumbnail) for n, thumbnail in thumbnails.items()}
            done = {n: result for n, result in known.items() if result is not None}
        new = [n for n in crops if n not in done]
        if new:
            outputs = self.network([crops[n][part] for part in (0, 1) for n in new])
            whole, alone = (Outputs(*(of[half] for of in outputs)) for half in _halves(len(new)))
            found = map(ImageResult, self.classifier(whole, alone), unit_features(alone))
            done |= dict(zip(new, found, strict=True))
            if self.memory is not None:
                for n in new:
                    self.memory.keep(thumbnails[n], done[n])
        return done


@dataclass(frozen=True)
class ThingImages:
    """The images of things in the views of one frame. The network processes each of them at most once.

    `numbers`: the number of each thing in `views`.
    """

    evidence: ImageEvidence
    views: Sequence[LabelledImage]
    numbers: tuple[int, ...]
    _done: dict[int, ImageResult | None] = field(default_factory=dict, compare=False)

    def select(self, things: Sequence[int]) -> ThingImages:
        """Return the images of some of the things, in this order."""
        return replace(self, numbers=tuple(self.numbers[n] for n in things))

    def fits(self, things: Sequence[int], learnt: RecognitionModel) -> Numbers:
        """Return (N, K) how well the images of things fit each leaf; NaN for one that no view shows."""
        classifier = self.evidence.classifier
        rows = np.full((len(things), len(learnt.classes)), np.nan)
        columns = [learnt.classes.index(leaf) for leaf in classifier.leaves]
        for row, result in zip(rows, self._results(things), strict=True):
            if result is not None:
                row[:] = classifier.least
                row[columns] = result.fits
        return rows

    def features(self, things: Sequence[int]) -> Numbers:
        """Return (N, FEATURES) the features of things; zeros for one that no view shows."""
        nothing = np.zeros(FEATURES)
        found = [nothing if result is None else result.features for result in self._results(things)]
        return np.array(found).reshape(len(things), FEATURES)

    def known_features(self, things: Sequence[int]) -> Numbers:
        """Return (N, FEATURES) as `features`, but zeros for things that the network has not processed."""
        known = [n for n, thing in enumerate(things) if self.numbers[thing] in self._done]
        rows = np.zeros((len(things), FEATURES))
        rows[known] = self.features([things[n] for n in known])
        return rows

    def similarities(self, kept: Numbers, things: Sequence[int]) -> Numbers:
        """Return (V, N) cosines of stored features (V, FEATURES) and those of things; NaN without."""
        return self.evidence.classifier.similarities(kept, self.features(things))

    def _results(self, things: Sequence[int]) -> list[ImageResult | None]:
        asked = [self.numbers[thing] for thing in things]
        new = [number for number in asked if number not in self._done]
        self._done.update(dict.fromkeys(new) | self.evidence.results(self.views, new))
        return [self._done[number] for number in asked]


def _halves(count: int) -> tuple[slice, slice]:
    return slice(0, count), slice(count, 2 * count)


def _thumbnail(whole: Bytes, alone: Bytes) -> Numbers:
    """Return the mean colours of tiles of both images."""
    side = len(whole) // _THUMBNAIL
    shape = 2, _THUMBNAIL, side, _THUMBNAIL, side, 3
    return np.asarray(np.stack([whole, alone]).reshape(shape).mean(axis=(2, 4)))


def with_images(learnt: RecognitionModel, *, live: bool = False) -> RecognitionModel:
    """Return the model with evidence of images, or the model as it is if their packages are not installed.

    With `live`, it remembers what it saw. Raises BadFile if the weights of the network are not valid.
    """
    if not available():
        return learnt
    evidence = ImageEvidence(load_network(), shipped(), ImageMemory() if live else None)
    return replace(learnt, images=evidence)
