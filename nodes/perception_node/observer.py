"""Processes frames one after another, with a memory of earlier frames."""

from __future__ import annotations

from collections.abc import Sequence

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.masks import Masks
from semmap.nodes.perception_node.pipeline import FrameResult, observe_clouds
from semmap.nodes.perception_node.recognition.detector_labels import LabelMap
from semmap.nodes.perception_node.recognition.recognition_model import RecognitionModel
from semmap.nodes.perception_node.views.segment_memory import SegmentMemory


class Observer:
    """Processes clouds and remembers what moving cameras saw. Bound to one thread."""

    def __init__(self, learnt: RecognitionModel, labels: LabelMap | None = None) -> None:
        """Start without memory. `labels` maps the labels of an external detector to classes."""
        self._learnt = learnt
        self._labels = labels
        self._remembered = SegmentMemory()

    def set_model(self, learnt: RecognitionModel) -> None:
        """Use this model from the next frame on. May be called on any thread."""
        self._learnt = learnt

    def __call__(self, clouds: Sequence[Cloud], masks: Sequence[Masks | None] = ()) -> FrameResult:
        """Process the clouds of one moment; see `pipeline.observe_clouds`."""
        found = observe_clouds(clouds, self._learnt, masks, self._labels, self._remembered)
        self._remembered = found.remembered
        return found
