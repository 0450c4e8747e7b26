"""All solids of a map and the relations between them: a function of poses and shapes, without a memory."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Final, NamedTuple

from semmap.nodes.kb_node.progress import split_batches
from semmap.nodes.kb_node.relations.geometry.columns import solids_of
from semmap.nodes.kb_node.relations.geometry.forms import Bounds
from semmap.nodes.kb_node.relations.geometry.placed import Placed, holder_in
from semmap.nodes.kb_node.relations.geometry.solids import Solid, solid_of
from semmap.nodes.kb_node.relations.measuring import measures
from semmap.nodes.kb_node.relations.measuring.broad_phase import beside, file
from semmap.nodes.kb_node.relations.measuring.grid import Grid
from semmap.nodes.kb_node.relations.measuring.measures import Measure
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.schemas.entities import Entity

Found = tuple[Solid, Measure]
_STEP = 2000
"""Entities."""
MANY: Final = 100
"""So many are put, and worked out, in arrays; for fewer these take longer."""


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
        self.grid: Final = Grid()
        self._raised: set[str] = set()
        """The things that are above the floor or of a size of their own."""
        self.held: Final[dict[str, str]] = {}
        """What is grasped, and by what: nothing else bears it, but for a tray that is itself carried."""
        self.memory: Memory | None = None
        """What need not be worked out again, while `remembering`."""
        for _ in self.put_all(entities):
            pass

    def put_all(self, entities: Iterable[Entity | Placed]) -> Iterator[list[Solid]]:
        """`put` many, some thousand at a time; the solids of each step."""
        for some in split_batches(entities, _STEP, _nothing):
            if len(some) < MANY:
                yield [solid for entity in some if (solid := self.put(entity)) is not None]
                continue
            newest = {entity.name: entity for entity in some}
            for name in newest.keys() & self.solids.keys() if self.solids else ():
                self.take(name)
            self.held.update((name, by) for name, entity in newest.items() if (by := holder_in(entity)))
            solids = solids_of(newest.values())
            self.solids.update((solid.name, solid) for solid in solids)
            file(self.grid, solids)
            self._raised.update(
                solid.name
                for solid in solids
                if not solid.is_place and (solid.position[2] != 0.0 or newest[solid.name].size_m is not None)
            )
            yield solids

    def put(self, entity: Entity | Placed) -> Solid | None:
        """Add an entity, or have it where it is now; its solid, if it has a position."""
        solid = solid_of(entity, self.take(entity.name))
        if solid is not None:
            self._add(solid)
            if by := holder_in(entity):
                self.held[solid.name] = by
            if not solid.is_place and (solid.position[2] != 0.0 or entity.size_m is not None):
                self._raised.add(solid.name)
        return solid

    @property
    def is_flat(self) -> bool:
        """Whether no thing has a height or a size of its own: a plan tells nothing of what is on what."""
        return not self._raised

    def take(self, name: str) -> Solid | None:
        """Take an entity out, if it is there; its solid."""
        solid = self.solids.pop(name, None)
        if solid is not None:
            self.grid.remove(solid)
            self._raised.discard(name)
            self.held.pop(name, None)
        return solid

    @contextmanager
    def supposing(self, entities: Iterable[Entity | Placed], without: Iterable[str] = ()) -> Iterator[None]:
        """Within, these entities are as given here, and those without are not there."""
        entities, without = tuple(entities), tuple(without)
        names = {*(entity.name for entity in entities), *without}
        before = [solid for name in names if (solid := self.solids.get(name)) is not None]
        raised = self._raised & names
        held = {name: self.held[name] for name in names & self.held.keys()}
        try:
            for name in without:
                self.take(name)
            for entity in entities:
                self.put(entity)
            yield
        finally:
            for name in names:
                self.take(name)
            for solid in before:
                self._add(solid)
            self._raised |= raised
            self.held.update(held)
            self.shifted()

    def shifted(self) -> list[Solid]:
        """Who came to count, or does not count any more, since this was asked last."""
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
        """Whose bounds meet its own, or are within a margin of them."""
        widest_m = self.limits.attached_m
        if self.memory is None or self.memory.around is None or margin_m > widest_m:
            return self.grid.around(solid.bounds, margin_m, solid)
        around = self.memory.around.get(solid)
        if around is None:
            around = self.memory.around[solid] = self.grid.around(solid.bounds, widest_m, solid)
        if margin_m == widest_m:
            return around
        return [other for other in around if measures.overlap(solid.bounds, other.bounds, margin_m)]

    def counted_around(self, solid: Solid, margin_m: float = 0.0) -> list[Solid]:
        """Those of them who are looked at for what bears and holds the solid: in a crowd the largest."""
        if not self.grid.crowds:
            return self.around(solid, margin_m)
        return [other for other in self.grid.counted_around(solid.bounds, margin_m) if other is not solid]

    def bearers_around(self, solid: Solid, margin_m: float = 0.0) -> list[Solid]:
        """Those of them who may bear and hold it; of what does not count itself, only what is larger."""
        if not self.grid.crowds:
            return self.around(solid, margin_m)
        around = self.counted_around(solid, margin_m)
        if self.grid.counts(solid):
            return around
        return [other for other in around if other.is_place or other.volume > solid.volume]

    def counts(self, solid: Solid) -> bool:
        """Whether others look at it."""
        return self.grid.counts(solid)

    def is_crowded(self, solid: Solid) -> bool:
        """Whether there is more around it than is looked at."""
        return self.grid.is_crowded(solid)

    def beside(self, solids: Sequence[Solid], margin_m: float) -> Iterable[Solid]:
        """Who may be within a margin of many: all who are there or thereabouts."""
        return beside(self.grid, solids, margin_m) or self.solids.values()

    def crowds(self, names: Collection[str] | None = None) -> list[str]:
        """Where not all count, a sentence each, the most crowded first; with `names`, where one is."""
        return self.grid.told_crowds(names)

    def within(self, bounds: Bounds) -> list[Solid]:
        """Whose bounds meet these."""
        return self.grid.around(bounds)

    def remembering(self, *, of_few: bool = False) -> Memory:
        """Within a `with`, nothing changes, so that whereabouts need to be worked out once only.

        Where it is `of_few` that anything is asked, who is around them is remembered, too.
        """
        return Memory(self, of_few=of_few)

    def whereabouts(self, solid: Solid) -> Whereabouts:
        """The smallest hollow that it is in, the nearest surface below it, the smallest place around it."""
        if self.memory is None:
            return self._whereabouts(solid)
        known = self.memory.whereabouts.get(solid.name)
        if known is None:
            known = self.memory.whereabouts[solid.name] = self._whereabouts(solid)
        return known

    def _whereabouts(self, solid: Solid) -> Whereabouts:
        limits = self.limits
        container: Found | None = None
        place: Found | None = None
        below: list[Found] = []
        least = solid.bottom - limits.gap_m - 1e-6
        for other in self.bearers_around(solid):
            if other.is_place:
                made = measures.within(solid, other, limits)
                if made and made.holds and (place is None or _area(other) < _area(place[0])):
                    place = (other, made)
                continue
            if other.top < least or not self._may_share(other, solid):
                continue
            made = measures.inside(solid, other, limits) if other.hollows else None
            if made and made.holds and (container is None or _volume(other) < _volume(container[0])):
                container = (other, made)
            made = measures.on(solid, other, limits)
            if made is not None:
                below.append((other, made))
        floor = None if place is None else solid.bottom - place[0].bottom
        return Whereabouts(container, self._supports(solid, below, container, floor) if below else (), place)

    def may_bear(self, bearer: Solid, solid: Solid) -> bool:
        """Whether one is in a hollow of another or touches it from above: else it is not among its supports.

        That takes a look at the two; `whereabouts` looks at all that is around.
        """
        if solid.is_place or bearer.top < solid.bottom - self.limits.gap_m:
            return False
        if not self._may_share(bearer, solid):
            return False
        if bearer.hollows and self._is_within(solid, bearer):
            return True
        made = measures.on(solid, bearer, self.limits)
        return made is not None and made.holds

    def _may_share(self, bearer: Solid, solid: Solid) -> bool:
        """Whether one may bear another for all that grasps this: a carried tray does what it takes along.

        So does what is taken along with it, as a bowl on the tray does an apple.
        """
        if not self.held or (holder := self.held.get(solid.name)) is None:
            return True
        return holder in self.held and holder in (bearer.name, self.held.get(bearer.name))

    def _supports(
        self, solid: Solid, below: list[Found], container: Found | None, floor_m: float | None
    ) -> tuple[Found, ...]:
        """What of that which is close below bears it: the nearest, and what is level with that.

        To a centimetre all are equally near; of those the highest counts. The floor of its place, `floor_m`
        below it, is one of them, and so is what it leans on. What is inside something is on no more than
        what is in there with it, and what stands in a tray on nothing below the tray. What none of these
        bears rests on what it leans on.
        """
        limits = self.limits
        if container is not None:
            below = [found for found in below if self._is_within(found[0], container[0])]
        leaning = [found for found in below if not found[1].holds]
        gaps = [made.gap_m for _, made in leaning]
        below = [found for found in below if found[1].holds and not self._is_below(solid, *found)]
        on_floor = floor_m is not None and abs(floor_m) <= limits.gap_m
        trays = [made.height_m for other, made in below if measures.cradles(other, solid, made)]
        if trays:
            lowest = max(trays) - limits.contact_m
            below = [found for found in below if found[1].height_m >= lowest]
            on_floor = on_floor and floor_m is not None and solid.bottom - floor_m >= lowest
        if not below:
            least = min((side.bottom for side, _ in leaning), default=math.inf)
            may_stand = on_floor or (floor_m is None and solid.bottom <= least + limits.gap_m)
            return () if may_stand else tuple(sorted(map(_held, leaning), key=_by_name))
        gaps += [made.gap_m for _, made in below]
        if floor_m is not None and on_floor:
            gaps.append(floor_m)
        nearest = gaps[0] if len(gaps) == 1 else min(gaps, key=_nearness)
        level = [found for found in below if abs(found[1].gap_m - nearest) <= limits.contact_m]
        if sum(made.share for _, made in level) < limits.base_share and not measures.is_balanced(
            solid, [other for other, _ in level], solid.bottom - nearest
        ):
            return ()
        return tuple(sorted(level, key=lambda found: (-found[1].share, found[0].name)))

    def _is_within(self, solid: Solid, container: Solid) -> bool:
        made = measures.inside(solid, container, self.limits)
        return made is not None and made.holds

    def _is_below(self, solid: Solid, other: Solid, made: Measure) -> bool:
        """Whether the other one rests on this one rather, as things do that are hooked into one another."""
        if other.bottom < solid.bottom - self.limits.contact_m:
            return False
        back = measures.on(other, solid, self.limits)
        return (
            back is not None and back.holds and (abs(back.gap_m), solid.name) < (abs(made.gap_m), other.name)
        )


class Memory:
    """What was worked out of a space that is as it was; it is asked for within a `with`."""

    __slots__ = ("_space", "around", "whereabouts")

    def __init__(self, space: Space, *, of_few: bool) -> None:
        """Nothing yet."""
        self._space = space
        self.whereabouts: dict[str, Whereabouts] = {}
        """By name."""
        self.around: dict[Solid, list[Solid]] | None = {} if of_few else None
        """Who is within the margin of what hangs; of many that would take too much room."""

    def __enter__(self) -> None:
        self._space.memory = self

    def __exit__(self, *_: object) -> None:
        self._space.memory = None


def _nothing() -> None:
    pass


def _area(solid: Solid) -> tuple[float, str]:
    return (solid.footprint, solid.name)


def _volume(solid: Solid) -> tuple[float, str]:
    return (solid.volume, solid.name)


def _held(leaning: Found) -> Found:
    """It holds by its steep sides; no part of the base is over them."""
    side, made = leaning
    return side, made._replace(holds=True, share=0.0)


def _by_name(found: Found) -> str:
    return found[0].name


def _nearness(gap_m: float) -> tuple[float, float]:
    return (round(abs(gap_m), 2), gap_m)
