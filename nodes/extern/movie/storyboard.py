"""What a movie shows when: a scene for each commit, in which things glide, come and go. Pure."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from datetime import datetime
from typing import Final

from msgspec import Struct

from semmap.nodes.extern.phrasing import author, changed_in_short
from semmap.nodes.runtime import playback_clock
from semmap.schemas import errors, wording
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity, Pose

GLIDE_S: Final = 0.6
"""How long a thing takes from where it was to where it is."""
LEAST_S: Final = 1.2
"""How long a commit is seen at least: its caption is to be read."""
FIRST_S: Final = 1.5
_LABELLED: Final = 8
"""Things whose labels are shown at once."""


class Scene(Struct, frozen=True, kw_only=True):
    """What a commit changes of what is to be seen, and for how long it is shown [s]."""

    seconds: float
    caption: str
    add: tuple[Entity, ...] = ()
    """Those that come, or are made anew in another shape."""
    remove: tuple[str, ...] = ()
    glide: tuple[tuple[str, Pose, Pose], ...] = ()
    """Name, from where and to where."""
    labels: dict[str, str] = {}
    """What is said of a thing, beside it."""


def scenes(
    start: Mapping[str, Entity],
    commits: Sequence[Commit],
    *,
    since: int,
    start_ns: int,
    speed: float = 1.0,
    longest_s: float = playback_clock.LONGEST_S,
) -> Iterator[Scene]:
    """The scenes of a movie: the map as it is at the start, by name, after commit `since`; then each commit.

    A scene is as long as it was until the next commit, divided by `speed`, and long enough to be read.
    """
    there = dict(start)
    stamps = [start_ns, *(commit.stamp_ns for commit in commits)]
    waits = [*playback_clock.waits_s(stamps, speed=speed, longest_s=longest_s), 0.0]
    yield Scene(
        seconds=max(waits[0], FIRST_S),
        caption=f"commit {since} · {_at(start_ns)} · how it was in the beginning",
        add=tuple(entity for entity in there.values() if is_seen(entity)),
    )
    for commit, wait_s in zip(commits, waits[1:], strict=True):
        yield _of_commit(commit, there, max(wait_s, LEAST_S))


def is_seen(entity: Entity) -> bool:
    """Has it a body? Places, and what is nowhere, have none."""
    return not entity.place and entity.pose is not None


def _of_commit(commit: Commit, there: dict[str, Entity], seconds: float) -> Scene:
    """The scene of a commit; `there` becomes what is there after it."""
    add, remove, glide, labels = [], [], [], dict[str, str]()
    for gone in commit.removed:
        if (was := there.pop(gone.name, None)) is not None and is_seen(was):
            remove.append(gone.name)
            labels[gone.name] = f"{gone.name} is removed"
    for entity in commit.changed:
        was = there.get(entity.name)
        there[entity.name] = entity
        if not is_seen(entity):
            if was is not None and is_seen(was):
                remove.append(entity.name)
            continue
        if was is None or was.pose is None or not is_seen(was):
            add.append(entity)
            labels[entity.name] = f"{entity.name} is added"
            continue
        if entity.pose is None:
            raise errors.InternalError(f"{entity.name} has no pose")
        if (was.model, was.size_m, was.fixed) != (entity.model, entity.size_m, entity.fixed):
            add.append(entity)
        elif was.pose != entity.pose:
            glide.append((entity.name, was.pose, entity.pose))
        if text := changed_in_short(was, entity):
            labels[entity.name] = f"{entity.name} {text}"
    return Scene(
        seconds=seconds,
        caption=caption(commit),
        add=tuple(add),
        remove=tuple(remove),
        glide=tuple(glide),
        labels=dict(list(labels.items())[:_LABELLED]),
    )


def caption(commit: Commit) -> str:
    """`commit 12 · 2026-11-23 00:44:31 · operator/cli: move cup1`."""
    what = commit.reason or wording.entities(len(commit.names))
    return f"commit {commit.seq} · {_at(commit.stamp_ns)} · {author(commit)}: {what}"


def _at(stamp_ns: int) -> str:
    return f"{datetime.fromtimestamp(stamp_ns // 1_000_000_000):%Y-%m-%d %H:%M:%S}"


def steps(scene: Scene, fps: int) -> Iterator[tuple[float, int]]:
    """The pictures of a scene: how far things have glided in each (0 to 1), and how many frames it stays.

    What goes is there until things have arrived.
    """
    frames = max(1, round(scene.seconds * fps))
    gliding = min(frames - 1, round(GLIDE_S * fps)) if scene.glide or scene.remove else 0
    if scene.glide:
        for frame in range(gliding):
            yield (1.0 - math.cos(math.pi * frame / max(1, gliding))) / 2.0, 1
    elif gliding:
        yield 0.0, gliding
    yield 1.0, frames - gliding


def between(was: Pose, now: Pose, share: float) -> Pose:
    """The pose when so much of the way is behind: straight, and turned the shorter way round."""
    at = tuple(a + share * (b - a) for a, b in zip(was.position_m, now.position_m, strict=True))
    p, q = was.orientation_wxyz, now.orientation_wxyz
    sign = 1.0 if sum(a * b for a, b in zip(p, q, strict=True)) >= 0.0 else -1.0
    mixed = [(1.0 - share) * a + sign * share * b for a, b in zip(p, q, strict=True)]
    length = math.sqrt(sum(value * value for value in mixed)) or 1.0
    w, x, y, z = (value / length for value in mixed)
    return Pose(position_m=(at[0], at[1], at[2]), orientation_wxyz=(w, x, y, z))


def total_s(board: Iterable[Scene]) -> float:
    """How long the movie is [s]."""
    return sum(scene.seconds for scene in board)
