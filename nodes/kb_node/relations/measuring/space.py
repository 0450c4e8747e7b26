"""All solids of a map and their spatial relations, as a function of current poses and shapes only."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Final, NamedTuple

from semmap.nodes.kb_node.progress import split_batches
from semmap.nodes.kb_node.relations.geometry.columns import solids_of
from semmap.nodes.kb_node.relations.geometry.forms import Bounds
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity, holder_in
from semmap.nodes.kb_node.relations.geometry.solids import Solid, solid_of
from semmap.nodes.kb_node.relations.measuring import containment, measures, places, proximity, support_contact
from semmap.nodes.kb_node.relations.measuring.broad_phase import add_to_grid, find_nearby
from semmap.nodes.kb_node.relations.measuring.containment import may_be_inside
from semmap.nodes.kb_node.relations.measuring.grid import Grid
from semmap.nodes.kb_node.relations.measuring.measures import Measure
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.schemas.entities import Entity

Found = tuple[Solid, Measure]
_STEP = 2000
"""Entities per step."""
MANY: Final = 100
"""From this number on, solids are added and relations computed in arrays. Fewer are faster one by one."""

_MOUNTED_M = 0.01
"""The greatest gap between a fixed object and its support."""


class SpatialRelations(NamedTuple):
    """What an object is inside, what it is on, and its place. What it is inside, it is not on."""

    container: Found | None
    supports: tuple[Found, ...]
    """Several if the object bridges or leans. The most important one comes first."""
    place: Found | None

    @property
    def supporters(self) -> list[Solid]:
        """Return the container, if any, and the supports."""
        return [solid for solid, _ in (*filter(None, (self.container,)), *self.supports)]


class Space:
    """The solids of a map in a spatial index."""

    def __init__(
        self, entities: Iterable[Entity | PlacedEntity] = (), limits: Thresholds | None = None
    ) -> None:
        self.limits = limits or Thresholds()
        self.solids: dict[str, Solid] = {}
        self.grid: Final = Grid()
        self._raised: set[str] = set()
        """The objects above the floor or with a size of their own."""
        self.holders: Final[dict[str, str]] = {}
        """Attached objects and their holders. Only a tray that is itself carried can also support them."""
        self.cache: SpaceCache | None = None
        """Results that stay valid while `caching`."""
        for _ in self.put_all(entities):
            pass

    def put_all(self, entities: Iterable[Entity | PlacedEntity]) -> Iterator[list[Solid]]:
        """Add or replace many entities in steps, and yield the solids of each step."""
        for some in split_batches(entities, _STEP, _ignore_progress):
            if len(some) < MANY:
                yield [solid for entity in some if (solid := self.put(entity)) is not None]
                continue
            newest = {entity.name: entity for entity in some}
            for name in newest.keys() & self.solids.keys() if self.solids else ():
                self.remove(name)
            self.holders.update((name, by) for name, entity in newest.items() if (by := holder_in(entity)))
            solids = solids_of(newest.values())
            self.solids.update((solid.name, solid) for solid in solids)
            add_to_grid(self.grid, solids)
            self._raised.update(
                solid.name
                for solid in solids
                if not solid.is_place and (solid.position[2] != 0.0 or newest[solid.name].size_m is not None)
            )
            yield solids

    def put(self, entity: Entity | PlacedEntity) -> Solid | None:
        """Add or replace an entity. Returns its solid, or None without a position."""
        solid = solid_of(entity, self.remove(entity.name))
        if solid is not None:
            self._add(solid)
            if by := holder_in(entity):
                self.holders[solid.name] = by
            if not solid.is_place and (solid.position[2] != 0.0 or entity.size_m is not None):
                self._raised.add(solid.name)
        return solid

    @property
    def is_flat(self) -> bool:
        """Return whether no object has a height or size of its own.

        Such a plan says nothing about supports.
        """
        return not self._raised

    def remove(self, name: str) -> Solid | None:
        """Remove an entity and return its solid, or None if it is not there."""
        solid = self.solids.pop(name, None)
        if solid is not None:
            self.grid.remove(solid)
            self._raised.discard(name)
            self.holders.pop(name, None)
        return solid

    @contextmanager
    def with_changes(
        self, entities: Iterable[Entity | PlacedEntity], without: Iterable[str] = ()
    ) -> Iterator[None]:
        """Apply changes for the duration of a `with`: these entities as given, `without` removed."""
        entities, without = tuple(entities), tuple(without)
        names = {*(entity.name for entity in entities), *without}
        before = [solid for name in names if (solid := self.solids.get(name)) is not None]
        raised = self._raised & names
        holders = {name: self.holders[name] for name in names & self.holders.keys()}
        try:
            for name in without:
                self.remove(name)
            for entity in entities:
                self.put(entity)
            yield
        finally:
            for name in names:
                self.remove(name)
            for solid in before:
                self._add(solid)
            self._raised |= raised
            self.holders.update(holders)
            self.pop_shifted()

    def pop_shifted(self) -> list[Solid]:
        """Return the solids that started or stopped being counted since the last call."""
        grid = self.grid
        if not grid.shifted:
            return []
        found = list(grid.shifted)
        grid.shifted.clear()
        return found

    def _add(self, solid: Solid) -> None:
        self.solids[solid.name] = solid
        self.grid.add(solid)

    def around(self, solid: Solid, margin_m: float = 0.0) -> list[Solid]:
        """Return the solids whose bounds meet those of `solid` or are within a margin."""
        widest_m = self.limits.attached_m
        if self.cache is None or self.cache.around is None or margin_m > widest_m:
            return self.grid.around(solid.bounds, margin_m, solid)
        around = self.cache.around.get(solid)
        if around is None:
            around = self.cache.around[solid] = self.grid.around(solid.bounds, widest_m, solid)
        if margin_m == widest_m:
            return around
        return [other for other in around if measures.overlap(solid.bounds, other.bounds, margin_m)]

    def counted_around(self, solid: Solid, margin_m: float = 0.0) -> list[Solid]:
        """Return those that are considered as neighbours: in a crowd the largest."""
        if not self.grid.crowds:
            return self.around(solid, margin_m)
        return [other for other in self.grid.counted_around(solid.bounds, margin_m) if other is not solid]

    def supporters_around(self, solid: Solid, margin_m: float = 0.0) -> list[Solid]:
        """Return those that may support or contain `solid`. If it is not counted, only larger ones may."""
        if not self.grid.crowds:
            return self.around(solid, margin_m)
        around = self.counted_around(solid, margin_m)
        if self.grid.counts(solid):
            return around
        return [other for other in around if other.is_place or other.volume > solid.volume]

    def counts(self, solid: Solid) -> bool:
        """Return whether a solid is considered as a neighbour."""
        return self.grid.counts(solid)

    def is_crowded(self, solid: Solid) -> bool:
        """Return whether not all solids around this one are considered."""
        return self.grid.is_crowded(solid)

    def find_nearby(self, solids: Sequence[Solid], margin_m: float) -> Iterable[Solid]:
        """Return the solids that may be within a margin of many, possibly more."""
        return find_nearby(self.grid, solids, margin_m) or self.solids.values()

    def describe_crowds(self, names: Collection[str] | None = None) -> list[str]:
        """Return a notice for each crowd, the largest first, or only for crowds with one of `names`."""
        return self.grid.describe_crowds(names)

    def find_within(self, bounds: Bounds) -> list[Solid]:
        """Return the solids whose bounds intersect `bounds`."""
        return self.grid.around(bounds)

    def caching(self, *, of_few: bool = False) -> SpaceCache:
        """Return a context in which the space does not change and results are cached.

        With `of_few`, the neighbours of each solid are cached, too.
        """
        return SpaceCache(self, of_few=of_few)

    def spatial_relations(self, solid: Solid) -> SpatialRelations:
        """Return the smallest hollow around a solid, the nearest surface below it, and the smallest place."""
        if self.cache is None:
            return self._compute_spatial_relations(solid)
        known = self.cache.spatial_relations.get(solid.name)
        if known is None:
            known = self.cache.spatial_relations[solid.name] = self._compute_spatial_relations(solid)
        return known

    def _compute_spatial_relations(self, solid: Solid) -> SpatialRelations:
        limits = self.limits
        container: Found | None = None
        place: Found | None = None
        below: list[Found] = []
        least = solid.bottom - limits.gap_m - 1e-6
        for other in self.supporters_around(solid):
            if other.is_place:
                made = places.within(solid, other, limits)
                if made and made.holds and (place is None or _area(other) < _area(place[0])):
                    place = (other, made)
                continue
            if other.top < least or not self._may_support_attached(other, solid):
                continue
            if (solid.is_fixed or other.form.hollow_bounds) and may_be_inside(solid, other, limits):
                made = containment.inside(solid, other, limits)
                if made and made.holds and (container is None or _volume(other) < _volume(container[0])):
                    container = (other, made)
            made = support_contact.on(solid, other, limits)
            if made is not None:
                below.append((other, made))
        if solid.is_fixed and below:
            below = self._select_fixed_supports(solid, below, place and place[0])
        floor = None if place is None else solid.bottom - place[0].bottom
        return SpatialRelations(
            container, self._supports(solid, below, container, floor) if below else (), place
        )

    def may_support(self, support: Solid, solid: Solid) -> bool:
        """Return whether one solid contains another or touches it from above.

        If not, it is not one of its supports. `spatial_relations` compares with all solids around.
        """
        if solid.is_place or support.top < solid.bottom - self.limits.gap_m:
            return False
        if not self._may_support_attached(support, solid):
            return False
        if (solid.is_fixed or support.hollows) and self._is_within(solid, support):
            return True
        made = support_contact.on(solid, support, self.limits)
        return made is not None and made.holds

    def _may_support_attached(self, support: Solid, solid: Solid) -> bool:
        """Return whether a solid may support an attached one: a carried tray supports what moves with it.

        So do other objects that move with the tray. An example is a bowl on the tray that holds an apple.
        """
        if not self.holders or (holder := self.holders.get(solid.name)) is None:
            return True
        return holder in self.holders and holder in (support.name, self.holders.get(support.name))

    def _supports(
        self, solid: Solid, below: list[Found], container: Found | None, floor_m: float | None
    ) -> tuple[Found, ...]:
        """Return the supports among the candidates `below`: the nearest, and those level with it.

        - Distances are compared to the centimetre, and of equal ones the highest counts.
        - The floor of the place, `floor_m` below the solid, and what it leans on are candidates, too.
        - The supports of a contained solid are in the same container.
        - The supports of a solid in a tray are not below the tray.
        - A solid without any of these rests on what it leans on.
        """
        limits = self.limits
        if container is not None:
            below = [found for found in below if self._is_within(found[0], container[0])]
        leaning = [found for found in below if not found[1].holds]
        gaps = [made.gap_m for _, made in leaning]
        below = [found for found in below if found[1].holds and not self._is_below(solid, *found)]
        on_floor = floor_m is not None and abs(floor_m) <= limits.gap_m
        trays = [
            made.height_m for other, made in below if support_contact.is_in_open_hollow(other, solid, made)
        ]
        if trays:
            lowest = max(trays) - limits.contact_m
            below = [found for found in below if found[1].height_m >= lowest]
            on_floor = on_floor and floor_m is not None and solid.bottom - floor_m >= lowest
        if not below:
            least = min((side.bottom for side, _ in leaning), default=math.inf)
            may_stand = on_floor or (floor_m is None and solid.bottom <= least + limits.gap_m)
            return () if may_stand else tuple(sorted(map(_support_by_leaning, leaning), key=_by_name))
        gaps += [made.gap_m for _, made in below]
        if floor_m is not None and on_floor:
            gaps.append(floor_m)
        nearest = gaps[0] if len(gaps) == 1 else min(gaps, key=_nearness)
        level = [found for found in below if abs(found[1].gap_m - nearest) <= limits.contact_m]
        if sum(made.share for _, made in level) < limits.base_share and not support_contact.is_balanced(
            solid, [other for other, _ in level], solid.bottom - nearest
        ):
            return ()
        return tuple(sorted(level, key=lambda found: (-found[1].share, found[0].name)))

    def may_hold(self, other: Solid, solid: Solid) -> bool:
        """Return whether a solid may hold another one: a fixed one hangs on no object that hangs itself."""
        if not solid.is_fixed or other.is_fixed:
            return True
        place = self.spatial_relations(solid).place
        return _stands_in(other, place and place[0], self.limits)

    def _select_fixed_supports(self, solid: Solid, below: list[Found], place: Solid | None) -> list[Found]:
        """Return the supports of a fixed solid, which is mounted and does not settle.

        A wall or the ceiling holds it first. Otherwise it is on a fixed or standing solid at exactly its
        height.
        """
        limits = self.limits
        if place is not None and abs(place.top - solid.top) <= limits.gap_m:
            return []
        may_hold = [
            (other, made)
            for other, made in below
            if abs(made.gap_m) <= _MOUNTED_M and (other.is_fixed or _stands_in(other, place, limits))
        ]
        for other in self.supporters_around(solid, limits.attached_m):
            made = proximity.against(solid, other, limits)
            if made is None or not made.holds or any(other is support for support, _ in may_hold):
                continue
            if other.is_fixed or _stands_in(other, place, limits):
                return []
        return may_hold

    def _is_within(self, solid: Solid, container: Solid) -> bool:
        made = containment.inside(solid, container, self.limits)
        return made is not None and made.holds

    def _is_below(self, solid: Solid, other: Solid, made: Measure) -> bool:
        """Return whether `other` rests on `solid` instead, as with objects that interlock."""
        if other.bottom < solid.bottom - self.limits.contact_m:
            return False
        back = support_contact.on(other, solid, self.limits)
        return (
            back is not None and back.holds and (abs(back.gap_m), solid.name) < (abs(made.gap_m), other.name)
        )


class SpaceCache:
    """Cached results of a space that does not change, for use in a `with`."""

    __slots__ = ("_space", "around", "spatial_relations")

    def __init__(self, space: Space, *, of_few: bool) -> None:
        """Create an empty cache."""
        self._space = space
        self.spatial_relations: dict[str, SpatialRelations] = {}
        """By name."""
        self.around: dict[Solid, list[Solid]] | None = {} if of_few else None
        """The solids within the margin of attachments. For many solids this would take too much memory."""

    def __enter__(self) -> None:
        self._space.cache = self

    def __exit__(self, *_: object) -> None:
        self._space.cache = None


def _stands_in(solid: Solid, place: Solid | None, limits: Thresholds) -> bool:
    """Return whether a solid stands on the floor of a place. Without a place its floor is unknown."""
    return place is None or abs(solid.bottom - place.bottom) <= limits.gap_m


def _ignore_progress() -> None:
    pass


def _area(solid: Solid) -> tuple[float, str]:
    return (solid.footprint, solid.name)


def _volume(solid: Solid) -> tuple[float, str]:
    return (solid.volume, solid.name)


def _support_by_leaning(leaning: Found) -> Found:
    """Return a support by steep sides only, with no share of the base."""
    side, made = leaning
    return side, made._replace(holds=True, share=0.0)


def _by_name(found: Found) -> str:
    return found[0].name


def _nearness(gap_m: float) -> tuple[float, float]:
    return (round(abs(gap_m), 2), gap_m)
