"""Looks one after the other, each of which knows what the ones before it have seen."""

from __future__ import annotations

from collections.abc import Sequence

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.masks import Masks
from semmap.nodes.perception_node.pipeline import Look, look
from semmap.nodes.perception_node.recognition.shipped_votes import Learnt
from semmap.nodes.perception_node.recognition.told_names import Labels
from semmap.nodes.perception_node.views.remembered import Remembered


class Watching:
    """Looks at clouds, and remembers what moving cameras see. Bound to one thread."""

    def __init__(self, learnt: Learnt, labels: Labels | None = None) -> None:
        """Nothing was seen yet. `labels`: what those of somebody else's detector mean here."""
        self._learnt = learnt
        self._labels = labels
        self._remembered = Remembered()

    def take(self, learnt: Learnt) -> None:
        """Know this from the next look on. Any thread may say so."""
        self._learnt = learnt

    def __call__(self, clouds: Sequence[Cloud], masks: Sequence[Masks | None] = ()) -> Look:
        """What clouds of one moment show; see `pipeline.look`."""
        found = look(clouds, self._learnt, masks, self._labels, self._remembered)
        self._remembered = found.remembered
        return found
