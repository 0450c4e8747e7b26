"""The output of an external detector, stored in files next to the images."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from semmap.nodes.perception_node.input.files.mask_files import read_masks
from semmap.nodes.perception_node.input.masks import Masks
from semmap.nodes.perception_node.recognition.detector_labels import LabelMap


@dataclass(frozen=True)
class Detector:
    """The file of a detector, or its name in each folder of a dataset, and a map of its labels.

    With `alone`, only the detector's masks are things.
    """

    file: Path
    labels: LabelMap
    alone: bool = False

    def masks_of(self, file: Path, shape: tuple[int, ...]) -> Masks:
        """Read the masks for an image of this shape (H, W) from a file. Raises BadFile."""
        height, width = shape
        return replace(read_masks(file, height, width), alone=self.alone)
