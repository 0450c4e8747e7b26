"""What has its colour by nature, as fruit does, is not learnt from in another: a blue orange is a ball."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from semmap.nodes.perception_node.recognition.features import MEAN_COLOUR
from semmap.nodes.training.recognition.samples import Samples
from semmap.nodes.training.scenes.sampling import COLOURED

_NEAR = 0.03
"""How far its shares of red, green and blue may be from those of any of its like, as they are."""


def unnatural(samples: Samples, own: Samples) -> NDArray[np.bool_]:
    """(N,) whether each is of a kind that has its colours by nature, and was seen in others than `own` have.

    A kind that is not among `own` may have the colours of any. Of what was seen without colours nothing is
    known.
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
