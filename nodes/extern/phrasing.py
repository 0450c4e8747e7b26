"""How the parts of a reply are written for people: in the terminal and in the page alike."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping

from semmap.schemas import agents, changes
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity, Pose, Provenance, distance_m
from semmap.schemas.replies import LoggedCommit

_STILL_M = 0.005
_NOTED_M = 0.95
"""From here on a way is told in metres."""


def pose_cells(pose: Pose | None) -> tuple[str, str, str, str]:
    """x, y, z [m] and yaw [degrees]."""
    if pose is None:
        return ("-", "-", "-", "-")
    x, y, z = (plain(value, 3) for value in pose.position_m)
    return (x, y, z, plain(math.degrees(pose.yaw_rad), 0))


def pose_text(pose: Pose | None) -> str:
    """A pose in one line."""
    return "none" if pose is None else "({}, {}, {}) m, yaw {}°".format(*pose_cells(pose))


def provenance_text(p: Provenance) -> str:
    """Which commit, when, who, why and how sure, in one line."""
    if p.commit == 0:
        return p.reason
    sure = "" if p.confidence is None else f" (confidence {p.confidence:.2f})"
    return f"commit {p.commit}, {moment(p.stamp_ns)}, {author(p)}: {p.reason}{sure}"


def author(p: Provenance | Commit | LoggedCommit) -> str:
    """The source with the agent: `@bob` if a certificate has proved the name, `bob` if it was claimed."""
    if not p.agent:
        return p.source
    proved = not isinstance(p, Provenance) and p.authenticated
    return f"{p.source}/{agents.proved(p.agent) if proved else p.agent}"


def moment(stamp_ns: int) -> str:
    """A time, local, as `--as-of` takes it."""
    return time.strftime("%Y-%m-%dT%H:%M:%S", time.localtime(stamp_ns // 1_000_000_000))


def changed_in_short(was: Entity, now: Entity) -> str:
    """What became of an entity, as short as a label is: `moved 1.2 m`; nothing where it is the same."""
    found = changes.between(was, now)
    if [change.kind for change in found] != ["pose"] or was.pose is None or now.pose is None:
        return changes.in_words(found)
    moved_m = distance_m(was.pose, now.pose)
    if moved_m < _STILL_M:
        return "turned"
    return f"moved {moved_m:.1f} m" if moved_m >= _NOTED_M else f"moved {round(moved_m * 100)} cm"


def plain(value: float, digits: int) -> str:
    """Rounded, and never minus zero."""
    return f"{round(value, digits) + 0.0:.{digits}f}"


def size_text(e: Entity) -> str:
    """Extent along its own axes [m], to three digits; nothing where it is not known."""
    extents = e.size_m or ()
    return " x ".join(f"{extent:.3g}" if extent < 100 else f"{extent:.0f}" for extent in extents)


def labelled(name: str, label: str) -> str:
    """A name with its label, where that says more: `isOpen (is open)`."""
    return f"{name} ({label})" if label and label != name else name


def english(labels: Mapping[str, str]) -> str:
    """The English label, or one without a language, or else any."""
    return labels.get("en") or labels.get("") or next(iter(labels.values()), "")
