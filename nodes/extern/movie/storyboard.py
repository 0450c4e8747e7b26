"""The storyboard of a video: one scene per commit, in which objects move, appear and disappear. Pure."""

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
from semmap.schemas.joints import select_joint_properties

GLIDE_S: Final = 0.6
"""The duration of the motion of an object [s]."""
LEAST_S: Final = 1.2
"""The minimum duration of a scene, so that its caption can be read [s]."""
FIRST_S: Final = 1.5
_LABELLED: Final = 8
"""The maximum number of labels in a scene."""


class Scene(Struct, frozen=True, kw_only=True):
    """The visible changes of a commit, and how long they are shown [s]."""

    seconds: float
    caption: str
    add: tuple[Entity, ...] = ()
    """The entities that appear, get a new shape, or move their joints."""
    remove: tuple[str, ...] = ()
    glide: tuple[tuple[str, Pose, Pose], ...] = ()
    """The moved entities: name, start and end."""
    labels: dict[str, str] = {}
    """The label of a changed entity, by name."""


def scenes(
    start: Mapping[str, Entity],
    commits: Sequence[Commit],
    *,
    since: int,
    start_ns: int,
    speed: float = 1.0,
    longest_s: float = playback_clock.LONGEST_S,
) -> Iterator[Scene]:
    """Yield the scenes of a video: the initial map, by name, after commit `since`; then each commit.

    A scene lasts until the next commit, divided by `speed`, but at least as long as reading takes.
    """
    there = dict(start)
    stamps = [start_ns, *(commit.stamp_ns for commit in commits)]
    waits = [*playback_clock.waits_s(stamps, speed=speed, longest_s=longest_s), 0.0]
    yield Scene(
        seconds=max(waits[0], FIRST_S),
        caption=f"commit {since} · {_format_time(start_ns)} · initial state",
        add=tuple(entity for entity in there.values() if has_body(entity)),
    )
    for commit, wait_s in zip(commits, waits[1:], strict=True):
        yield _commit_scene(commit, there, max(wait_s, LEAST_S))


def has_body(entity: Entity) -> bool:
    """Return whether an entity has a body: places and entities without a pose do not."""
    return not entity.place and entity.pose is not None


def _commit_scene(commit: Commit, there: dict[str, Entity], seconds: float) -> Scene:
    """Return the scene of a commit; `there` is updated to the entities after it."""
    add, remove, glide, labels = [], [], [], dict[str, str]()
    for gone in commit.removed:
        if (was := there.pop(gone.name, None)) is not None and has_body(was):
            remove.append(gone.name)
            labels[gone.name] = f"{gone.name} is removed"
    for entity in commit.changed:
        was = there.get(entity.name)
        there[entity.name] = entity
        if not has_body(entity):
            if was is not None and has_body(was):
                remove.append(entity.name)
            continue
        if was is None or was.pose is None or not has_body(was):
            add.append(entity)
            labels[entity.name] = f"{entity.name} is added"
            continue
        if entity.pose is None:
            raise errors.InternalError(f"{entity.name} has no pose")
        if _shape_of(was) != _shape_of(entity):
            add.append(entity)
        elif was.pose != entity.pose:
            glide.append((entity.name, was.pose, entity.pose))
        if text := changed_in_short(was, entity):
            labels[entity.name] = _printable(f"{entity.name} {text}")
    return Scene(
        seconds=seconds,
        caption=_printable(caption(commit)),
        add=tuple(add),
        remove=tuple(remove),
        glide=tuple(glide),
        labels=dict(list(labels.items())[:_LABELLED]),
    )


def _shape_of(entity: Entity) -> tuple[object, ...]:
    """Return what determines the shape of an entity's body, with its joints."""
    return entity.model, entity.size_m, entity.fixed, select_joint_properties(entity.properties)


def caption(commit: Commit) -> str:
    """Return a caption such as `commit 12 · 2026-11-23 00:44:31 · operator/cli: move cup1`."""
    what = commit.reason or wording.entities(len(commit.names))
    return f"commit {commit.seq} · {_format_time(commit.stamp_ns)} · {author(commit)}: {what}"


def _printable(text: str) -> str:
    """Replace arrows, which the font of images does not have."""
    return text.replace("→", "->")


def _format_time(stamp_ns: int) -> str:
    return f"{datetime.fromtimestamp(stamp_ns // 1_000_000_000):%Y-%m-%d %H:%M:%S}"


def steps(scene: Scene, fps: int) -> Iterator[tuple[float, int]]:
    """Yield the images of a scene: the fraction of the motion (0 to 1), and the number of frames.

    Removed objects are shown until the motion ends.
    """
    frames = max(1, round(scene.seconds * fps))
    gliding = min(frames - 1, round(GLIDE_S * fps)) if scene.glide or scene.remove else 0
    if scene.glide:
        for frame in range(gliding):
            yield (1.0 - math.cos(math.pi * frame / max(1, gliding))) / 2.0, 1
    elif gliding:
        yield 0.0, gliding
    yield 1.0, frames - gliding


def interpolate(was: Pose, now: Pose, share: float) -> Pose:
    """Interpolate between two poses: in a straight line, with the shorter rotation."""
    at = tuple(a + share * (b - a) for a, b in zip(was.position_m, now.position_m, strict=True))
    p, q = was.orientation_wxyz, now.orientation_wxyz
    sign = 1.0 if sum(a * b for a, b in zip(p, q, strict=True)) >= 0.0 else -1.0
    mixed = [(1.0 - share) * a + sign * share * b for a, b in zip(p, q, strict=True)]
    length = math.sqrt(sum(value * value for value in mixed)) or 1.0
    w, x, y, z = (value / length for value in mixed)
    return Pose(position_m=(at[0], at[1], at[2]), orientation_wxyz=(w, x, y, z))


def total_s(board: Iterable[Scene]) -> float:
    """Return the duration of the video [s]."""
    return sum(scene.seconds for scene in board)
