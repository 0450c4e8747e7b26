"""What everything is on, inside and in, kept in step with a map for whoever a change concerns.

What is kept is a function of the poses alone (`Space`), so that a restart, another order of commits and a
past moment give the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from nodes.kb_node.relations import measures
from nodes.kb_node.relations.placed import Placed
from nodes.kb_node.relations.solids import Solid
from nodes.kb_node.relations.space import Space
from nodes.kb_node.relations.thresholds import Thresholds
from schemas.entities import Entity
from schemas.relations import RelationName

Fact = tuple[str, RelationName, str]
"""Name, relation, name: ("cup1", "isOn", "table1")."""


class Changed(NamedTuple):
    """Which facts no longer hold, and which do now."""

    gone: set[Fact]
    come: set[Fact]


class Facts:
    """The facts that hold in a map, by their subject, and whom else they speak of."""

    def __init__(self, limits: Thresholds | None = None) -> None:
        self.space = Space(limits=limits)
        self._facts: dict[str, tuple[Fact, ...]] = {}
        self._about: dict[str, dict[str, None]] = {}
        """Whose facts speak of a thing."""

    def __iter__(self) -> Iterator[Fact]:
        """All that hold."""
        for facts in self._facts.values():
            yield from facts

    def upward(self, names: Iterable[str]) -> set[str]:
        """These things, what is on, inside or in them, and what is on or inside that."""
        found = set(names)
        waiting = list(found)
        while waiting:
            for above in self._about.get(waiting.pop(), ()):
                if above not in found:
                    found.add(above)
                    waiting.append(above)
        return found

    def update(self, changed: Iterable[Entity | Placed], removed: Iterable[str] = ()) -> Changed:
        """Some entities came or are otherwise now, others went."""
        space = self.space
        concerned: dict[str, None] = {}
        fresh: list[Solid] = []
        for name in removed:
            concerned.update(dict.fromkeys(self._about.get(name, ())))
            concerned[name] = None
            space.take(name)
        for entity in changed:
            concerned.update(dict.fromkeys(self._about.get(entity.name, ())))
            concerned[entity.name] = None
            if (solid := space.put(entity)) is not None:
                fresh.append(solid)
        for solid in fresh:
            for other in self._whom_it_concerns(solid):
                concerned[other.name] = None
        before: set[Fact] = set()
        after: set[Fact] = set()
        for name in concerned:
            before.update(self._facts.pop(name, ()))
            solid_now = space.solids.get(name)
            if solid_now is None or solid_now.is_place:
                continue
            if found := tuple(self._work_out(solid_now)):
                self._facts[name] = found
                after.update(found)
        gone, come = before - after, after - before
        for subject, _, other_name in gone:
            self._forget(subject, other_name)
        for subject, _, other_name in come:
            self._about.setdefault(other_name, {})[subject] = None
        return Changed(gone, come)

    def _forget(self, subject: str, other: str) -> None:
        """A fact about two went; another one about them may hold."""
        if any(o == other for _, _, o in self._facts.get(subject, ())):
            return
        about = self._about.get(other, {})
        about.pop(subject, None)
        if not about:
            self._about.pop(other, None)

    def _whom_it_concerns(self, solid: Solid) -> Iterator[Solid]:
        """Who may be on it, inside it or in it now, of those who were not."""
        space, gap = self.space, self.space.limits.gap_m
        for other in space.around(solid):
            if other.is_place or not measures.overlap(solid.bounds, other.bounds):
                continue
            if solid.is_place or (other.bottom <= solid.top + gap and other.top >= solid.bottom - gap):
                yield other

    def _work_out(self, solid: Solid) -> Iterator[Fact]:
        container, supports, place = self.space.whereabouts(solid)
        if container is not None:
            yield (solid.name, "isInside", container[0].name)
        for support, _ in supports:
            yield (solid.name, "isOn", support.name)
        if place is not None:
            yield (solid.name, "isLocatedIn", place[0].name)
