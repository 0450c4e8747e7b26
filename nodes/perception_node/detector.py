"""A detector of one's own: what it left in files beside the pictures."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from nodes.perception_node.input.files.mask_files import read_masks
from nodes.perception_node.input.masks import Masks
from nodes.perception_node.recognition.told_names import Labels
from nodes.perception_node.views.masked import with_masks
from nodes.perception_node.views.segmented_view import Sight


@dataclass(frozen=True)
class Detector:
    """Its file, or its name in each folder of a dataset, and what its labels mean here.

    `alone`: there is nothing to be found but what it has found.
    """

    file: Path
    labels: Labels
    alone: bool = False

    def masks_of(self, file: Path, shape: tuple[int, int]) -> Masks:
        """The masks in a file for a picture of this shape (H, W). Raises BadFile."""
        return replace(read_masks(file, *shape), alone=self.alone)

    def cut(self, sight: Sight) -> Sight:
        """A picture that was taken apart, with its masks. Raises BadFile."""
        height, width = sight.labels.shape
        return with_masks(sight, self.masks_of(self.file, (height, width)))
