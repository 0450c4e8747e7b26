"""The tree of frames. Independent of Zenoh, clocks and the map."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

from semmap.schemas import errors
from semmap.schemas.entities import Pose, compose, relative, rounded
from semmap.schemas.frames import MAP, Frame, FrameSource

ORIGIN = Pose(position_m=(0.0, 0.0, 0.0))


class Link(NamedTuple):
    """The link of a frame to its parent. If `problem` says why it cannot be used, it may have no pose."""

    parent: str
    pose: Pose | None
    source: FrameSource
    age_s: float | None = None
    stale: bool = False
    problem: str = ""


class Tree:
    """Looks up links one by one, so that placing one object does not visit all of a large map."""

    def __init__(self, find: Callable[[str], Link | None], names: Callable[[], Iterable[str]]) -> None:
        """`find(name)` returns the link of a frame, or None; `names()` returns all frames."""
        self._find = find
        self._names = names

    def resolve(self, word: str) -> str:
        """Return the name of a frame; `robot1/gripper` is resolved to `robot1_gripper`.

        Raises UnknownName with similar names.
        """
        if self._is_there(word):
            return word
        underscored = word.replace("/", "_")
        if self._is_there(underscored):
            return underscored
        raise errors.UnknownName(
            f"unknown frame '{word}' (no publisher, entity or camera with this name)"
            f"{errors.did_you_mean(word, (MAP, *self._names())) or '; see: semmap frames'}"
        )

    def map_pose(self, name: str) -> Pose:
        """Return the pose of an existing frame in the map.

        Raises Refused if the frame or one above it is stale, has no pose, or is in a cycle.
        """
        pose = ORIGIN
        for _, link in self._chain(name):
            if link.pose is None:
                raise errors.InternalError(f"a frame above {name} has no pose")
            pose = compose(link.pose, pose)
        return pose

    def is_missing(self, word: str) -> bool:
        """Return whether a frame, or one above it, does not exist."""
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
        """Yield all frames, or one with its ancestors and descendants; parents come before their children.

        Frames whose parents are missing or in a cycle come last. Raises UnknownName.
        """
        links = {name: link for name in self._names() if name != MAP and (link := self._find(name))}
        chosen = None if word is None else self._family(self.resolve(word), links)
        children: dict[str, list[str]] = {}
        for name in sorted(links):
            if chosen is None or name in chosen:
                children.setdefault(links[name].parent, []).append(name)
        listed: set[str] = {MAP}
        yield Frame(name=MAP, parent="", source="map", pose=ORIGIN, map_pose=ORIGIN)
        waiting = [MAP]
        strays = (name for name in sorted(links) if chosen is None or name in chosen)
        while True:
            while waiting:
                above = waiting.pop()
                below = [name for name in children.get(above, ()) if name not in listed]
                if above != MAP:
                    yield self._frame(above, links[above])
                listed.update(below)
                waiting.extend(reversed(below))
            if (stray := next((name for name in strays if name not in listed), None)) is None:
                return
            listed.add(stray)
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
        """Return a frame, its ancestors and its descendants."""
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
        """Yield the links from a frame up to the map. Raises Refused if one cannot be used."""
        below = name
        for above, link in self._above(name):
            if link is None:
                raise errors.Refused(
                    f"{below} is in the unknown frame '{above}'"
                    f"{errors.did_you_mean(above, (MAP, *self._names()))}"
                )
            if link.problem or link.pose is None:
                raise errors.Refused(link.problem or f"{above} has no pose")
            yield above, link
            below = above

    def _above(self, name: str) -> Iterator[tuple[str, Link | None]]:
        """Yield the links from a frame up to the map, and None for a missing one. Raises Refused."""
        visited: dict[str, None] = {}
        while name != MAP:
            if name in visited:
                cycle = [*visited][[*visited].index(name) :]
                raise errors.Refused(f"{describe_cycle([*cycle, name])}, so none of them has a pose")
            visited[name] = None
            link = self._find(name)
            yield name, link
            if link is None:
                return
            name = link.parent


def describe_cycle(cycle: list[str]) -> str:
    """Return a cycle in words; the last frame is the first."""
    return f"the frames form a cycle: {' in '.join(cycle)}"


def pose_in_frame(frame: Pose, pose: Pose) -> Pose:
    """Return a pose of the map in the frame that is at `frame`."""
    return rounded(relative(pose, frame))
