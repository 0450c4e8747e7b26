"""Real things that are shown once in one frame, and looked for in the others.

Each look at a thing that perception finds by itself is shown in turn, and the thing is looked for in the
other frames in which it is. A look that is not found there counts as not recognised. Each thing counts the
same.
"""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.perception.exemplars import exemplar_of
from benchmarks.perception.real_frames import frame_sets
from benchmarks.perception.same_things import THINGS, Look
from benchmarks.perception.table import Row
from semmap.nodes.perception_node.exemplar_views import ExemplarView, exemplar_view_of
from semmap.nodes.perception_node.image_features.image_evidence import ThingImages, with_images
from semmap.nodes.perception_node.input.files.frame_folders import read_frame
from semmap.nodes.perception_node.pipeline import RecognitionModel, observe_clouds
from semmap.nodes.perception_node.recognition import similarity
from semmap.nodes.perception_node.recognition.exemplars import with_exemplars
from semmap.nodes.perception_node.recognition.features import features_of
from semmap.nodes.perception_node.recognition.recognise import recognise
from semmap.nodes.perception_node.recognition.vote import leaf_probabilities
from semmap.nodes.perception_node.tracking.class_hierarchy import ClassHierarchy
from semmap.nodes.perception_node.tracking.costs import FORBIDDEN, Target, cost_anywhere
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.nodes.perception_node.views.merged_thing import Thing
from semmap.schemas.perception import Observation

_ROUNDS = 4
"""How often all things are shown at once, each by another look."""


@dataclass(frozen=True)
class _Frame:
    """The things of a frame, and for each object of its `truth.json` the thing in its middle, from 0."""

    things: tuple[Thing, ...]
    observations: tuple[Observation, ...]
    features: list[Numbers]
    images: ThingImages | None
    matches: tuple[int | None, ...]
    asked: tuple[bool, ...]

    def is_single(self, number: int) -> bool:
        """Return whether an object is found, and not together with another one."""
        of = [match for match, asked in zip(self.matches, self.asked, strict=True) if asked]
        return self.matches[number] is not None and of.count(self.matches[number]) == 1

    def classes(self, learnt: RecognitionModel, *, images: bool) -> list[str]:
        """Return the class of each thing, with the features of their images or without."""
        if not self.things:
            return []
        chances = leaf_probabilities(learnt, self.features)
        found = recognise(self.things, chances, learnt, images=self.images if images else None)
        return [one.class_ if isinstance(one, Observation) else "" for one in found]

    def view(self, number: int, learnt: RecognitionModel) -> ExemplarView:
        """Return an object as it is shown."""
        match = self.matches[number]
        if match is None:
            raise ValueError("what is not found cannot be shown")
        images = None if self.images is None else self.images.select([match])
        return exemplar_view_of(self.things[match], learnt, images)


Frames = Mapping[str, _Frame]


def measure(data: Path, learnt: RecognitionModel) -> list[Row]:
    """Return the figures by shape and colours, and with images."""
    learnt = with_images(learnt)
    with frame_sets(data) as sets:
        folders = [folder for frames in sets.values() for folder in frames.iterdir()]
        frames = {folder.name: _frame(folder, learnt) for folder in folders}
    if not frames:
        return []
    looks = [look for many in THINGS.values() for look in many]
    found = sum(frames[look.frame].matches[look.number] is not None for look in looks)
    rows = [Row(f"shown once: {len(THINGS)} things, {len(looks)} looks: found at all", found / len(looks))]
    ways = ((False, "shape and colours"), (True, "with images"))
    for images, how in ways:  # first, while only the images of doubtful things are known, as in a system
        rows += _rows_of_moves(frames, learnt, how, images=images)
    for images, how in ways:
        rows += _rows(frames, learnt, how, images=images)
    return rows


