"""What an agent may change: the limits, with the names of the map, and the checks of changes and actions."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from itertools import pairwise
from typing import Any, Final

from semmap.nodes.extern.client import Client
from semmap.nodes.extern.mcp import arguments as a
from semmap.nodes.extern.mcp import limits, queries
from semmap.nodes.extern.mcp.limits import Limits, Touched
from semmap.nodes.geometry.polygons import contains, distance
from semmap.schemas import commands, errors
from semmap.schemas.entities import ClassInfo, Entity
from semmap.schemas.plans import Plan, Point
from semmap.schemas.polygons import Polygon
from semmap.schemas.replies import Changed

_STEP_M: Final = 0.1
"""The distance of the points at which the path of a robot is checked [m]."""
_GAP_M: Final = 0.15
"""The distance from a permitted place that is permitted, too: half of a thick wall [m]."""


class Permissions:
    """The limits of one agent. They can be used from any thread."""

    def __init__(self, allowed: Limits) -> None:
        self._allowed = allowed
        self._resolved: Limits | None = None

    def resolve(self, client: Client) -> Limits:
        """Return the limits with the names of the map. Raises UnknownClass, UnknownName."""
        if self._resolved is None:
            self._resolved = _known(client, self._allowed)
        return self._resolved

    def require_change(self, client: Client, command: Any, tried: Changed) -> None:
        """Raise Refused for a change beyond the limits."""
        if len(tried.names) > a.MOST:
            raise errors.Refused(f"a change is limited to {a.MOST} entities; propose smaller changes")
        allowed = self.resolve(client)
        if allowed == Limits():
            return
        classes = client.classes()
        limits.require(allowed, [_touched(client, name, command, tried, classes) for name in tried.names])

    def require_action(self, client: Client, entity: Entity, path: Sequence[Point] = ()) -> None:
        """Raise Refused for an action on an entity beyond the limits, or along a path out of the places.

        Raises Busy if the path begins at an entity that moves and has no live pose.
        """
        allowed = self.resolve(client)
        if allowed == Limits():
            return
        places = frozenset(queries.placed(client, [entity]).get(entity.name, {}).get("in", []))
        own = Touched(
            name=entity.name, classes_before=frozenset(entity.types), places_before=places, is_gone=True
        )
        limits.require(allowed, [own])
        if not path or not allowed.places:
            return
        if entity.live is None and (moving := client.send(commands.Status(names=(entity.name,))).displaced):
            raise errors.Busy(f"{moving[0]}; its path can be checked when it stands", again_s=2.0)
        pose = entity.pose if entity.live is None else entity.live.pose
        start = () if pose is None else (pose.position_m[:2],)
        outside = find_outside((*start, *path), client.floorplan(), _within(client, allowed.places))
        if outside is not None:
            x, y = outside
            raise errors.Refused(
                f"the path of {entity.name} leads through ({x:.2f}, {y:.2f}), which is not in a place that"
                f" you may change: {errors.enumerated(sorted(allowed.places))}"
            )


def find_outside(path: Sequence[Point], plan: Plan, permitted: Collection[str]) -> Point | None:
    """Return a point of a path of straight lines that is outside the permitted places, or None.

    Places end at their walls: a point is permitted, too, within 0.15 m of a permitted place, such as in the
    gap between two rooms, and in a door that connects permitted places only.
    """
    areas = [Polygon(place.rings[0], place.rings[1:]) for place in plan.places if place.name in permitted]
    doors = [t.footprint for t in plan.things if t.door and t.connects and {*t.connects} <= {*permitted}]

    def is_permitted(point: Point) -> bool:
        return any(
            area.contains(point) or any(distance(ring, [point]) <= _GAP_M for ring in area.rings)
            for area in areas
        ) or any(len(door) > 2 and contains(door, point) for door in doors)

    return next((point for point in _sampled(path) if not is_permitted(point)), None)


def _within(client: Client, places: Collection[str]) -> frozenset[str]:
    """Return these places and those in them: a storey has no outline of its own, but its rooms have."""
    every = [entity for entity in client.list() if entity.place]
    parts = (
        name for name, where in queries.placed(client, every).items() if {*where.get("in", ())} & {*places}
    )
    return frozenset((*places, *parts))


def _sampled(path: Sequence[Point]) -> Iterator[Point]:
    """Yield points on a path, at most 0.1 m apart, with its corners."""
    yield from path[:1]
    for (x0, y0), (x1, y1) in pairwise(path):
        steps = max(1, math.ceil(math.dist((x0, y0), (x1, y1)) / _STEP_M))
        for step in range(1, steps + 1):
            yield x0 + (x1 - x0) * step / steps, y0 + (y1 - y0) * step / steps


def _touched(
    client: Client, name: str, command: Any, tried: Changed, classes: Iterable[ClassInfo]
) -> Touched:
    """Return an entity with its classes and places before and after a change, for the limits."""
    entity = _entity(client, name)
    before = frozenset() if entity is None else frozenset(entity.types)
    places = queries.placed(client, [entity]).get(name, {}).get("in", []) if entity is not None else []
    word = getattr(command, "class_", None)
    after = before if word is None else _with_ancestors(word, classes)
    is_gone = isinstance(command, commands.Remove)
    if isinstance(command, commands.Undo) and command.commit is not None:
        restored = _entity(client, name, as_of=command.commit - 1)
        after, is_gone = frozenset(() if restored is None else restored.types), restored is None
    return Touched(
        name=name,
        classes_before=before,
        classes_after=after,
        places_before=frozenset(places),
        places_after=limits.after(places, name, tried.follows, tried.no_longer_follows),
        is_new=entity is None,
        is_gone=is_gone,
    )


def _entity(client: Client, name: str, **fields: Any) -> Entity | None:
    """Return an entity, or None if the map has none of this name."""
    try:
        return client.get(name, **fields)
    except errors.UnknownName:
        return None


def _with_ancestors(word: str, classes: Iterable[ClassInfo]) -> frozenset[str]:
    key = word.rpartition(":")[2].casefold().replace("_", "")
    found = [info for info in classes if info.name.casefold().replace("_", "") == key]
    return frozenset(name for info in found for name in (info.name, *info.ancestors))


def _known(client: Client, allowed: Limits) -> Limits:
    """Return the limits with the names of the map. Raises UnknownClass, UnknownName."""
    if allowed == Limits():
        return allowed
    names = {info.name.casefold().replace("_", ""): info.name for info in client.classes()}
    places = {entity.name for entity in client.list() if entity.place}
    for word in sorted(allowed.places - places):
        raise errors.UnknownName(f"no place is named '{word}'{errors.did_you_mean(word, places)}")
    return Limits(classes=limits.resolve_classes(allowed.classes, names), places=allowed.places)
