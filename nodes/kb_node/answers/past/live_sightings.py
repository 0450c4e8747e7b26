"""Where an entity was last seen by its live poses: by the newest, or by the last one in its trail."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from msgspec import structs

from semmap.nodes.kb_node.answers.past.trails import Trails, describe_age
from semmap.schemas import wording
from semmap.schemas.entities import Pose
from semmap.schemas.replies import Sighting

_FEW: Final = 5


def set_live_pose(found: Sighting, pose: Pose, places: Sequence[str], now_ns: int) -> Sighting:
    """Return where an entity is by its live pose, in these places."""
    return structs.replace(found, pose=pose, seen_ns=now_ns, text=_describe("now", pose, places))


def set_last_pose(found: Sighting, trails: Trails, now_ns: int) -> Sighting:
    """Return where an entity was by its last stored live pose, if that is newer than what is found.

    A trail has positions only. The orientation therefore remains that of the last commit.
    """
    points = trails.points.get(found.name)
    if not points:
        return found
    last = points[-1]
    seen_ns = last.until_ns or now_ns
    if seen_ns <= max(found.provenance.stamp_ns, found.seen_ns or 0):
        return found
    pose = structs.replace(found.pose or Pose(position_m=last.at), position_m=last.at)
    when = "now" if last.until_ns is None else f"{describe_age(seen_ns, now_ns)} ago"
    return structs.replace(found, pose=pose, seen_ns=seen_ns, text=_describe(when, pose, last.places))


def _describe(when: str, pose: Pose, places: Sequence[str]) -> str:
    """Return `live now at (1.00, 2.00, 0.00) m in kitchen1`."""
    x, y, z = pose.position_m
    where = f" in {wording.few(places, _FEW)}" if places else ""
    return f"live {when} at ({x:.2f}, {y:.2f}, {z:.2f}) m{where}"
