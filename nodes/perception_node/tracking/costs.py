"""Association costs: how much an observation differs from a known thing in place, size and class."""

from __future__ import annotations

import math
from typing import NamedTuple

from msgspec import structs

from semmap.nodes.perception_node.tracking.class_hierarchy import ANYTHING, ClassHierarchy
from semmap.nodes.perception_node.tracking.fronts import is_front
from semmap.nodes.perception_node.tracking.overlap import OrientedBox
from semmap.schemas.entities import Pose, Size, Vector, distance_m
from semmap.schemas.perception import Observation

FORBIDDEN = math.inf
_NEARBY_M = 0.05
_SAME, _SAME_OF_ANOTHER_CLASS = 0.3, 0.15
"""Maximum `size_difference` of a thing in its place, of the same or another class."""
_OF_A_KIND, _OF_ANY_KIND = 0.35, 0.15
"""The same for a thing recognised elsewhere: by class and size, or by size alone."""
_VAGUE = 0.1
"""Class difference between an unknown class and a known one."""
_BLUR_M = 0.01
"""Error of an extent, however small it is."""
_SAME_SPOT, _AS_WIDE = 0.25, 0.2
"""A thing is at its place if it is off by this share of its width, and its width differs by this (log)."""
_OUTSIZED, _USUAL = 0.5, 0.3
"""A thing is too large if it exceeds its class's size by the first (log), and typical within the second."""
_OTHER_COLOR = 0.25
"""Mean colours (rgb up to 1) of one thing, from two sides or in other light, differ by less than this."""
_UNLIKE, _ALIKE = 0.25, 0.5
"""Images of one thing have a cosine above the first (98 % on real frames), those of two below the second."""
_HIDDEN_PART = 0.3
"""Weight of a smaller extent of a partly visible thing."""


class Target(NamedTuple):
    """A thing that may be visible: its last pose, its size if known, and its class.

    `whole`: it was seen completely. `usual_m`: the typical size of its class. `color_rgb`: its mean colour.
    """

    pose: Pose
    size_m: Size | None
    class_: str
    whole: bool = True
    usual_m: Size | None = None
    color_rgb: Vector | None = None

    @property
    def box(self) -> OrientedBox | None:
        """Return its box, of its own size or that of its class."""
        size_m = self.size_m or self.usual_m
        return None if size_m is None else OrientedBox(self.pose, size_m)


def cost_in_place(target: Target, seen: Observation, classes: ClassHierarchy) -> float:
    """Return the cost of matching a thing that did not move much; FORBIDDEN if it cannot match."""
    size_m = target.size_m or seen.size_m
    horizontal, vertical = _apart(target.pose, size_m, seen)
    reach = (max(size_m[:2]) + max(seen.size_m[:2])) / 4.0 + _NEARBY_M
    if horizontal > reach or vertical > (size_m[2] + seen.size_m[2]) / 4.0 + _NEARBY_M:
        return FORBIDDEN
    mismatch, class_cost = size_difference(target, seen), class_difference(target.class_, seen, classes)
    if mismatch > _SAME and target.size_m and _is_one_but_for_its_depth(target, seen):
        mismatch, reach = _SAME_OF_ANOTHER_CLASS, max(reach, 1.5 * horizontal)
    if mismatch > (_SAME_OF_ANOTHER_CLASS if class_cost > 0.5 else _SAME):
        return FORBIDDEN
    return horizontal / reach + mismatch + class_cost


def is_complete_despite_cut(seen: Observation, target: Target) -> bool:
    """Return whether a cut observation has its class's typical size, and the thing is too large."""
    if seen.whole or not target.whole or target.size_m is None or target.usual_m is None:
        return False
    usual, before, now = _upright(target.usual_m), _upright(target.size_m), _upright(seen.size_m)
    too_large = any(math.log(old / own) > _OUTSIZED for old, own in zip(before, usual, strict=True))
    return too_large and all(abs(math.log(new / own)) < _USUAL for new, own in zip(now, usual, strict=True))


def _is_one_but_for_its_depth(target: Target, seen: Observation) -> bool:
    before, now = target.box, OrientedBox(seen.pose, seen.size_m)
    return before is not None and (is_front(before, now) or is_front(now, before))


