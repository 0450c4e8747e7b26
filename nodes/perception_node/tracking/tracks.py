"""Tracks: pose, size and class of each thing over frames."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from msgspec import structs

from semmap.nodes.perception_node.config import TrackingConfig
from semmap.nodes.perception_node.tracking.class_hierarchy import ANYTHING
from semmap.nodes.perception_node.tracking.fits import KnownFit
from semmap.nodes.perception_node.tracking.fronts import is_front
from semmap.nodes.perception_node.tracking.occupancy import Occupancy
from semmap.nodes.perception_node.tracking.overlap import OrientedBox, share
from semmap.nodes.perception_node.tracking.votes import Votes
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.schemas.entities import Pose, Size, Vector, distance_m, orientation_from_yaw
from semmap.schemas.perception import Observation

_RELATIVE = 0.05
"""Error of a large box's pose as a share of its size."""
_A_PART = 0.3
_POINTS, _LEAST_WEIGHT = 1000, 0.25
"""An observation of `_POINTS` points has the weight of one vote."""
_CUT = 0.5
_MISS, _MOST_MISSED = 2, 10
"""Weight of a frame without a new thing against one with it, and the maximum weight that is left of them."""
_MEMORY = 20
"""Number of frames of a running mean."""


@dataclass(frozen=True)
class Track:
    """The observations of one thing: `pose` is their mean since it came to rest, `size_m` of their sizes.

    Weights of the means: `placed` and `sized`; `sized_as` is the class at the last size.

    Counters:

    - `frames`: observations since it rests.
    - `whole_frames`: those of them that showed it completely.
    - `occupied`: frames in which its place was filled but it was not recognised.
    - `unseen`: consecutive frames in which it should have been visible.
    - `odd`: consecutive frames with a thing of another size in its place.
    - `absent`: frames since it or its filled place was last seen.
    - `sighted`, `missed`: frames in which it was observed, and those in which it was not though its place is
      visible, before it is an entity.

    State: `whole`: it was seen completely. `map_pose`: the map's pose at the last frame. `left`: that place
    is seen empty. `kept`: the part of it that would be left is filled. `part`: the map has a size that an
    image edge cuts. `outsized`: the map's size is too large. `fit`: the fitted model since it rests.
    `rejected_class`: the class that a fit rejected. `label`: the label of a detector that is not a class.
    `labels`: the votes of frames in which a detector labelled the thing, "" for a class. `color_rgb`: its
    mean colour when it was last seen, and `image` (FEATURES,) the features of its image, if known.
    """

    pose: Pose
    size_m: Size
    votes: Votes = field(default_factory=Votes)
    sized: float = 0.0
    sized_as: str = ""
    placed: float = 0.0
    frames: int = 0
    whole_frames: int = 0
    occupied: int = 0
    unseen: int = 0
    odd: int = 0
    whole: bool = False
    map_pose: Pose | None = None
    left: bool = False
    kept: bool = False
    absent: int = 0
    part: bool = False
    outsized: bool = False
    fit: KnownFit | None = None
    rejected_class: str = ""
    label: str = ""
    labels: Votes = field(default_factory=Votes)
    sighted: int = 0
    missed: int = 0
    color_rgb: Vector | None = None
    image: Numbers | None = field(default=None, compare=False)

    @property
    def agreement(self) -> int:
        """Return the number of frames with it, less those without it, which count twice."""
        return self.sighted - _MISS * self.missed

    @property
    def reported_pose(self) -> Pose:
        """Return the pose for the map: oriented by the fitted model, or else the box."""
        if self.fit is None or self.fit.orientation_wxyz is None:
            return self.pose
        return Pose(position_m=self.pose.position_m, orientation_wxyz=self.fit.orientation_wxyz)

    def fitted(self, fit: KnownFit, *, rejected: bool) -> Track:
        """Return the track with a fit; `rejected`: the fit rejects the class."""
        if not rejected:
            return replace(self, fit=fit)
        return replace(self, fit=fit, rejected_class=fit.class_, votes=self.votes.moved(fit.class_, ANYTHING))

    def is_gone(self, config: TrackingConfig) -> bool:
        """Return whether the thing is no longer at its place."""
        return self.unseen >= config.gone_frames or self.odd >= config.odd_frames

    def is_nearly_odd(self, config: TrackingConfig) -> bool:
        """Return whether one more frame proves that a thing of another size is in its place."""
        return bool(self.sized) and self.odd + 1 >= config.odd_frames

    def see(self, seen: Observation, config: TrackingConfig) -> Track:
        """Return the track with one more observation."""
        seen_again = self._count_label(seen)._count(seen, config)
        return replace(
            seen_again,
            sighted=self.sighted + 1,
            missed=self.missed,
            color_rgb=seen.color_rgb or self.color_rgb,
            image=self.image,
        )

    def _count_label(self, seen: Observation) -> Track:
        """Return the track with the vote of a detector's label; a clear majority replaces the label."""
        if not (seen.labelled or seen.label):
            return self
        labels = self.labels.cast(seen.label, 1.0, _weight(seen))
        winner = labels.clear_winner
        return replace(self, labels=labels, label=self.label if winner is None else winner)

    def _count(self, seen: Observation, config: TrackingConfig) -> Track:
        """Return the track with pose, size and class of one more observation."""
        weight = _weight(seen)
        class_ = ANYTHING if seen.class_ == self.rejected_class else seen.class_
        votes = self.votes.cast(class_, seen.probability, weight)
        before, now = OrientedBox(self.pose, self.size_m), OrientedBox(seen.pose, seen.size_m)
        if self.whole and self.frames and is_front(before, now):
            return self._all_of_it(seen, votes)
        hidden = (not seen.whole and _is_part(seen, self, config.still_m)) or is_front(now, before)
        if self.whole and hidden:
            # a part of it, in its place
            return replace(self, votes=votes, frames=self.frames + 1, unseen=0, odd=0, absent=0)
        pose, size_m = turned_like(seen.pose, seen.size_m, self)
        near = self.frames > 0 and distance_m(pose, self.pose) <= slack_m(self.size_m, config.still_m)
        still = near and turn_between(self, pose) <= config.turned_rad
        return replace(
            self._sized(size_m, weight, seen),
            pose=_between_poses(self.pose, pose, weight / self._placed(weight)) if still else pose,
            placed=self._placed(weight) if still else weight,
            votes=votes,
            frames=self.frames + 1 if still else 1,
            whole_frames=self.whole_frames + 1 if still else 1,
            occupied=self.occupied if still else self.occupied + 1 if near else 0,
            unseen=0,
            odd=0,
            absent=0,
            fit=self.fit if still else None,
        )

    def see_all(self, seen: Observation, config: TrackingConfig) -> Track:
        """Return the track with a complete observation, though an image edge cuts it.

        The previous size was too large.
        """
        forgotten = replace(self, sized=0.0, placed=0.0, frames=0, whole=False, outsized=True)
        return forgotten.see(structs.replace(seen, whole=True), config)

    def miss(self, occupancy: Occupancy, *, odd: bool) -> Track:
        """Return the track without observation, given the occupancy of its place.

        `odd`: a thing of another size is there.
        """
        if occupancy == "unknown":
            return replace(self, absent=self.absent + 1)
        if occupancy == "free":
            return replace(self, unseen=self.unseen + 1, odd=0, absent=self.absent + 1)
        odd_frames = self.odd + 1 if odd else 0
        return replace(self, occupied=self.occupied + 1, unseen=0, odd=odd_frames, absent=0)

    def overlook(self, *, visible: bool) -> Track:
        """Return the track of a thing that is not an entity yet, in a frame without observation.

        `visible`: its place is in view.
        """
        missed = self.missed + visible
        missed = min(missed, (self.sighted + _MOST_MISSED) // _MISS)
        return replace(self.miss("free", odd=False), missed=missed)

    def rests(self, frames: int) -> bool:
        """Return whether it was visible at its place and has been there for this many frames."""
        return self.frames > 0 and self.frames + self.occupied >= frames and not self.unseen and not self.odd

    def _sized(self, size_m: Size, weight: float, seen: Observation) -> Track:
        """Update the size; an observation of the complete thing replaces partial ones."""
        if self.whole and not seen.whole:
            return self
        sized = weight
        if self.sized and self.whole == seen.whole:
            sized = min(self.sized, _MEMORY * weight) + weight
            size_m = _between(self.size_m, size_m, weight / sized)
        return replace(self, size_m=size_m, sized=sized, sized_as=seen.class_, whole=seen.whole)

    def _placed(self, weight: float) -> float:
        """Return the weight of the pose with one more observation, limited."""
        return min(self.placed, _MEMORY * weight) + weight

    def _all_of_it(self, seen: Observation, votes: Votes) -> Track:
        """Return the track when more than its front is visible."""
        weight = _weight(seen)
        again = Track(seen.pose, seen.size_m, votes, sized=weight, placed=weight, frames=1, whole_frames=1)
        return replace(
            again,
            sized_as=seen.class_,
            whole=True,
            map_pose=self.map_pose,
            part=self.part,
            rejected_class=self.rejected_class,
            label=self.label,
            labels=self.labels,
        )


@dataclass(frozen=True)
class Tracks:
    """All tracks: `known` by entity name, `tentative` before they become entities.

    `names` are all names that perception has given; none is reused.
    """

    known: Mapping[str, Track] = field(default_factory=dict)
    tentative: tuple[Track, ...] = ()
    names: frozenset[str] = frozenset()


def slack_m(size_m: Size, least_m: float) -> float:
    """Return how far a box of this size may seem to move without having moved [m]."""
    return max(least_m, _RELATIVE * max(size_m))


def _between_poses(start: Pose, end: Pose, share: float) -> Pose:
    yaw = start.yaw_rad + share * _wrapped(end.yaw_rad - start.yaw_rad)
    position = _between(start.position_m, end.position_m, share)
    return Pose(position_m=position, orientation_wxyz=orientation_from_yaw(yaw))


def turned_like(pose: Pose, size_m: Size, track: Track) -> tuple[Pose, Size]:
    """Return the box with the quarter turn that best matches the track: a box has no front."""
    x, y, z = size_m

    def mismatch(quarter: int) -> float:
        turn = _wrapped(pose.yaw_rad + quarter * math.pi / 2.0 - track.pose.yaw_rad)
        width = y if quarter % 2 else x
        return abs(turn) / math.pi + abs(math.log(width / track.size_m[0]))

    quarter = min(range(4), key=mismatch)
    orientation = orientation_from_yaw(pose.yaw_rad + quarter * math.pi / 2.0)
    turned: Size = (y, x, z) if quarter % 2 else size_m
    return Pose(position_m=pose.position_m, orientation_wxyz=orientation), turned


def turn_between(track: Track, pose: Pose) -> float:
    """Return the angle [rad] from a pose to the track's; 0 for things with a nearly square footprint."""
    x, y, _ = track.size_m
    if max(x, y) < 1.3 * min(x, y):
        return 0.0
    turn = abs(_wrapped(track.pose.yaw_rad - pose.yaw_rad))
    return min(turn, math.pi - turn)


def _weight(seen: Observation) -> float:
    """Return the weight of an observation: more if near, less if partial."""
    near = min(max(math.sqrt(seen.points / _POINTS), _LEAST_WEIGHT), 1.0 / _LEAST_WEIGHT)
    return near if seen.whole else _CUT * near


def _is_part(seen: Observation, track: Track, margin_m: float) -> bool:
    """Return whether a cut observation is of a thing that did not move: the boxes overlap substantially."""
    now, before = OrientedBox(seen.pose, seen.size_m), OrientedBox(track.pose, track.size_m)
    return _within(seen, track, margin_m) or max(share(now, before), share(before, now)) > _A_PART


def _within(seen: Observation, track: Track, margin_m: float) -> bool:
    reach = max(track.size_m[:2]) / 2.0 + margin_m
    low, high = track.pose.position_m[2], track.pose.position_m[2] + track.size_m[2]
    z = seen.pose.position_m[2]
    return (
        math.dist(seen.pose.position_m[:2], track.pose.position_m[:2]) + max(seen.size_m[:2]) / 2.0 <= reach
        and low - margin_m <= z
        and z + seen.size_m[2] <= high + margin_m
    )


def _between(start: Vector, end: Vector, share: float) -> Vector:
    x, y, z = (a + share * (b - a) for a, b in zip(start, end, strict=True))
    return (x, y, z)


def _wrapped(angle_rad: float) -> float:
    return math.remainder(angle_rad, 2.0 * math.pi)
