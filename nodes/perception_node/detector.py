"""A detector: its output in files next to the images, or a model that is run on the images."""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from pathlib import Path

from semmap.nodes.perception_node.detection.detector_model import DetectorModel
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.files.mask_files import read_masks
from semmap.nodes.perception_node.input.masks import Masks
from semmap.nodes.perception_node.recognition.detector_labels import LabelMap
from semmap.schemas.errors import BadFile

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Detector:
    """The file of a detector, or its name in each folder of a dataset, or a model; and a map of its labels.

    With `alone`, only the detector's masks are things.
    """

    source: Path | DetectorModel
    labels: LabelMap
    alone: bool = False

    def masks_of(
        self, cloud: Cloud, shape: tuple[int, int], step: int = 1, folder: Path | None = None
    ) -> Masks:
        """Return the masks for a cloud of every `step`-th pixel of an image of this shape (H, W).

        A file is looked for in `folder`. Raises BadFile.
        """
        if isinstance(self.source, DetectorModel):
            return replace(detected(self.source, cloud), alone=self.alone)
        file = self.source if folder is None else folder / self.source
        return replace(read_masks(file, *shape), alone=self.alone).thinned(step)


def detected(model: DetectorModel, cloud: Cloud) -> Masks:
    """Return a model's detections in the colours of a cloud.

    Raises BadFile for a cloud without image, and if the model fails or its outputs cannot be decoded.
    """
    if cloud.colors is None or not cloud.organised:
        lack = "colours" if cloud.colors is None else "rows and columns of an image"
        raise BadFile(f"{model.file} needs a colour image, and the cloud has no {lack}; remove --detector")
    try:
        return model(cloud.colors)
    except BadFile:
        raise
    except Exception as error:
        log.exception("%s failed", model.file)
        raise BadFile(f"{model.file} failed: {type(error).__name__}: {error}") from None