def _frame(folder: Path, learnt: RecognitionModel) -> _Frame:
    frame, truth = read_frame(folder), json.loads((folder / "truth.json").read_text())["objects"]
    seen = observe_clouds([frame.cloud], learnt)
    at = [int(seen.labels[0][one["v"] // frame.step, one["u"] // frame.step]) for one in truth]
    return _Frame(
        seen.things,
        seen.observations.observations,
        features_of(seen.things) if seen.things else [],
        seen.images,
        tuple(number - 1 if number else None for number in at),
        tuple(not one.get("optional") for one in truth),
    )


def _rows(frames: Frames, learnt: RecognitionModel, how: str, *, images: bool) -> list[Row]:
    shown = {
        name: [look for look in looks if frames[look.frame].is_single(look.number)]
        for name, looks in THINGS.items()
    }
    alone, others, searched = defaultdict[str, list[bool]](list), 0, 0
    for name, looks in shown.items():
        for look in looks:
            where = {other.frame for other in THINGS[name]} - {look.frame}
            right, wrong = _search(frames, {name: look}, where, learnt, images=images)
            alone[name] += right[name]
            others, searched = others + wrong, searched + len(where)
    together, confused = defaultdict[str, list[bool]](list), 0
    for turn in range(_ROUNDS):
        each = {name: looks[turn % len(looks)] for name, looks in shown.items() if looks}
        right, wrong = _search(frames, each, frames, learnt, images=images)
        confused += wrong
        for name, of in right.items():
            together[name] += of
    return [
        Row(f"shown once, {how}: recognised", _mean_share(alone), "", 0.85, 0.95),
        Row(f"shown once, {how}: others called so, a frame", others / max(1, searched), less=True),
        Row(f"all shown at once, {how}: recognised", _mean_share(together)),
        Row(
            f"all shown at once, {how}: wrongly called so, a frame",
            confused / _ROUNDS / len(frames),
            less=True,
        ),
    ]


def _rows_of_moves(frames: Frames, learnt: RecognitionModel, how: str, *, images: bool) -> list[Row]:
    """Return how often tracking takes a thing of one frame that is gone for its look in another frame."""
    classes = ClassHierarchy({name: frozenset(above) for name, above in learnt.ancestors.items()}, {}, {})
    right, taken, moves = defaultdict[str, list[bool]](list), 0, 0
    for name, looks in THINGS.items():
        for look in looks:
            if not frames[look.frame].is_single(look.number):
                continue
            for other in looks:
                if other.frame != look.frame:
                    true = frames[other.frame].matches[other.number]
                    found = _moved(
                        frames[look.frame], look.number, frames[other.frame], classes, images=images
                    )
                    right[name].append(found is not None and found == true)
                    taken += found not in (None, true)
                    moves += 1
    return [
        Row(f"moved, {how}: keeps its identity", _mean_share(right)),
        Row(f"moved, {how}: another one is taken for it", taken / max(1, moves), less=True),
    ]


def _moved(
    before: _Frame, number: int, after: _Frame, classes: ClassHierarchy, *, images: bool
) -> int | None:
    """Return the thing of a frame, from 0, that tracking takes for an object of another frame."""
    match = before.matches[number]
    if match is None or not after.observations:
        return None
    seen = before.observations[match]
    target = Target(seen.pose, seen.size_m, seen.class_, seen.whole, color_rgb=seen.color_rgb)
    alike = np.full(len(after.observations), np.nan)
    if images and before.images is not None and after.images is not None:
        things = range(len(after.observations))
        alike = after.images.evidence.classifier.similarities(
            before.images.known_features([match]), after.images.known_features(things)
        )[0]
    pairs = zip(after.observations, alike.tolist(), strict=True)
    costs = [cost_anywhere(target, one, classes, cosine) for one, cosine in pairs]
    best = int(np.argmin(costs))
    return best if costs[best] < FORBIDDEN else None


def _mean_share(right: Mapping[str, list[bool]]) -> float:
    """Return the mean share over the things; one that cannot be shown is never recognised."""
    return sum(float(np.mean(of)) for of in right.values() if of) / len(THINGS)


def _search(
    frames: Frames, shown: Mapping[str, Look], where: Iterable[str], learnt: RecognitionModel, *, images: bool
) -> tuple[dict[str, list[bool]], int]:
    """Return for each thing whether its other looks are recognised, and how many others are called so."""
    exemplars = [
        exemplar_of(number, name, frames[look.frame].view(look.number, learnt))
        for number, (name, look) in enumerate(shown.items(), 1)
    ]
    knowing = with_exemplars(learnt, exemplars, similarity.shipped())
    said = {name: frames[name].classes(knowing, images=images) for name in where}
    right: dict[str, list[bool]] = {}
    true = set[tuple[str, int | None, str]]()
    for name, look in shown.items():
        matches = [(one.frame, frames[one.frame].matches[one.number]) for one in THINGS[name]]
        true.update((frame, match, name) for frame, match in matches)
        right[name] = [
            match is not None and said[frame][match] == name
            for frame, match in matches
            if frame != look.frame
        ]
    called = ((frame, n, class_) for frame, of in said.items() for n, class_ in enumerate(of))
    return right, sum(one[2] in shown and one not in true for one in called)
