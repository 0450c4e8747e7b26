"""All solids of a map and the relations between them: a function of poses and shapes, without a memory."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from nodes.kb_node.relations import measures
from nodes.kb_node.relations.grid import Grid
from nodes.kb_node.relations.measures import Measure
from nodes.kb_node.relations.placed import Placed
from nodes.kb_node.relations.solids import Solid, solid_of
from nodes.kb_node.relations.thresholds import Thresholds
from schemas.entities import Entity

Found = tuple[Solid, Measure]


class Whereabouts(NamedTuple):
    """What a thing is inside, what it is on, and in which place; what it is inside it is not on."""

    container: Found | None
    supports: tuple[Found, ...]
    """Several of what bridges or leans; the one that counts most first."""
    place: Found | None


class Space:
    """The solids of a map, found by where they are."""

    def __init__(self, entities: Iterable[Entity | Placed] = (), limits: Thresholds | None = None) -> None:
        self.limits = limits or Thresholds()
        self.solids: dict[str, Solid] = {}
        self._grid = Grid()
        for entity in entities:
            self.put(entity)

    def put(self, entity: Entity | Placed) -> Solid | None:
        """Add an entity, or have it where it is now; its solid, if it has a position."""
        self.take(entity.name)
        solid = solid_of(entity)
        if solid is not None:
            self.solids[solid.name] = solid
            self._grid.add(solid)
        return solid

    def take(self, name: str) -> None:
        """Take an entity out, if it is there."""
        solid = self.solids.pop(name, None)
        if solid is not None:
            self._grid.remove(solid)

    def around(self, solid: Solid, margin_m: float = 0.0) -> list[Solid]:
        """Whoever may be within a margin."""
        names = self._grid.around(solid.bounds, margin_m)
        names.pop(solid.name, None)
        return [self.solids[name] for name in names]

    def whereabouts(self, solid: Solid) -> Whereabouts:
        """The smallest hollow that it is in, the nearest surface below it, the smallest place around it."""
        limits = self.limits
        container: Found | None = None
        support: Found | None = None
        place: Found | None = None
        for other in self.around(solid):
            if other.is_place:
                made = measures.within(solid, other, limits)
                if made and made.holds and (place is None or _area(other) < _area(place[0])):
                    place = (other, made)
                continue
            made = measures.inside(solid, other, limits)
            if made and made.holds and (container is None or _volume(other) < _volume(container[0])):
                container = (other, made)
            if other.bottom < solid.bottom + limits.touch_m:
                made = measures.on(solid, other, limits)
                if made and made.holds and (support is None or _rank(other, made) > _rank(*support)):
                    support = (other, made)
        if support is not None and container is not None:
            support = None  # what lies in a bowl is not on the table, and not on the bowl
        return Whereabouts(container, (support,) if support else (), place)


def _area(solid: Solid) -> tuple[float, str]:
    return (solid.footprint, solid.name)


def _volume(solid: Solid) -> tuple[float, str]:
    return (solid.volume, solid.name)


def _rank(other: Solid, made: Measure) -> tuple[tuple[bool, float, float, float], str]:
    return (measures.preferred(made), other.name)
