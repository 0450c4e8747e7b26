"""Combines the probabilities of the classifiers with the evidence of images."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN, RecognitionModel
from semmap.nodes.perception_node.views.boxes import Numbers

ImageFits = Callable[[Sequence[int]], Numbers]
"""Returns for the numbers of things (N,) how well their images fit each leaf (N, K); NaN without an image."""

MOST_CLUTTER = 0.7
"""The images of things that are clutter with more than this probability are not used."""
_LEAST = 1e-6
"""Keeps logarithms finite; 0.001 and more let images name a thing that its shape rules out."""
_SHAPE, _IMAGE, _UNKNOWN = 0.3, 1.2, 0.2
"""Weights of the logarithms of the probabilities by shape and colours and of those by photographs, and the
weight of `Object`. They maximise the likelihood of real table scenes and of renderings of other meshes: 0.27
to 0.31, 1.04 to 1.33 and 0.10 to 0.29 in four folds."""


def with_image_votes(chances: Numbers, learnt: RecognitionModel, fits: ImageFits) -> Numbers:
    """Return (N, K) probabilities of leaves, with photographs as further votes on things that they show.

    Clutter and exemplars keep their probability: an image does not show where a thing ends, and exemplars
    are compared with the thing itself.
    """
    clutter, unknown = learnt.classes.index(CLUTTER), learnt.classes.index(UNKNOWN)
    fixed = np.zeros(len(learnt.classes), bool)
    fixed[clutter] = True
    if learnt.exemplars is not None:
        fixed[len(learnt.classes) - len(learnt.exemplars.exemplars) :] = True
    things = np.flatnonzero(chances[:, clutter] <= MOST_CLUTTER)
    of_images = fits(things.tolist())[:, ~fixed]
    shown = np.isfinite(of_images).all(axis=1)
    things, of_images = things[shown], of_images[shown]
    logs = _SHAPE * np.log(chances[things][:, ~fixed] + _LEAST) + _IMAGE * np.log(of_images)
    logs[:, np.count_nonzero(~fixed[:unknown])] += np.log(_UNKNOWN)
    votes = np.exp(logs - logs.max(axis=1, keepdims=True))
    rest = chances[things][:, ~fixed].sum(axis=1, keepdims=True)
    pooled = chances.copy()
    pooled[np.ix_(things, ~fixed)] = rest * votes / votes.sum(axis=1, keepdims=True)
    return pooled