def cost_anywhere(
    target: Target, seen: Observation, classes: ClassHierarchy, cosine: float = math.nan
) -> float:
    """Return the cost of matching a thing that vanished; FORBIDDEN if it is of another kind.

    The position has little weight. A thing back in its place may be less similar. An unknown thing is only
    recognised elsewhere if it is completely visible and has the same colour. `cosine`: that of the
    images, NaN if one is not known. Like images replace class and colour, and unlike ones forbid a match
    elsewhere.
    """
    box = target.box
    if box is None:
        return FORBIDDEN
    vague = ANYTHING in (seen.class_, target.class_) and not cosine > _ALIKE
    mismatch = size_difference(target._replace(size_m=box.size_m), seen)
    related = classes.related(target.class_, seen.class_) or cosine > _ALIKE
    matches = related and not cosine < _UNLIKE and mismatch <= (_OF_ANY_KIND if vague else _OF_A_KIND)
    if vague and not (seen.whole and _is_of_like_color(target, seen)):
        matches = False
    if not matches and cost_in_place(target, seen, classes) == FORBIDDEN:
        return FORBIDDEN
    horizontal, vertical = _apart(box.pose, box.size_m, seen)
    vaguely = vague and target.class_ != seen.class_
    class_cost = _VAGUE if vaguely else class_difference(target.class_, seen, classes)
    image_cost = 0.0 if math.isnan(cosine) else _ALIKE - cosine
    return mismatch + class_cost + image_cost + 0.1 * math.hypot(horizontal, vertical)


def cost_nearby(target: Target, seen: Observation, classes: ClassHierarchy, most_m: float) -> float:
    """Return the cost of matching a thing that is hidden now with a new one in front of it.

    FORBIDDEN if it is farther away than `most_m`, or not of the same kind, size and colour.
    """
    like = (
        target.size_m is not None
        and distance_m(target.pose, seen.pose) <= most_m
        and classes.related(target.class_, seen.class_)
        and size_difference(target._replace(whole=True), structs.replace(seen, whole=True)) <= _OF_ANY_KIND
        and _is_of_like_color(target, seen)
    )
    return distance_m(target.pose, seen.pose) if like else FORBIDDEN


def _is_of_like_color(target: Target, seen: Observation) -> bool:
    """Return whether the colours of a thing and an observation may be of one thing, or are unknown."""
    if target.color_rgb is None or seen.color_rgb is None:
        return True
    return math.dist(target.color_rgb, seen.color_rgb) < _OTHER_COLOR


def cost_of_height(target: Target, seen: Observation, classes: ClassHierarchy) -> float:
    """Return the cost of matching a thing of the same kind and width that differs only in height.

    FORBIDDEN if it cannot match.
    """
    if target.size_m is None or not classes.related(target.class_, seen.class_):
        return FORBIDDEN
    (x, y, z), (u, v, w) = target.pose.position_m, seen.pose.position_m
    wide, now = _upright(target.size_m)[:2], _upright(seen.size_m)[:2]
    horizontal = math.hypot(u - x, v - y) / min(wide)
    as_wide = all(abs(math.log(b / a)) < _AS_WIDE for a, b in zip(wide, now, strict=True))
    return horizontal if as_wide and horizontal < _SAME_SPOT and abs(w - z) < _BLUR_M else FORBIDDEN


def size_difference(target: Target, seen: Observation) -> float:
    """Return the difference of extents: the mean of |log ratio|, or half the worst if that is more.

    The horizontal extents are sorted. A partly visible thing may be smaller. A single extent that is twice
    too large indicates a thing together with its neighbour.
    """
    if target.size_m is None:
        return 0.0
    pairs = zip(_upright(target.size_m), _upright(seen.size_m), strict=True)
    ratios = [math.log((now + _BLUR_M) / (before + _BLUR_M)) for before, now in pairs]
    shrunk, grown = (1.0 if whole else _HIDDEN_PART for whole in (seen.whole, target.whole))
    mismatch = [ratio * grown if ratio > 0.0 else -ratio * shrunk for ratio in ratios]
    return max(sum(mismatch) / 3.0, max(mismatch) / 2.0)


def class_difference(class_name: str, seen: Observation, classes: ClassHierarchy) -> float:
    """Return 0 for a class related to the observed one, up to 1 for an unlikely class."""
    if classes.related(class_name, seen.class_):
        return 0.0
    return max(0.0, 1.0 - sum(p for leaf, p in seen.candidates.items() if classes.is_a(leaf, class_name)))


def _upright(size_m: Size) -> tuple[float, float, float]:
    x, y, z = size_m
    return (min(x, y), max(x, y), z)


def _apart(pose: Pose, size_m: Size, seen: Observation) -> tuple[float, float]:
    """Return the distance of the centres, horizontally and vertically [m]."""
    (x, y, z), (u, v, w) = pose.position_m, seen.pose.position_m
    return math.hypot(u - x, v - y), abs(w + seen.size_m[2] / 2.0 - z - size_m[2] / 2.0)
