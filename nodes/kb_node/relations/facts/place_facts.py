"""The computed facts of a map, updated incrementally with it.

They are a function of the poses alone (`rules`), so that a restart, another order of commits, or a past
state gives the same facts.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, islice
from typing import NamedTuple

from semmap.nodes.kb_node.progress import split_batches
from semmap.nodes.kb_node.relations.facts.precomputation import Precomputation
from semmap.nodes.kb_node.relations.facts.precompute_messages import FactsByName
from semmap.nodes.kb_node.relations.facts.rules import RULES, About, Rule
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.geometry.solids import Solid, solid_of
from semmap.nodes.kb_node.relations.measuring.broad_phase import sort_by_place
from semmap.nodes.kb_node.relations.measuring.space import MANY, Space
from semmap.nodes.kb_node.relations.measuring.survey import Survey
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.schemas.entities import Entity
from semmap.schemas.relations import RelationName

Fact = tuple[str, RelationName, str]
"""Name, relation, name: ("cup1", "isOn", "table1")."""
_STEP = 1000
"""Entities per step of some tens of milliseconds."""
_MOST_AT_ONCE = 16_000
"""Entities surveyed together if nothing waits. Larger groups need fewer neighbour searches."""
_CLEARED_PER_CHANGE = 8
"""Solids whose caches are cleared for each one that an update touches."""
_MOST_TO_CLEAR = 1000
_CONTAINING: frozenset[RelationName] = frozenset({"isOn", "isInside", "isLocatedIn"})
"""The relations that `with_contents` follows."""


class Changed(NamedTuple):
    """The facts that no longer hold, and those that newly hold."""

    gone: set[Fact]
    come: set[Fact]


class Facts:
    """The facts of a map, indexed by subject and by object."""

    def __init__(self, limits: Thresholds | None = None, rules: Sequence[Rule] = RULES) -> None:
        self.space = Space(limits=limits)
        self._rule_facts = [_RuleFacts(rule) for rule in rules]
        self._margin_m = max(rule.margin_m(self.space.limits) for rule in rules)
        self._in_turn: Iterator[Solid] = iter(())
        self._to_clear = 0
        self._waiting: dict[str, Solid] = {}
        """During `fill_steps`: the solids whose facts have not been computed."""
        self._precomputation: Precomputation | None = None
        self.shifted: frozenset[str] = frozenset()
        """Objects that the last update made count, or no longer count, because of others in a crowd."""

    def set_precomputation(self, precomputation: Precomputation) -> None:
        """Use the result of `precomputation` in the next update, which adds the expected entities."""
        self._precomputation = precomputation

    def discard_precomputation(self) -> None:
        """Stop the precomputation, because the expected update does not come."""
        precomputation, self._precomputation = self._precomputation, None
        if precomputation is not None:
            precomputation.discard()

    def by_rule(self) -> tuple[FactsByName, ...]:
        """Return all facts, by rule and name."""
        return tuple(rule_facts.of for rule_facts in self._rule_facts)

    def __iter__(self) -> Iterator[Fact]:
        """Yield all facts."""
        for rule_facts in self._rule_facts:
            yield from rule_facts.all()

    def holds(self, fact: Fact) -> bool:
        """Return whether a fact holds."""
        name, relation, other = fact
        return any((relation, other) in rule_facts.of.get(name, ()) for rule_facts in self._rule_facts)

    def of(self, name: str) -> Iterator[About]:
        """Yield the facts of an object. Of several supports the most important one comes first."""
        for rule_facts in self._rule_facts:
            yield from rule_facts.of.get(name, ())

    def about(self, name: str) -> set[str]:
        """Return the subjects of the facts about an object."""
        return {other for rule_facts in self._rule_facts for other in rule_facts.about.get(name, ())}

    def with_contents(self, names: Iterable[str]) -> set[str]:
        """Return these objects, and everything on, inside or in them, at any depth."""
        found = set(names)
        waiting = list(found)
        containing = [
            rule_facts
            for rule_facts in self._rule_facts
            if not _CONTAINING.isdisjoint(rule_facts.rule.relations)
        ]
        while waiting:
            name = waiting.pop()
            for rule_facts in containing:
                for above in rule_facts.about.get(name, ()):
                    if above not in found:
                        found.add(above)
                        waiting.append(above)
        return found

    def fill_steps(self, entities: Iterable[Entity | PlacedEntity]) -> Iterator[None]:
        """Start with these entities, in steps of some tens of milliseconds."""
        yield from self.insert_steps(entities)
        yield from self.compute_steps()

    def insert_steps(self, entities: Iterable[Entity | PlacedEntity]) -> Iterator[None]:
        """Insert the entities. The map must not change between these steps."""
        for _ in self.space.put_all(entities):
            yield
        self.space.pop_shifted()
        self._waiting = {solid.name: solid for solid in self._find_objects(self.space.solids)}

    def compute_steps(self) -> Iterator[None]:
        """Compute the facts. Updates between these steps first compute the facts that they affect."""
        for some in split_batches(sort_by_place(list(self._waiting.values())), _STEP, _ignore_progress):
            self._compute_waiting(solid for solid in some if self._waiting.get(solid.name) is solid)
            yield
        for solids in split_batches(tuple(self.space.solids.values()), _STEP, _ignore_progress):
            for solid in solids:
                solid.clear_cache()
            if len(solids) == _STEP:
                yield

    @property
    def is_complete(self) -> bool:
        """Return whether all facts have been computed."""
        return not self._waiting

    def _compute_waiting(self, waiting: Iterable[Solid]) -> None:
        """Compute the facts of solids that have only been inserted."""
        solids = list(waiting)
        for _ in self._compute_in_steps(solids, set(), set(), _STEP):
            pass
        for solid in solids:
            del self._waiting[solid.name]

    def _compute_affected(self, changed: Sequence[Entity | PlacedEntity], removed: Sequence[str]) -> None:
        """Compute the waiting facts that a change may affect, as they are before it."""
        waiting, space = self._waiting, self.space
        if len(changed) + len(removed) >= MANY:
            self._compute_waiting(list(waiting.values()))
            return
        names = (*removed, *(entity.name for entity in changed))
        concerned = dict.fromkeys(names)
        for solid in (*map(space.solids.get, names), *map(solid_of, changed)):
            if solid is not None:
                concerned.update((other.name, None) for other in space.around(solid, self._margin_m))
        self._compute_waiting([waiting[name] for name in concerned if name in waiting])

    def _find_objects(self, names: Iterable[str]) -> list[Solid]:
        """Return the solids of these names that exist and are not places."""
        solids = self.space.solids
        return [solid for name in names if (solid := solids.get(name)) is not None and not solid.is_place]

    def _compute_in_steps(
        self, solids: Sequence[Solid], gone: set[Fact], come: set[Fact], step: int
    ) -> Iterator[None]:
        """Compute the facts of many solids, `step` at a time, and add differences to `gone` and `come`."""
        space = self.space
        for some in split_batches(
            sort_by_place(solids) if len(solids) > step else solids, step, _ignore_progress
        ):
            survey = Survey(space, some) if len(some) >= MANY else None
            with space.caching():
                for rule_facts in self._rule_facts:
                    if survey is None:
                        rule_facts.compute(space, [solid.name for solid in some], gone, come)
                    else:
                        rule_facts.set_facts(space, some, rule_facts.rule.of_many(survey), gone, come)
            yield

    def _take_precomputed(self, came: Iterable[Entity | PlacedEntity]) -> Sequence[FactsByName] | None:
        precomputation, self._precomputation = self._precomputation, None
        return None if precomputation is None else precomputation.facts(came)

    def clear_caches(self) -> None:
        """Clear the caches of some solids in turn, more than updates touched.

        Call it when idle. `update` calls it only if it has not been called for long.
        """
        count, self._to_clear = self._to_clear, 0
        forgot = 0
        for solid in islice(self._in_turn, count):
            solid.clear_cache()
            forgot += 1
        if forgot < count:
            self._in_turn = iter(tuple(self.space.solids.values()))

    def _counted(self, name: str) -> Solid | None:
        """Return a solid that is counted as a neighbour, or None."""
        solid = self.space.solids.get(name)
        return solid if solid is not None and self.space.counts(solid) else None

    def update(self, changed: Iterable[Entity | PlacedEntity], removed: Iterable[str] = ()) -> Changed:
        """Apply added, changed and removed entities."""
        changed, removed = list(changed), list(removed)
        if not (changed or removed):
            self.shifted = frozenset()
            return Changed(set(), set())
        if self._waiting:
            self._compute_affected(changed, removed)
        space = self.space
        moved: dict[str, None] = {}
        left: list[Solid] = []
        for name in removed:
            moved[name] = None
            left += filter(None, (self._counted(name),))
            space.remove(name)
        for entity in changed:
            moved[entity.name] = None
            if space.solids:
                left += filter(None, (self._counted(entity.name),))
        if len(changed) < MANY:
            fresh = [solid for entity in changed if (solid := space.put(entity)) is not None]
        else:
            fresh = list(chain.from_iterable(space.put_all(changed)))
        shifted = space.pop_shifted()
        fresh = [*filter(space.counts, fresh), *shifted]
        for solid in shifted:
            moved[solid.name] = None
        gone: set[Fact] = set()
        come: set[Fact] = set()
        with space.caching(of_few=True):
            concerned = self._find_affected(moved, (*fresh, *left))
            if len(concerned) < MANY:
                for rule_facts in self._rule_facts:
                    rule_facts.compute(space, concerned, gone, come)
        if len(concerned) >= MANY:
            objects = self._find_objects(concerned)
            if len(objects) < len(concerned):
                left_over = concerned.keys() - {solid.name for solid in objects}
                for rule_facts in self._rule_facts:
                    rule_facts.compute(space, left_over, gone, come)
            if (found := self._take_precomputed(changed)) is None:
                for _ in self._compute_in_steps(objects, gone, come, _MOST_AT_ONCE):
                    pass
            else:
                for rule_facts, of in zip(self._rule_facts, found, strict=True):
                    rule_facts.set_facts(
                        space, objects, [of.get(solid.name, ()) for solid in objects], gone, come
                    )
        self._to_clear = min(self._to_clear + _CLEARED_PER_CHANGE * len(moved), len(space.solids))
        if self._to_clear > _MOST_TO_CLEAR:
            self.clear_caches()
        self.shifted = frozenset([solid.name for solid in shifted])
        return Changed(gone, come)

    def _find_affected(self, moved: dict[str, None], solids: Sequence[Solid]) -> dict[str, None]:
        """Return the names whose facts may change: moved ones, and neighbours of `solids`."""
        space, found = self.space, dict(moved)
        for rule_facts in self._rule_facts:
            if rule_facts.about:
                for name in moved:
                    found.update(rule_facts.about.get(name, ()))
        if found.keys() >= space.solids.keys():
            return found
        if len(solids) >= MANY:
            found.update((solid.name, None) for solid in space.find_nearby(solids, self._margin_m))
            return found
        for solid in solids:
            self._add_affected_by(solid, found)
        return found

    def _add_affected_by(self, solid: Solid, found: dict[str, None]) -> None:
        space = self.space
        for other in space.around(solid, self._margin_m):
            if other.is_place or other.name in found:
                continue
            for rule_facts in self._rule_facts:
                if rule_facts.rule.concerns(space, solid, other):
                    found[other.name] = None
                    break


def _ignore_progress() -> None:
    pass


class _RuleFacts:
    """The facts of one rule."""

    def __init__(self, rule: Rule) -> None:
        self.rule = rule
        self.of: dict[str, tuple[About, ...]] = {}
        """By subject."""
        self.about: dict[str, dict[str, None]] = {}
        """By object, the subjects."""

    def all(self) -> Iterator[Fact]:
        for name, found in self.of.items():
            for relation, other in found:
                yield name, relation, other

    def set_facts(
        self,
        space: Space,
        solids: Sequence[Solid],
        found: Sequence[tuple[About, ...] | None],
        gone: set[Fact],
        come: set[Fact],
    ) -> None:
        """Store facts of solids and add differences to `gone` and `come`. None means to measure."""
        facts, of, about = self.rule.facts, self.of, self.about
        if not of and found.count(()) == len(found):
            return
        for solid, known in zip(solids, found, strict=True):
            now = tuple(facts(space, solid)) if known is None else known
            name = solid.name
            before = of.get(name, ())
            if now == before:
                continue
            if before:
                self._replace(name, before, now, gone, come)
                continue
            of[name] = now
            for relation, other in now:
                come.add((name, relation, other))
                if other in about:
                    about[other][name] = None
                else:
                    about[other] = {name: None}

    def compute(self, space: Space, names: Iterable[str], gone: set[Fact], come: set[Fact]) -> None:
        """Compute the facts of these names and add differences to `gone` and `come`."""
        for name in names:
            before = self.of.get(name, ())
            now = self._compute(space, name)
            if now != before:
                self._replace(name, before, now, gone, come)

    def _compute(self, space: Space, name: str) -> tuple[About, ...]:
        solid = space.solids.get(name)
        if solid is None or solid.is_place:
            return ()
        return tuple(self.rule.facts(space, solid))

    def _replace(
        self,
        name: str,
        before: tuple[About, ...],
        now: tuple[About, ...],
        gone: set[Fact],
        come: set[Fact],
    ) -> None:
        if now:
            self.of[name] = now
        else:
            del self.of[name]
        others = {other for _, other in now}
        for relation, other in before:
            if (relation, other) not in now:
                gone.add((name, relation, other))
            if other not in others:
                about = self.about.get(other, {})
                about.pop(name, None)
                if not about:
                    self.about.pop(other, None)
        for relation, other in now:
            if (relation, other) not in before:
                come.add((name, relation, other))
                self.about.setdefault(other, {})[name] = None
