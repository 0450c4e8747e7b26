"""Combines the probabilities of the classifiers with what images say."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN, RecognitionModel
from semmap.nodes.perception_node.views.boxes import Numbers

ImageFits = Callable[[Sequence[int]], Numbers]
"""Returns for the numbers of things (N,) how well their images fit each leaf (N, K)."""

_CERTAIN = 0.97
"""A thing that shape and colours recognise with more than this probability needs no image."""
MOST_CLUTTER = 0.7
"""The images of things that are clutter with more than this probability are not used."""
_LEAST = 1e-6
"""Keeps logarithms finite; 0.001 and more let images name a thing that its shape rules out."""
_SHAPE = 0.5
"""Weight of the logarithm of the probabilities by shape and colours, where that of images has weight 1."""
_UNKNOWN = 0.2
"""Weight of `Object` in images. This weight and the one above maximise the likelihood of renderings of other
meshes and of real table scenes together: 0.52 to 0.54 and 0.13 to 0.28 in four folds."""


def with_image_votes(chances: Numbers, learnt: RecognitionModel, fits: ImageFits) -> Numbers:
    """Return (N, K) probabilities of leaves, with images as further votes on doubtful things.

    Clutter and exemplars keep their probability: an image does not show where a thing ends, and exemplars
    are compared with the thing itself.
    """
    clutter, unknown = learnt.classes.index(CLUTTER), learnt.classes.index(UNKNOWN)
    fixed = np.zeros(len(learnt.classes), bool)
    fixed[clutter] = True
    if learnt.exemplars is not None:
        fixed[len(learnt.classes) - len(learnt.exemplars.exemplars) :] = True
    named = np.delete(chances, [clutter, unknown], axis=1).max(axis=1, initial=0.0)
    doubtful = np.flatnonzero((named <= _CERTAIN) & (chances[:, clutter] <= MOST_CLUTTER))
    if not doubtful.size:
        return chances
    logs = _SHAPE * np.log(chances[doubtful][:, ~fixed] + _LEAST)
    said = fits(doubtful.tolist())[:, ~fixed]
    told = (said != 1.0).any(axis=1)
    logs += np.log(said)
    logs[:, np.count_nonzero(~fixed[:unknown])] += np.log(_UNKNOWN)
    votes = np.exp(logs - logs.max(axis=1, keepdims=True))
    rest = chances[doubtful][:, ~fixed].sum(axis=1, keepdims=True)
    pooled = chances.copy()
    pooled[np.ix_(doubtful[told], ~fixed)] = (rest * votes / votes.sum(axis=1, keepdims=True))[told]
    return pooled
