"""Tracks: the pose, size and class of each thing, remembered from frame to frame."""

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
from semmap.schemas.entities import Pose, Size, Vector, distance_m, orientation_from_yaw
from semmap.schemas.perception import Observation

_RELATIVE = 0.05
"""The box of a big thing is known to this share of its size."""
_A_PART = 0.3
_POINTS, _LEAST_WEIGHT = 1000, 0.25
"""A look of so many points is worth one vote."""
_CUT = 0.5
_MEMORY = 20
"""How many looks a mean goes back."""


@dataclass(frozen=True)
class Track:
    """Observations tied to one thing: `pose` is their mean since it came to rest, `size_m` of their sizes.

    `placed` and `sized`: what the looks are worth of which these are the means; `sized_as`: what it was taken
    for in the last that told of its size. `looks` is how often it was seen since it rests, `whole_frames` how
    often of these as a whole, `occupied` how often its place was so since then although the thing was not
    told apart, `unseen` how often in a row it should have been seen since and was not, `odd` how often in a
    row something of another size was in its place. `whole`: it was seen unhidden, uncut. `absent`: looks
    since it or its place was last seen filled. `told` is the map's pose at the last look; `left`: that place
    is seen empty; `kept`: what it would have left of it is filled; `part`: the map was told of what a
    picture's edge cuts; `outsized`: it was told of more than there is. `fit`: what its class's model told of
    it since it came to rest; `unlike`: the class whose model it is not like at all.
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
    unlike: str = ""

    @property
    def reported_pose(self) -> Pose:
        """What the map is to be told: where it is, turned as its model, or else its box, is."""
        if self.fit is None or self.fit.orientation_wxyz is None:
            return self.pose
        return Pose(position_m=self.pose.position_m, orientation_wxyz=self.fit.orientation_wxyz)

    def fitted(self, fit: KnownFit, *, unlike: bool) -> Track:
        """With what its model told; `unlike`: that it is of another class, whatever looks say."""
        if not unlike:
            return replace(self, fit=fit)
        return replace(self, fit=fit, unlike=fit.class_, votes=self.votes.moved(fit.class_, ANYTHING))

    def is_gone(self, config: TrackingConfig) -> bool:
        """Whether it is sure that it is no longer where it was."""
        return self.unseen >= config.gone_frames or self.odd >= config.odd_frames

    def is_nearly_odd(self, config: TrackingConfig) -> bool:
        """Whether one look more makes sure that what is in its place is not of the size it had."""
        return bool(self.sized) and self.odd + 1 >= config.odd_frames

    def see(self, seen: Observation, config: TrackingConfig) -> Track:
        """One more observation of it."""
        worth = _weight(seen)
        said = ANYTHING if seen.class_ == self.unlike else seen.class_
        votes = self.votes.cast(said, seen.probability, worth)
        before, now = OrientedBox(self.pose, self.size_m), OrientedBox(seen.pose, seen.size_m)
        if self.whole and self.frames and is_front(before, now):
            return self._all_of_it(seen, votes)
        hidden = (not seen.whole and _is_part(seen, self, config.still_m)) or is_front(now, before)
        if self.whole and hidden:
            return replace(
                self, votes=votes, frames=self.frames + 1, unseen=0, odd=0, absent=0
            )  # a part, where it was
        pose, size_m = turned_like(seen.pose, seen.size_m, self)
        near = self.frames > 0 and distance_m(pose, self.pose) <= slack_m(self.size_m, config.still_m)
        still = near and turn_between(self, pose) <= config.turned_rad
        return replace(
            self._sized(size_m, worth, seen),
            pose=_between_poses(self.pose, pose, worth / self._placed(worth)) if still else pose,
            placed=self._placed(worth) if still else worth,
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
        """One more observation, of all of it, though a picture's edge cuts it: what was believed was more."""
        forgotten = replace(self, sized=0.0, placed=0.0, frames=0, whole=False, outsized=True)
        return forgotten.see(structs.replace(seen, whole=True), config)

    def miss(self, occupancy: Occupancy, *, odd: bool) -> Track:
        """It was not seen, and this is what is seen where it should be; `odd`: a thing of another size."""
        if occupancy == "unknown":
            return replace(self, absent=self.absent + 1)
        if occupancy == "free":
            return replace(self, unseen=self.unseen + 1, odd=0, absent=self.absent + 1)
        odd_frames = self.odd + 1 if odd else 0
        return replace(self, occupied=self.occupied + 1, unseen=0, odd=odd_frames, absent=0)

    def rests(self, frames: int) -> bool:
        """Whether it was seen where it is, and is there since so many looks."""
        return self.frames > 0 and self.frames + self.occupied >= frames and not self.unseen and not self.odd

    def _sized(self, size_m: Size, worth: float, seen: Observation) -> Track:
        """With one more look at its size; one at the whole of it is worth more than any at a part."""
        if self.whole and not seen.whole:
            return self
        sized = worth
        if self.sized and self.whole == seen.whole:
            sized = min(self.sized, _MEMORY * worth) + worth
            size_m = _between(self.size_m, size_m, worth / sized)
        return replace(self, size_m=size_m, sized=sized, sized_as=seen.class_, whole=seen.whole)

    def _placed(self, worth: float) -> float:
        """What the looks are worth that tell where it is, with one more; not too many of them."""
        return min(self.placed, _MEMORY * worth) + worth

    def _all_of_it(self, seen: Observation, votes: Votes) -> Track:
        """When more is seen of it than its front."""
        worth = _weight(seen)
        again = Track(seen.pose, seen.size_m, votes, sized=worth, placed=worth, frames=1, whole_frames=1)
        return replace(
            again,
            sized_as=seen.class_,
            whole=True,
            map_pose=self.map_pose,
            part=self.part,
            unlike=self.unlike,
        )


