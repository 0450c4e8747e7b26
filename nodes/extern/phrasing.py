"""Texts for parts of replies, in the terminal and on the page."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Mapping

from semmap.schemas import agents, changes
from semmap.schemas.changes import Change
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity, Pose, Provenance, distance_m
from semmap.schemas.joints import OPENING, SWITCHING
from semmap.schemas.replies import LoggedCommit

_STILL_M = 0.005
_NOTED_M = 0.95
"""Distances from this value are in metres, shorter ones in centimetres."""


def pose_cells(pose: Pose | None) -> tuple[str, str, str, str]:
    """Return x, y, z [m] and yaw [degrees] as texts."""
    if pose is None:
        return ("-", "-", "-", "-")
    x, y, z = (plain(value, 3) for value in pose.position_m)
    return (x, y, z, plain(math.degrees(pose.yaw_rad), 0))


def pose_text(pose: Pose | None) -> str:
    """Return a pose as one line, with pitch and roll if it is tilted by at least half a degree."""
    if pose is None:
        return "none"
    x, y, z, yaw = pose_cells(pose)
    roll, pitch = (plain(math.degrees(angle), 0) for angle in pose.roll_pitch_rad)
    tilt = "" if {roll, pitch} == {"0"} else f", pitch {pitch}°, roll {roll}°"
    return f"({x}, {y}, {z}) m, yaw {yaw}°{tilt}"


def provenance_text(p: Provenance) -> str:
    """Return commit, time, author, reason and confidence as one line."""
    if p.commit == 0:
        return p.reason
    confidence = "" if p.confidence is None else f" (confidence {p.confidence:.2f})"
    return f"commit {p.commit}, {moment(p.stamp_ns)}, {author(p)}: {p.reason}{confidence}"


def author(p: Provenance | Commit | LoggedCommit) -> str:
    """Return source and agent: `@bob` if a certificate authenticated the name, else `bob`."""
    if not p.agent:
        return p.source
    proved = not isinstance(p, Provenance) and p.authenticated
    return f"{p.source}/{agents.proved(p.agent) if proved else p.agent}"


def moment(stamp_ns: int) -> str:
    """Return a local time in the format that `--as-of` accepts."""
    return time.strftime("%Y-%m-%dT%H:%M:%S", time.localtime(stamp_ns // 1_000_000_000))


def changed_in_short(was: Entity, now: Entity) -> str:
    """Return the change of an entity as a short label, such as `moved 1.2 m`; empty if nothing changed."""
    found = _drop_details(changes.between(was, now))
    if [change.kind for change in found] != ["pose"] or was.pose is None or now.pose is None:
        return changes.in_words(found)
    moved_m = distance_m(was.pose, now.pose)
    if moved_m < _STILL_M:
        return "turned"
    return f"moved {moved_m:.1f} m" if moved_m >= _NOTED_M else f"moved {round(moved_m * 100)} cm"


def _drop_details(found: Iterable[Change]) -> list[Change]:
    """Leave out joint positions and the like if a shorter property says the same, such as `isOpen`."""
    found = list(found)
    changed = {change.property_ for change in found}
    implied = {p for group in (OPENING, SWITCHING) for p in [name for name in group if name in changed][1:]}
    return [change for change in found if change.property_ not in implied]


def plain(value: float, digits: int) -> str:
    """Return a rounded number, never minus zero."""
    return f"{round(value, digits) + 0.0:.{digits}f}"


def size_text(e: Entity) -> str:
    """Return the size along the object's axes [m] with three digits; empty if unknown."""
    extents = e.size_m or ()
    return " x ".join(f"{extent:.3g}" if extent < 100 else f"{extent:.0f}" for extent in extents)


def labelled(name: str, label: str) -> str:
    """Return a name with its label, if that differs: `isOpen (is open)`."""
    return f"{name} ({label})" if label and label != name else name


def english(labels: Mapping[str, str]) -> str:
    """Return the English label, else one without a language, else any."""
    return labels.get("en") or labels.get("") or next(iter(labels.values()), "")
