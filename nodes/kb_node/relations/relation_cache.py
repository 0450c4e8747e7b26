"""Spatial relations of a map, evaluated pair by pair to resolve descriptions in words."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Set
from typing import Final

from semmap.nodes.kb_node.relations.facts.pair_facts import are_near, measure_pair
from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import measures
from semmap.nodes.kb_node.relations.measuring.arrangement import (
    find_between,
    measure_attachment,
    stands_on_floor,
)
from semmap.nodes.kb_node.relations.measuring.relation_table import PAIR_RELATIONS
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.viewing import View, is_on_side
from semmap.nodes.kb_node.relations.selection import is_in, is_on
from semmap.nodes.kb_node.relations.support import find_contents, find_supporters
from semmap.schemas import errors
from semmap.schemas.relations import RelationName

_Measured = Callable[[Space, Solid, Solid, Set[Fact]], bool]


MOST_PAIRS: Final = 20_000
"""The most pairs that are compared for one description, because other requests wait meanwhile."""

_PAIRS_PER_BETWEEN: Final = 200
"""The cost of finding what is between two objects, in pairs."""


class RelationCache:
    """The current relations of a map, each measured on first use and then cached.

    Methods raise BadRequest after more than `MOST_PAIRS` pairs have been compared.
    """

    def __init__(self, space: Space, view: View | None = None, left_out: Set[Fact] = frozenset()) -> None:
        """Evaluate the relations in `space`.

        `view` is the viewpoint for left, right, in front and behind, if there is one. Facts in `left_out`
        do not count.
        """
        self._space: Final = space
        self._left_out: Final = left_out
        self._view: Final = view
        self._pairs = 0
        self._known: Final[dict[tuple[str, str, str], bool]] = {}
        self._between: Final[dict[tuple[str, str], frozenset[str]]] = {}

    @property
    def has_viewer(self) -> bool:
        """Return whether there is a viewpoint."""
        return self._view is not None

    def related(self, relation: RelationName, name: str, other: str) -> bool:
        """Return whether a relation holds for two entities, as in `list` and `relations`."""
        self._count()
        key = (relation, name, other)
        if key not in self._known:
            one, two = self._space.solids.get(name), self._space.solids.get(other)
            measured = _RELATIONS.get(relation)
            if one is None or two is None or one is two:
                self._known[key] = False
            elif measured is not None:
                self._known[key] = measured(self._space, one, two, self._left_out)
            else:
                view = self._require_view()
                self._known[key] = not self._is_support_pair(one, two) and is_on_side(
                    self._space, relation, one, two, view
                )
        return self._known[key]

    def _count(self, pairs: int = 1) -> None:
        self._pairs += pairs
        if self._pairs > MOST_PAIRS:
            raise errors.BadRequest(
                f"too many objects to compare (more than {MOST_PAIRS} pairs); name the class of the objects"
            )

    def _is_support_pair(self, one: Solid, two: Solid) -> bool:
        """Return whether one supports the other. A cup on a desk is not right of the desk."""
        return two in find_supporters(self._space, one) or one in find_supporters(self._space, two)

    def between(self, one: str, other: str) -> frozenset[str]:
        """Return the names of the objects between two objects."""
        key = (min(one, other), max(one, other))
        if key not in self._between:
            self._count(_PAIRS_PER_BETWEEN)
            pair = [solid for name in key if (solid := self._space.solids.get(name)) is not None]
            found = find_between(self._space, *pair) if len(pair) == 2 else []
            self._between[key] = frozenset(solid.name for solid in found)
        return self._between[key]

    def position(self, name: str) -> tuple[float, float, float] | None:
        """Return the bottom centre [m]."""
        solid = self._space.solids.get(name)
        return None if solid is None else solid.position

    def size(self, name: str) -> tuple[float, float, float] | None:
        """Return the extent along the object's own axes [m], or None if it is unknown."""
        solid = self._space.solids.get(name)
        return solid.size if solid is not None and solid.is_measured else None

    def distance(self, name: str, other: str) -> float:
        """Return the horizontal distance between two centres [m], infinite without a position."""
        one, two = self._space.solids.get(name), self._space.solids.get(other)
        return math.inf if one is None or two is None else math.dist(one.centre[:2], two.centre[:2])

    def distance_from_viewer(self, name: str) -> float:
        """Return the horizontal distance [m]. Raises BadRequest without a viewpoint."""
        solid = self._space.solids.get(name)
        return math.inf if solid is None else math.dist(solid.centre[:2], self._require_view().eyes[:2])

    def bearing(self, name: str) -> float:
        """Return the angle from the viewing direction, positive to the left [rad].

        Raises BadRequest without a viewpoint.
        """
        view, solid = self._require_view(), self._space.solids.get(name)
        if solid is None:
            return math.inf
        dx, dy = solid.centre[0] - view.eyes[0], solid.centre[1] - view.eyes[1]
        (fx, fy) = view.ahead
        return math.atan2(fx * dy - fy * dx, fx * dx + fy * dy)

    def holds_anything(self, name: str) -> bool:
        """Return whether anything is in or on an object, or in a place."""
        solid = self._space.solids.get(name)
        if solid is None:
            return False
        if solid.is_place:
            return any(self.related("isInside", other, name) for other in self._space.solids)
        return next(iter(find_contents(self._space, solid)), None) is not None

    def is_on_floor(self, name: str) -> bool:
        """Return whether an object stands on the floor of its place and in or on nothing else."""
        solid = self._space.solids.get(name)
        return solid is not None and stands_on_floor(self._space, solid)

    def spatial_relations(self, name: str) -> tuple[tuple[RelationName, str], ...]:
        """Return what an object is inside, what it is on, and its place, as far as they exist."""
        if (solid := self._space.solids.get(name)) is None:
            return ()
        container, supports, place = self._space.spatial_relations(solid)
        found: list[tuple[RelationName, str]] = []
        if container is not None:
            found.append(("isInside", container[0].name))
        if supports:
            found.append(("isOn", supports[0][0].name))
        if place is not None:
            found.append(("isLocatedIn", place[0].name))
        return tuple(found)

    def _require_view(self) -> View:
        if self._view is None:
            raise errors.BadRequest(
                "left, right, in front, behind and nearest require a viewpoint; add --from VIEWER or"
                " --from-pose X Y Z YAW"
            )
        return self._view


