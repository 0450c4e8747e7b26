"""Excludes samples with unnatural colours: a blue orange would be learnt as an orange, but is a ball."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from semmap.nodes.perception_node.recognition.features import MEAN_COLOUR
from semmap.nodes.training.recognition.samples import Samples
from semmap.nodes.training.scenes.sampling import COLOURED

_NEAR = 0.03
"""The maximum distance of colour shares (red, green, blue) from those of the unmodified models."""


def unnatural(samples: Samples, own: Samples) -> NDArray[np.bool_]:
    """Return (N,) whether a sample of a naturally coloured kind has colours that `own` does not have.

    Kinds that are not in `own` can have the colours of any kind. Samples without colours are not excluded.
    """
    found = np.zeros(len(samples), bool)
    for kind in COLOURED:
        rows, as_it_is = samples.kind == kind, own.kind == kind
        if not as_it_is.any():
            as_it_is = np.isin(own.kind, COLOURED)
        if rows.any() and as_it_is.any():
            apart, _ = KDTree(_shares(own.colour[as_it_is])).query(_shares(samples.colour[rows]))
            found[rows] = apart > _NEAR
    return np.asarray(found & (samples.colour[:, MEAN_COLOUR].sum(axis=1) > 0.0))


def _shares(colour: NDArray[np.float64]) -> NDArray[np.float64]:
    mean = colour[:, MEAN_COLOUR]
    return np.asarray(mean / np.maximum(mean.sum(axis=1, keepdims=True), 1e-6))