@dataclass(frozen=True)
class Tracks:
    """All that is remembered: `known` by the entity's name, `tentative` what is no entity yet.

    `names` were given to entities by perception: none is given twice.
    """

    known: Mapping[str, Track] = field(default_factory=dict)
    tentative: tuple[Track, ...] = ()
    names: frozenset[str] = frozenset()


def slack_m(size_m: Size, least_m: float) -> float:
    """How far a box of this size may seem to move without having moved [m]."""
    return max(least_m, _RELATIVE * max(size_m))


def _between_poses(start: Pose, end: Pose, share: float) -> Pose:
    yaw = start.yaw_rad + share * _wrapped(end.yaw_rad - start.yaw_rad)
    position = _between(start.position_m, end.position_m, share)
    return Pose(position_m=position, orientation_wxyz=orientation_from_yaw(yaw))


def turned_like(pose: Pose, size_m: Size, track: Track) -> tuple[Pose, Size]:
    """The same box described by the quarter turn that is most like the track's: a box has no front."""
    x, y, z = size_m

    def unlike(quarter: int) -> float:
        turn = _wrapped(pose.yaw_rad + quarter * math.pi / 2.0 - track.pose.yaw_rad)
        width = y if quarter % 2 else x
        return abs(turn) / math.pi + abs(math.log(width / track.size_m[0]))

    quarter = min(range(4), key=unlike)
    orientation = orientation_from_yaw(pose.yaw_rad + quarter * math.pi / 2.0)
    turned: Size = (y, x, z) if quarter % 2 else size_m
    return Pose(position_m=pose.position_m, orientation_wxyz=orientation), turned


def turn_between(track: Track, pose: Pose) -> float:
    """The angle [rad] from a pose to the track's; 0 for what looks the same from all sides."""
    x, y, _ = track.size_m
    if max(x, y) < 1.3 * min(x, y):
        return 0.0
    turn = abs(_wrapped(track.pose.yaw_rad - pose.yaw_rad))
    return min(turn, math.pi - turn)


def _weight(seen: Observation) -> float:
    """What a look's vote is worth: from near more than from afar, in part less than as a whole."""
    near = min(max(math.sqrt(seen.points / _POINTS), _LEAST_WEIGHT), 1.0 / _LEAST_WEIGHT)
    return near if seen.whole else _CUT * near


def _is_part(seen: Observation, track: Track, margin_m: float) -> bool:
    """Whether what a picture's edge cuts is of a thing that stays where it is: much of either is in both."""
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