def _is_on(space: Space, one: Solid, other: Solid, left_out: Set[Fact]) -> bool:
    if is_on(space, one, frozenset((other.name,)), left_out):
        return True
    made = measure_attachment(space, one, other)
    return made is not None and made.holds


def _is_in(space: Space, one: Solid, other: Solid, left_out: Set[Fact]) -> bool:
    return is_in(space, one, frozenset((other.name,)), left_out)


def _is_near(space: Space, one: Solid, other: Solid, _: Set[Fact]) -> bool:
    return _may_be_near(space, one, other) and are_near(space, one, other)


def _is_next_to(space: Space, one: Solid, other: Solid, left_out: Set[Fact]) -> bool:
    return _may_be_near(space, one, other) and _NEXT_TO(space, one, other, left_out)


def _may_be_near(space: Space, one: Solid, other: Solid) -> bool:
    return measures.overlap(one.bounds, other.bounds, space.limits.near_most_m)


def _is_beside(relation: RelationName) -> _Measured:
    wanted = frozenset((relation,))

    def measured(space: Space, one: Solid, other: Solid, _: Set[Fact]) -> bool:
        return any(made.holds for _, made in measure_pair(space, one, other, wanted))

    return measured


_NEXT_TO: Final = _is_beside("isNextTo")
_RELATIONS: Final[Mapping[str, _Measured]] = {
    **{name: _is_beside(name) for name in PAIR_RELATIONS},
    "isOn": _is_on,
    "isInside": _is_in,
    "isLocatedIn": _is_in,
    "isNear": _is_near,
    "isNextTo": _is_next_to,
}
