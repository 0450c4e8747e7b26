"""The images of what is observed in a frame, to recognise things that were moved."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from semmap.nodes.perception_node.tracking.tracks import Track
from semmap.nodes.perception_node.views.boxes import Numbers


@dataclass(frozen=True)
class ObservedImages:
    """The features (N, FEATURES) of the images of N observations, zeros where unknown.

    `similarities(kept, seen)` compares rows (V, FEATURES) with others: (V, N) cosines.
    """

    features: Numbers
    similarities: Callable[[Numbers, Numbers], Numbers]

    def compare(self, track: Track, j: int) -> float:
        """Return the cosine of the images of a track and of an observation; NaN if one is unknown."""
        if track.image is None or not len(self.features):
            return math.nan
        return float(self.similarities(track.image[None], self.features[j : j + 1])[0, 0])

    def remember(self, track: Track, j: int) -> Track:
        """Return the track with the image of an observation, if it is known."""
        known = len(self.features) and self.features[j].any()
        return replace(track, image=self.features[j]) if known else track


NO_IMAGES = ObservedImages(np.zeros((0, 0)), lambda kept, seen: np.full((len(kept), len(seen)), np.nan))
"""What is observed without images."""
