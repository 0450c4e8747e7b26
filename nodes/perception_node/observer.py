"""Processes frames one after another, with a memory of earlier frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from semmap.nodes.perception_node.detection.detector_model import DetectorModel
from semmap.nodes.perception_node.detector import detected
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.masks import Masks
from semmap.nodes.perception_node.pipeline import FrameResult, observe_clouds
from semmap.nodes.perception_node.recognition.detector_labels import LabelMap
from semmap.nodes.perception_node.recognition.recognition_model import RecognitionModel
from semmap.nodes.perception_node.views.segment_memory import SegmentMemory
from semmap.schemas.errors import BadFile


class Observer:
    """Processes clouds and remembers what moving cameras saw. Bound to one thread."""

    def __init__(
        self,
        learnt: RecognitionModel,
        labels: LabelMap | None = None,
        detector: DetectorModel | None = None,
    ) -> None:
        """Start without memory.

        `labels` maps the labels of detectors to classes. `detector` runs on clouds without masks.
        """
        self._learnt = learnt
        self._labels = labels
        self._detector = detector
        self._remembered = SegmentMemory()

    def set_model(self, learnt: RecognitionModel) -> None:
        """Use this model from the next frame on. May be called on any thread."""
        self._learnt = learnt

    def set_labels(self, labels: LabelMap) -> None:
        """Map the labels of detectors by this from the next frame on. May be called on any thread."""
        self._labels = labels

    def __call__(self, clouds: Sequence[Cloud], masks: Sequence[Masks | None] = ()) -> FrameResult:
        """Process the clouds of one moment, without a detector that fails; see `pipeline.observe_clouds`."""
        failures: list[str] = []
        if (model := self._detector) is not None:
            given = zip(clouds, masks or [None] * len(clouds), strict=True)
            masks = [_detect(model, cloud, failures) if mask is None else mask for cloud, mask in given]
        found = observe_clouds(clouds, self._learnt, masks, self._labels, self._remembered)
        self._remembered = found.remembered
        return replace(found, failures=tuple(failures))


def _detect(model: DetectorModel, cloud: Cloud, failures: list[str]) -> Masks | None:
    """Return a model's detections. If it fails, add the reason to `failures` and return None."""
    try:
        return detected(model, cloud)
    except BadFile as error:
        failures.append(f"camera {cloud.camera}: {error.text}; objects are found without the detector")
        return None
