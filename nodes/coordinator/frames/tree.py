"""The tree of frames: which is in which, and where. Knows no wire, no clock and no map."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

from semmap.schemas import errors
from semmap.schemas.entities import Pose, compose, relative, rounded
from semmap.schemas.frames import MAP, Frame, FrameSource

ORIGIN = Pose(position_m=(0.0, 0.0, 0.0))


class Link(NamedTuple):
    """How a frame is tied to its parent. Where `problem` says why it cannot be used, there may be no pose."""

    parent: str
    pose: Pose | None
    source: FrameSource
    age_s: float | None = None
    stale: bool = False
    problem: str = ""


class Tree:
    """Links are looked up one by one: nobody goes through a large map to place a single thing."""

    def __init__(self, find: Callable[[str], Link | None], names: Callable[[], Iterable[str]]) -> None:
        """`find(name)` is the link of a frame, None where there is none; `names()` are all there are."""
        self._find = find
        self._names = names

    def resolve(self, word: str) -> str:
        """The frame that is meant: of that name, or `robot1_gripper` where somebody writes `robot1/gripper`.

        Raises UnknownName with those that are near.
        """
        if self._is_there(word):
            return word
        underscored = word.replace("/", "_")
        if self._is_there(underscored):
            return underscored
        raise errors.UnknownName(
            f"nobody publishes a frame '{word}', and no entity or camera is called so"
            f"{errors.did_you_mean(word, (MAP, *self._names())) or '; see: semmap frames'}"
        )

    def map_pose(self, name: str) -> Pose:
        """Where a frame that is there is in the map's.

        Raises Refused where it, or one above it, is stale, nowhere, or in itself.
        """
        pose = ORIGIN
        for _, link in self._chain(name):
            if link.pose is None:
                raise errors.InternalError(f"a frame above {name} has no pose")
            pose = compose(link.pose, pose)
        return pose

    def is_missing(self, word: str) -> bool:
        """Does the frame that is meant, or one that it is in, not exist?"""
        try:
            for _, link in self._above(self.resolve(word)):
                if link is None:
                    return True
        except errors.UnknownName:
            return True
        except errors.Refused:
            return False
        return False

    def frames(self, word: str | None = None) -> Iterator[Frame]:
        """All frames, or one with those above it and those below it; parents come before their children.

        Raises UnknownName. A frame whose parents are missing, or in one another, comes last.
        """
        links = {name: link for name in self._names() if name != MAP and (link := self._find(name))}
        chosen = None if word is None else self._family(self.resolve(word), links)
        children: dict[str, list[str]] = {}
        for name in sorted(links):
            if chosen is None or name in chosen:
                children.setdefault(links[name].parent, []).append(name)
        told: set[str] = {MAP}
        yield Frame(name=MAP, parent="", source="map", pose=ORIGIN, map_pose=ORIGIN)
        waiting = [MAP]
        strays = (name for name in sorted(links) if chosen is None or name in chosen)
        while True:
            while waiting:
                above = waiting.pop()
                below = [name for name in children.get(above, ()) if name not in told]
                if above != MAP:
                    yield self._frame(above, links[above])
                told.update(below)
                waiting.extend(reversed(below))
            if (stray := next((name for name in strays if name not in told), None)) is None:
                return
            told.add(stray)
            waiting.append(stray)

    def _frame(self, name: str, link: Link) -> Frame:
        map_pose, problem = None, link.problem
        try:
            map_pose = rounded(self.map_pose(name))
        except errors.Refused as error:
            problem = problem or error.text
        return Frame(
            name=name,
            parent=link.parent,
            source=link.source,
            pose=None if link.pose is None else rounded(link.pose),
            map_pose=map_pose,
            age_s=None if link.age_s is None else round(link.age_s, 3),
            stale=link.stale,
            problem=problem,
        )

    def _family(self, name: str, links: dict[str, Link]) -> set[str]:
        """A frame, those that it is in, and those that are in it."""
        children: dict[str, list[str]] = {}
        for child, link in links.items():
            children.setdefault(link.parent, []).append(child)
        found, waiting = {name}, [name]
        while waiting:
            below = [child for child in children.get(waiting.pop(), ()) if child not in found]
            found.update(below)
            waiting += below
        above = links[name].parent if name in links else MAP
        while above in links and above not in found:
            found.add(above)
            above = links[above].parent
        return found

    def _is_there(self, name: str) -> bool:
        return name == MAP or self._find(name) is not None

    def _chain(self, name: str) -> Iterator[tuple[str, Link]]:
        """The links from a frame up to the map, all of which can be used. Raises Refused."""
        below = name
        for above, link in self._above(name):
            if link is None:
                raise errors.Refused(
                    f"{below} is in the frame '{above}', which nobody publishes"
                    f"{errors.did_you_mean(above, (MAP, *self._names()))}"
                )
            if link.problem or link.pose is None:
                raise errors.Refused(link.problem or f"{above} has no pose")
            yield above, link
            below = above

    def _above(self, name: str) -> Iterator[tuple[str, Link | None]]:
        """The links from a frame up to the map; None for the first that there is not. Raises Refused."""
        passed: dict[str, None] = {}
        while name != MAP:
            if name in passed:
                circle = [*passed][[*passed].index(name) :]
                raise errors.Refused(f"{describe_cycle([*circle, name])}, so none of them is anywhere")
            passed[name] = None
            link = self._find(name)
            yield name, link
            if link is None:
                return
            name = link.parent


def describe_cycle(circle: list[str]) -> str:
    """A cycle in words; the last of it is the first."""
    return f"frames are in one another in a cycle: {' in '.join(circle)}"


def pose_in_frame(frame: Pose, pose: Pose) -> Pose:
    """A pose of the map in a frame that is at `frame` in it."""
    return rounded(relative(pose, frame))
