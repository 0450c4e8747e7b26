"""Which relations hold in a map, kept in step with it for whoever a change concerns.

What is kept is a function of the poses alone (`rules`), so that a restart, another order of commits and a
past moment give the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, islice
from typing import NamedTuple

from semmap.nodes.kb_node.progress import split_batches
from semmap.nodes.kb_node.relations.facts.ahead import Ahead
from semmap.nodes.kb_node.relations.facts.foreseen import Found
from semmap.nodes.kb_node.relations.facts.rules import RULES, About, Rule
from semmap.nodes.kb_node.relations.geometry.placed import Placed
from semmap.nodes.kb_node.relations.geometry.solids import Solid, solid_of
from semmap.nodes.kb_node.relations.measuring.broad_phase import by_place
from semmap.nodes.kb_node.relations.measuring.space import MANY, Space
from semmap.nodes.kb_node.relations.measuring.survey import Survey
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.schemas.entities import Entity
from semmap.schemas.relations import RelationName

Fact = tuple[str, RelationName, str]
"""Name, relation, name: ("cup1", "isOn", "table1")."""
_STEP = 1000
"""Entities that are worked out in some tens of milliseconds."""
_MOST_AT_ONCE = 16_000
"""So many are surveyed together where nobody waits: those around them are looked up less often."""
_FORGOTTEN = 8
"""Solids for each that an update touches."""
_MOST_TO_FORGET = 1000
_BEARING: frozenset[RelationName] = frozenset({"isOn", "isInside", "isLocatedIn"})
"""Along these `upward` goes."""


class Changed(NamedTuple):
    """Which facts no longer hold, and which do now."""

    gone: set[Fact]
    come: set[Fact]


class Facts:
    """The facts that hold in a map, by their subject, and whom else they speak of."""

    def __init__(self, limits: Thresholds | None = None, rules: Sequence[Rule] = RULES) -> None:
        self.space = Space(limits=limits)
        self._kept = [_Kept(rule) for rule in rules]
        self._margin_m = max(rule.margin_m(self.space.limits) for rule in rules)
        self._in_turn: Iterator[Solid] = iter(())
        self._to_forget = 0
        self._waiting: dict[str, Solid] = {}
        """While `filling`: those that have been placed, and nothing else."""
        self._ahead: Ahead | None = None
        self.shifted: frozenset[str] = frozenset()
        """Who came to count in a crowd by the last update, or does not any more, because of others."""

    def work_ahead(self, ahead: Ahead) -> None:
        """The next update is about those who are foreseen, and `ahead` works out what will hold."""
        self._ahead = ahead

    def give_up_ahead(self) -> None:
        """That update does not come."""
        ahead, self._ahead = self._ahead, None
        if ahead is not None:
            ahead.give_up()

    def by_rule(self) -> tuple[Found, ...]:
        """All that hold, by rule and name."""
        return tuple(kept.of for kept in self._kept)

    def __iter__(self) -> Iterator[Fact]:
        """All that hold."""
        for kept in self._kept:
            yield from kept.all()

    def holds(self, fact: Fact) -> bool:
        """Whether one of them does."""
        name, relation, other = fact
        return any((relation, other) in kept.of.get(name, ()) for kept in self._kept)

    def of(self, name: str) -> Iterator[About]:
        """What holds of a thing; of what it is on and inside, what counts most comes first."""
        for kept in self._kept:
            yield from kept.of.get(name, ())

    def about(self, name: str) -> set[str]:
        """Of whom a fact holds that speaks of a thing."""
        return {other for kept in self._kept for other in kept.about.get(name, ())}

    def upward(self, names: Iterable[str]) -> set[str]:
        """These things, what is on, inside or in them, and what is on or inside that."""
        found = set(names)
        waiting = list(found)
        bearing = [kept for kept in self._kept if not _BEARING.isdisjoint(kept.rule.relations)]
        while waiting:
            name = waiting.pop()
            for kept in bearing:
                for above in kept.about.get(name, ()):
                    if above not in found:
                        found.add(above)
                        waiting.append(above)
        return found

    def filling(self, entities: Iterable[Entity | Placed]) -> Iterator[None]:
        """Begin with these, in steps of some tens of milliseconds."""
        yield from self.placing(entities)
        yield from self.working_out()

    def placing(self, entities: Iterable[Entity | Placed]) -> Iterator[None]:
        """The first half of `filling`, between whose steps nothing changes."""
        for _ in self.space.put_all(entities):
            yield
        self.space.shifted()
        self._waiting = {solid.name: solid for solid in self._things(self.space.solids)}

    def working_out(self) -> Iterator[None]:
        """The second half, between whose steps there may be updates: these see to what they concern first."""
        for some in split_batches(by_place(list(self._waiting.values())), _STEP, _nothing):
            self._work_out_those(solid for solid in some if self._waiting.get(solid.name) is solid)
            yield
        for solids in split_batches(tuple(self.space.solids.values()), _STEP, _nothing):
            for solid in solids:
                solid.forget()
            if len(solids) == _STEP:
                yield

    @property
    def are_worked_out(self) -> bool:
        """Whether nobody is left who has only been placed."""
        return not self._waiting

    def _work_out_those(self, waiting: Iterable[Solid]) -> None:
        """Work out the facts of some whom nobody has looked at since they were placed."""
        solids = list(waiting)
        for _ in self._working_out(solids, set(), set(), _STEP):
            pass
        for solid in solids:
            del self._waiting[solid.name]

    def _see_to_those_concerned(self, changed: Sequence[Entity | Placed], removed: Sequence[str]) -> None:
        """While they are being worked out: of whom a change may speak is worked out as it is before that."""
        waiting, space = self._waiting, self.space
        if len(changed) + len(removed) >= MANY:
            self._work_out_those(list(waiting.values()))
            return
        names = (*removed, *(entity.name for entity in changed))
        concerned = dict.fromkeys(names)
        for solid in (*map(space.solids.get, names), *map(solid_of, changed)):
            if solid is not None:
                concerned.update((other.name, None) for other in space.around(solid, self._margin_m))
        self._work_out_those([waiting[name] for name in concerned if name in waiting])

    def _things(self, names: Iterable[str]) -> list[Solid]:
        """Those that are there and are no places."""
        solids = self.space.solids
        return [solid for name in names if (solid := solids.get(name)) is not None and not solid.is_place]

    def _working_out(
        self, solids: Sequence[Solid], gone: set[Fact], come: set[Fact], step: int
    ) -> Iterator[None]:
        """Work out the facts of many, `step` at a time, and add what is otherwise to `gone` and `come`."""
        space = self.space
        for some in split_batches(by_place(solids) if len(solids) > step else solids, step, _nothing):
            survey = Survey(space, some) if len(some) >= MANY else None
            with space.remembering():
                for kept in self._kept:
                    if survey is None:
                        kept.work_out(space, [solid.name for solid in some], gone, come)
                    else:
                        kept.take(space, some, kept.rule.of_many(survey), gone, come)
            yield

    def _worked_out_ahead(self, came: Iterable[Entity | Placed]) -> Sequence[Found] | None:
        ahead, self._ahead = self._ahead, None
        return None if ahead is None else ahead.facts(came)

    def forget(self) -> None:
        """Let some solids, in turn, forget what can be worked out again: more of them than updates touched.

        Nobody need wait for that; only where it is not called for long, `update` does it.
        """
        count, self._to_forget = self._to_forget, 0
        forgot = 0
        for solid in islice(self._in_turn, count):
            solid.forget()
            forgot += 1
        if forgot < count:
            self._in_turn = iter(tuple(self.space.solids.values()))

    def _counted(self, name: str) -> Solid | None:
        """One that others look at."""
        solid = self.space.solids.get(name)
        return solid if solid is not None and self.space.counts(solid) else None

    def update(self, changed: Iterable[Entity | Placed], removed: Iterable[str] = ()) -> Changed:
        """Some entities came or are otherwise now, others went."""
        changed, removed = list(changed), list(removed)
        if not (changed or removed):
            self.shifted = frozenset()
            return Changed(set(), set())
        if self._waiting:
            self._see_to_those_concerned(changed, removed)
        space = self.space
        moved: dict[str, None] = {}
        left: list[Solid] = []
        for name in removed:
            moved[name] = None
            left += filter(None, (self._counted(name),))
            space.take(name)
        for entity in changed:
            moved[entity.name] = None
            if space.solids:
                left += filter(None, (self._counted(entity.name),))
        if len(changed) < MANY:
            fresh = [solid for entity in changed if (solid := space.put(entity)) is not None]
        else:
            fresh = list(chain.from_iterable(space.put_all(changed)))
        shifted = space.shifted()
        fresh = [*filter(space.counts, fresh), *shifted]
        for solid in shifted:
            moved[solid.name] = None
        gone: set[Fact] = set()
        come: set[Fact] = set()
        with space.remembering(of_few=True):
            concerned = self._concerned(moved, (*fresh, *left))
            if len(concerned) < MANY:
                for kept in self._kept:
                    kept.work_out(space, concerned, gone, come)
        if len(concerned) >= MANY:
            things = self._things(concerned)
            if len(things) < len(concerned):
                left_over = concerned.keys() - {solid.name for solid in things}
                for kept in self._kept:
                    kept.work_out(space, left_over, gone, come)
            if (found := self._worked_out_ahead(changed)) is None:
                for _ in self._working_out(things, gone, come, _MOST_AT_ONCE):
                    pass
            else:
                for kept, of in zip(self._kept, found, strict=True):
                    kept.take(space, things, [of.get(solid.name, ()) for solid in things], gone, come)
        self._to_forget = min(self._to_forget + _FORGOTTEN * len(moved), len(space.solids))
        if self._to_forget > _MOST_TO_FORGET:
            self.forget()
        self.shifted = frozenset([solid.name for solid in shifted])
        return Changed(gone, come)

    def _concerned(self, moved: dict[str, None], solids: Sequence[Solid]) -> dict[str, None]:
        """Of whom something else may hold now: those who moved, and others by how `solids` were or are."""
        space, found = self.space, dict(moved)
        for kept in self._kept:
            if kept.about:
                for name in moved:
                    found.update(kept.about.get(name, ()))
        if found.keys() >= space.solids.keys():
            return found
        if len(solids) >= MANY:
            found.update((solid.name, None) for solid in space.beside(solids, self._margin_m))
            return found
        for solid in solids:
            self._add_whom_it_concerns(solid, found)
        return found

    def _add_whom_it_concerns(self, solid: Solid, found: dict[str, None]) -> None:
        space = self.space
        for other in space.around(solid, self._margin_m):
            if other.is_place or other.name in found:
                continue
            for kept in self._kept:
                if kept.rule.concerns(space, solid, other):
                    found[other.name] = None
                    break


def _nothing() -> None:
    pass


class _Kept:
    """The facts of one rule."""

    def __init__(self, rule: Rule) -> None:
        self.rule = rule
        self.of: dict[str, tuple[About, ...]] = {}
        """What holds of a thing."""
        self.about: dict[str, dict[str, None]] = {}
        """Of whom a fact holds that speaks of a thing."""

    def all(self) -> Iterator[Fact]:
        for name, found in self.of.items():
            for relation, other in found:
                yield name, relation, other

    def take(
        self,
        space: Space,
        solids: Sequence[Solid],
        found: Sequence[tuple[About, ...] | None],
        gone: set[Fact],
        come: set[Fact],
    ) -> None:
        """Have what was found of some, and add what is otherwise to `gone` and `come`; None is measured."""
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

    def work_out(self, space: Space, names: Iterable[str], gone: set[Fact], come: set[Fact]) -> None:
        """Work out the facts of some, and add what is otherwise to `gone` and `come`."""
        for name in names:
            before = self.of.get(name, ())
            now = self._work_out(space, name)
            if now != before:
                self._replace(name, before, now, gone, come)

    def _work_out(self, space: Space, name: str) -> tuple[About, ...]:
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
