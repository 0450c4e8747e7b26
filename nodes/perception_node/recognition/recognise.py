"""From visible things to observations: class, pose and complete size."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from semmap.nodes.perception_node.image_features.image_evidence import ThingImages
from semmap.nodes.perception_node.image_features.image_votes import MOST_CLUTTER, with_image_votes
from semmap.nodes.perception_node.recognition.detector_labels import (
    LabelMap,
    as_general,
    detector_class,
    unknown_label,
    with_detector_labels,
)
from semmap.nodes.perception_node.recognition.features import features_of
from semmap.nodes.perception_node.recognition.free_standing import are_free_standing, reaches_support
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN, RecognitionModel
from semmap.nodes.perception_node.recognition.sides import completed, side_features
from semmap.nodes.perception_node.recognition.vote import (
    choose_class,
    expected_sizes,
    leaf_probabilities,
    probability_of,
)
from semmap.nodes.perception_node.views.boxes import Box, Numbers, best_yaw, box_around, in_frame
from semmap.nodes.perception_node.views.merged_thing import Thing
from semmap.schemas.entities import Pose, orientation_from_yaw
from semmap.schemas.perception import SURE, Observation

_CANDIDATES = 5
_CLUTTER, _CLUTTER_CUT = 0.7, 0.35
"""Maximum probability of clutter of a reported thing, and of one that an image edge cuts above its support:
walls of bins and pieces of furniture appear there."""
_WORTH_SAYING = 0.01
_TRIMMED_BELOW = 0.6
_TRIMMING_GAIN = 0.3
_OUTERMOST = 0.03
_LEFT = 0.6
"""A thing whose box shrinks below this share without few cells may include a piece of another thing."""
_FEWEST = 60


class Clutter(NamedTuple):
    """A thing that is not reported, because it is a fragment with this probability."""

    probability: float

    @property
    def reason(self) -> str:
        """Return why it is not reported, for the user."""
        return f"classified as clutter ({self.probability:.2f}): a fragment, or a part of furniture"


def recognise(
    things: Sequence[Thing],
    chances: Numbers,
    learnt: RecognitionModel,
    labels: LabelMap | None = None,
    images: ThingImages | None = None,
) -> list[Observation | Clutter]:
    """Return an observation of each thing that is not clutter.

    A free-standing thing is not clutter, but of unknown class. `chances`: (N, K) the probabilities of the
    leaves. `labels` maps labels of detectors to classes. `images`: those of the things.
    """
    labels = labels or LabelMap(learnt)
    chances = _no_clutter(things, reclassify_trimmed(things, chances, learnt), learnt)
    if images is not None:
        chances = _shown_in_images(chances, learnt, images)
        chances = with_image_votes(chances, learnt, lambda numbers: images.fits(numbers, learnt))
    own, chances = chances, with_detector_labels(chances, things, learnt, labels)
    expected = expected_sizes(chances, learnt.sizes_m)
    rows = zip(things, chances, own, expected, strict=True)
    return [_observation(*row, labels, learnt) for row in rows]


def _shown_in_images(chances: Numbers, learnt: RecognitionModel, images: ThingImages) -> Numbers:
    """Return probabilities (N, K) in which images help to recognise exemplars among what is not clutter."""
    if learnt.exemplars is None:
        return chances
    rows, chances = np.flatnonzero(chances[:, learnt.classes.index(CLUTTER)] <= MOST_CLUTTER), chances.copy()
    chances[rows] = learnt.exemplars.with_images(
        chances[rows], lambda kept: images.similarities(kept, rows.tolist())
    )
    return chances


def _no_clutter(things: Sequence[Thing], chances: Numbers, learnt: RecognitionModel) -> Numbers:
    """Return probabilities in which free-standing things that would be clutter are `UNKNOWN`."""
    clutter, unknown = learnt.classes.index(CLUTTER), learnt.classes.index(UNKNOWN)
    fragments = chances[:, clutter] > _CLUTTER
    kept = fragments & are_free_standing(things, ~fragments)
    chances = chances.copy()
    chances[kept, unknown] += chances[kept, clutter]
    chances[kept, clutter] = 0.0
    return chances


def _observation(
    thing: Thing,
    probabilities: Numbers,
    own: Numbers,
    expected_m: Numbers,
    labels: LabelMap,
    learnt: RecognitionModel,
) -> Observation | Clutter:
    chances = dict(zip(learnt.classes, probabilities.tolist(), strict=True))
    clutter = chances.pop(CLUTTER)
    if clutter > (_CLUTTER if thing.whole or reaches_support(thing) else _CLUTTER_CUT):
        return Clutter(clutter)
    chances = {leaf: chance / (1.0 - clutter) for leaf, chance in chances.items()}
    class_, probability = choose_class(chances, learnt.ancestors)
    if class_ == UNKNOWN:
        probability = chances[UNKNOWN]  # that it is an Object is certain
    ours = dict(zip(learnt.classes, own.tolist(), strict=True))
    shares = chances
    general = as_general(thing, class_, ours, learnt, labels)
    if general != class_:
        class_, probability = general, probability_of(general, chances, learnt.ancestors)
        below = {leaf for leaf in chances if general in learnt.ancestors.get(leaf, ())}
        shares = {leaf: min(p, ours[leaf]) if leaf in below else p for leaf, p in chances.items()}
        shares[general] = probability
    detected = detector_class(thing, learnt, labels)
    if detected is not None and detected[1] > _least(class_, probability, detected[0], labels, learnt):
        class_, probability = detected
    label = unknown_label(thing, labels)
    likely = max(chances, key=chances.__getitem__)
    box = completed(thing, side_features(thing, expected_m), learnt.sides)
    box = _turned(box, bool(learnt.sideways[learnt.classes.index(likely)]))
    x, y, z = box.bottom_m.tolist()
    a, b, c = box.size_m.tolist()
    return Observation(
        class_=learnt.class_of(class_),
        probability=probability,
        candidates=_candidates(shares, learnt),
        pose=Pose(position_m=(x, y, z), orientation_wxyz=orientation_from_yaw(box.yaw_rad)),
        size_m=(a, b, c),
        points=thing.count,
        whole=thing.whole,
        shown=_as_shown(chances, class_, learnt),
        label=label or "",
        labelled=label is not None,
        color_rgb=None if thing.colors is None else _mean_color(thing.colors),
    )


def _least(
    class_: str, probability: float, detected: str, labels: LabelMap, learnt: RecognitionModel
) -> float:
    """Return the score above which a detected class that was not learnt replaces ours."""
    return SURE if class_ in (UNKNOWN, *labels.ancestors_of(detected)) else probability


def _mean_color(colors: Numbers) -> tuple[float, float, float]:
    red, green, blue = colors.mean(axis=0).round(3).tolist()
    return (red, green, blue)


def _as_shown(chances: Mapping[str, float], class_: str, learnt: RecognitionModel) -> bool:
    """Return whether exemplars contribute at least as much to a class (or leaf) as the votes."""
    exemplars = (
        set() if learnt.exemplars is None else {exemplar.leaf for exemplar in learnt.exemplars.exemplars}
    )
    of_it = {leaf for leaf in chances if class_ in (leaf, *learnt.ancestors.get(leaf, ()))}
    shown = sum(chances[leaf] for leaf in of_it & exemplars)
    return shown > 0.0 and shown >= sum(chances[leaf] for leaf in of_it - exemplars)


def _candidates(chances: Mapping[str, float], learnt: RecognitionModel) -> dict[str, float]:
    """Return the likely leaves by class; an exemplar counts for its class."""
    found: dict[str, float] = {}
    for leaf in sorted(chances, key=chances.__getitem__, reverse=True)[:_CANDIDATES]:
        if chances[leaf] > _WORTH_SAYING:
            found[learnt.class_of(leaf)] = min(1.0, found.get(learnt.class_of(leaf), 0.0) + chances[leaf])
    return found


def _turned(box: Box, sideways: bool) -> Box:
    """Return the box with its longer side along the usual axis of its class, and yaw in (-pi / 2, pi / 2]."""
    if (box.size_m[1] > box.size_m[0]) != sideways:
        box = box.quarter_turned()
    yaw = math.remainder(box.yaw_rad, math.pi)
    if abs(yaw - box.yaw_rad) < 1e-9:
        return box
    flip = round((box.yaw_rad - yaw) / math.pi) % 2
    low, high = (box.low, box.high) if not flip else (box.low.copy(), box.high.copy())
    if flip:
        low[:2], high[:2] = -box.high[:2], -box.low[:2]
    return Box(low, high, yaw)


def reclassify_trimmed(things: Sequence[Thing], chances: Numbers, learnt: RecognitionModel) -> Numbers:
    """Return (N, K) leaf probabilities, those of the trimmed thing if it is recognised much better.

    A new thing must not become a known one by trimming, so the gain has to be large.
    """
    nameable = np.array([name not in (UNKNOWN, CLUTTER) for name in learnt.classes])
    known = chances[:, nameable].max(axis=1, initial=0.0)
    trimmed = {
        n: trim(thing)
        for n, thing in enumerate(things)
        if known[n] < _TRIMMED_BELOW and not thing.carrier and len(thing.cells) > _FEWEST
    }
    rows = [n for n, part in trimmed.items() if part.box.size_m.prod() < _LEFT * things[n].box.size_m.prod()]
    if not rows:
        return chances
    again = leaf_probabilities(learnt, features_of([trimmed[n] for n in rows]))
    better = again[:, nameable].max(axis=1) > known[rows] + _TRIMMING_GAIN
    chances = chances.copy()
    chances[np.array(rows)[better]] = again[better]
    return chances


def trim(thing: Thing) -> Thing:
    """Return a thing without its outermost cells along each axis of its box, except at the bottom."""
    turned = in_frame(thing.cells, thing.box.yaw_rad)
    low, high = np.quantile(turned, [_OUTERMOST, 1.0 - _OUTERMOST], axis=0)
    inner = (turned >= low)[:, :2].all(axis=1) & (turned <= high).all(axis=1)
    cells = thing.cells[inner]
    return replace(
        thing,
        cells=cells,
        colors=None if thing.colors is None else thing.colors[inner],
        box=box_around(cells, best_yaw(cells), float(thing.box.low[2])),
    )
