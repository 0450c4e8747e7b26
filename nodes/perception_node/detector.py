"""A detector of one's own: what it left in files beside the pictures."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from semmap.nodes.perception_node.input.files.mask_files import read_masks
from semmap.nodes.perception_node.input.masks import Masks
from semmap.nodes.perception_node.recognition.told_names import Labels


@dataclass(frozen=True)
class Detector:
    """Its file, or its name in each folder of a dataset, and what its labels mean here.

    `alone`: there is nothing to be found but what it has found.
    """

    file: Path
    labels: Labels
    alone: bool = False

    def masks_of(self, file: Path, shape: tuple[int, ...]) -> Masks:
        """The masks in a file for a picture of this shape (H, W). Raises BadFile."""
        height, width = shape
        return replace(read_masks(file, height, width), alone=self.alone)
