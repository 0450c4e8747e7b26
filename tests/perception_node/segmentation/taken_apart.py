"""Patches of synthetic scenes."""

from __future__ import annotations

import numpy as np

from semmap.nodes.perception_node.segmentation.segment import Parts, split_into_patches
from tests.perception_node.segmentation.scenes import Seen


def owners(parts: Parts, seen: Seen) -> np.ndarray:
    """Return (P,) the box to which most of each patch belongs."""
    truth = seen.truth[:: parts.grid.step, :: parts.grid.step]
    return np.array(
        [np.bincount(truth[parts.of_patch == n]).argmax() for n in range(1, parts.of_patch.max() + 1)]
    )


def apart(seen: Seen) -> tuple[Parts, np.ndarray]:
    """Return the patches and their boxes."""
    parts = split_into_patches(seen.cloud)
    return parts, owners(parts, seen)
