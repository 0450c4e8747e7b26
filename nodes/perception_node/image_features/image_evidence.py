"""What the images of things say about their classes."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from semmap.nodes.perception_node.image_features.crops import Bytes, LabelledImage, crops_of
from semmap.nodes.perception_node.image_features.image_classifier import ImageClassifier, shipped
from semmap.nodes.perception_node.image_features.network import Outputs, available, load_network
from semmap.nodes.perception_node.recognition.recognition_model import RecognitionModel
from semmap.nodes.perception_node.views.boxes import Numbers

_KEPT = 256
_THUMBNAIL = 8
_SAME = 4.0
"""Images whose thumbnails differ by less on average (of 255) show the same."""

Network = Callable[[Sequence[Bytes]], Outputs]


class _Known(NamedTuple):
    thumbnail: Numbers
    fits: Numbers


class ImageMemory:
    """The results of the last images, so that a thing that rests costs the network nothing. Thread-safe."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._known: deque[_Known] = deque(maxlen=_KEPT)

    def find(self, thumbnail: Numbers) -> Numbers | None:
        """Return the result for an image that looks like this one, or None."""
        with self._lock:
            if not self._known:
                return None
            apart = [float(np.abs(known.thumbnail - thumbnail).mean()) for known in self._known]
            nearest = int(np.argmin(apart))
            return self._known[nearest].fits if apart[nearest] < _SAME else None

    def keep(self, thumbnail: Numbers, fits: Numbers) -> None:
        """Store the result for an image."""
        with self._lock:
            self._known.append(_Known(thumbnail, fits))


@dataclass(frozen=True)
class ImageEvidence:
    """The network and the classifier, for a running system with a memory of what they found."""

    network: Network
    classifier: ImageClassifier
    memory: ImageMemory | None = field(default=None, compare=False)

    def fits(
        self, views: Sequence[LabelledImage], numbers: Sequence[int], learnt: RecognitionModel
    ) -> Numbers:
        """Return (N, K) how well the images of things fit each leaf; all 1 if no view shows a thing."""
        rows = np.ones((len(numbers), len(learnt.classes)))
        columns = [learnt.classes.index(leaf) for leaf in self.classifier.leaves]
        found = {n: crops for n, number in enumerate(numbers) if (crops := crops_of(views, number))}
        for n, fits in self._classified(found).items():
            rows[n] = self.classifier.least
            rows[n, columns] = fits
        return rows

    def _classified(self, crops: dict[int, tuple[Bytes, Bytes]]) -> dict[int, Numbers]:
        """Return the fits of things by number, from memory where they look the same as before."""
        done: dict[int, Numbers] = {}
        thumbnails = {n: _thumbnail(*pair) for n, pair in crops.items()}
        if self.memory is not None:
            known = {n: self.memory.find(thumbnail) for n, thumbnail in thumbnails.items()}
            done = {n: fits for n, fits in known.items() if fits is not None}
        new = [n for n in crops if n not in done]
        if new:
            outputs = self.network([crops[n][part] for part in (0, 1) for n in new])
            halves = (Outputs(*(of[half] for of in outputs)) for half in _halves(len(new)))
            done |= dict(zip(new, self.classifier(*halves), strict=True))
            if self.memory is not None:
                for n in new:
                    self.memory.keep(thumbnails[n], done[n])
        return done


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
