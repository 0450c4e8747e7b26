"""Differences between two commits, and the times at which a spatial relation held, from the journal."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from typing import Final, get_args

from msgspec import structs

from semmap.nodes.kb_node.answers.past import states
from semmap.nodes.kb_node.answers.past.fact_intervals import PoseChanges, find_intervals
from semmap.nodes.kb_node.answers.past.renames import Renames
from semmap.nodes.kb_node.answers.past.span_texts import describe_spells, lasted_s, stamp_of
from semmap.nodes.kb_node.relations.facts.place_facts import Fact, Facts
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.relations.selection import is_in, is_on, resolve_word
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.schemas import errors
from semmap.schemas.changes import Change, between, removed
from semmap.schemas.commands import Diff, WasWhen
from semmap.schemas.entities import Entity
from semmap.schemas.map_history import Difference, KeptRelation, Related, Spell, Spells, TimedRelation
from semmap.schemas.relations import PHRASES, RelationName

_KEPT: Final[dict[RelationName, KeptRelation]] = {name: name for name in get_args(KeptRelation)}
_RELATIONS: Final[dict[str, TimedRelation]] = {
    **{name: name for name in get_args(KeptRelation)},
    "isNear": "isNear",
}


def compute_difference(journal: Journal, past: HistoryReader, query: Diff, limits: Thresholds) -> Difference:
    """Return what changed between `query.since` and `query.until`. Raises Refused, BadRequest."""
    first = past.commit_before(query.since)
    last = past.last if query.until is None else past.commit_at(query.until)
    if first > last:
        raise errors.BadRequest(f"commit {first} comes after commit {last}; give the earlier one first")
    then, now = ({entity.name: entity for entity in past.entities(seq)} for seq in (first, last))
    matched = past.match_names(then.keys(), now.keys(), first, last)
    later = {name: new for name, new in matched.items() if new in now}
    then = {later.get(name, name): entity for name, entity in then.items()}
    changes: list[Change] = []
    for name in sorted(then.keys() | now.keys()):
        if name in now:
            changes += between(then.get(name), now[name])
        else:
            changes.append(removed(name, then[name].class_))
    kept = [structs.replace(entity, name=name) for name, entity in then.items()]
    was, is_ = (_facts(entities, limits) for entities in (kept, now.values()))
    if query.on is not None or query.in_ is not None:
        both = {**then, **now}
        was, is_ = (_select_facts(facts, query, tuple(both.values())) for facts in (was, is_))
        touched = {fact[0] for fact in was ^ is_}
        changes = [change for change in changes if change.name in touched]
    differing = sorted([(fact, False) for fact in was - is_] + [(fact, True) for fact in is_ - was])
    relations = tuple(
        Related(subject=s, relation=_KEPT[relation], object=o, came=came, text=_phrase(relation, came, o))
        for (s, relation, o), came in differing
    )
    return Difference(
        first=first,
        last=last,
        first_ns=stamp_of(journal, first),
        last_ns=stamp_of(journal, last),
        changes=tuple(changes),
        relations=relations,
    )


def _phrase(relation: RelationName, came: bool, other: str) -> str:
    words = PHRASES[relation]
    return f"{words if came else words.replace('is ', 'is no longer ', 1)} {other}"


def _facts(entities: Iterable[Entity], limits: Thresholds) -> set[Fact]:
    facts = Facts(limits)
    for _ in facts.fill_steps(entities):
        pass
    return set(facts)


def _select_facts(facts: set[Fact], query: Diff, entities: Sequence[Entity]) -> set[Fact]:
    """Return the facts about what is directly on or in the entities of a query. Raises UnknownName."""
    wanted: set[tuple[str, str]] = set()
    if query.on is not None:
        wanted |= {("isOn", name) for name in resolve_word(entities, query.on)}
    if query.in_ is not None:
        within = resolve_word(entities, query.in_)
        wanted |= {(relation, name) for relation in ("isInside", "isLocatedIn") for name in within}
    return {fact for fact in facts if fact[1:] in wanted}


def find_spells(journal: Journal, past: HistoryReader, query: WasWhen, limits: Thresholds) -> Spells:
    """Return when the relation held. Raises UnknownName; BadRequest for an ambiguous word."""
    asked = _RELATIONS.get(query.relation)
    if asked is None:
        return states.find_state_spells(journal, past, query)
    if not isinstance(query.other, str):
        raise errors.BadRequest(f"{asked} requires the other entity: when NAME {asked} OTHER")
    present = past.entities(past.last) if past.last else ()
    entities = {entity.name: entity for entity in present}
    one, other = (past.resolve_renamed(word, present) for word in (query.name, query.other))
    text, intervals = _find_spells(one, asked, other, journal, past, limits)
    if not intervals and (bearer := _find_support(one, asked, other, entities, limits)) is not None:
        relation, below = bearer
        part = _find_spells(one, relation, below, journal, past, limits)[0].replace(one, "it", 1)
        where = f"{_spoken(asked)} {other}"
        text = f"{one} was never itself {where}; {part}, and {below} is {where}"
    return Spells(
        subject=one,
        relation=asked,
        object=other,
        spells=intervals,
        total_s=sum(lasted_s(spell, time.time_ns()) for spell in intervals),
        text=text,
    )


def _find_spells(
    one: str, relation: TimedRelation, other: str, journal: Journal, past: HistoryReader, limits: Thresholds
) -> tuple[str, tuple[Spell, ...]]:
    """Return when a relation held, as text and as intervals."""
    fact = (one, relation, other)
    first = past.initial_entities().values()
    renames = Renames.of(past, (one, other))
    history = journal.decode_partially(PoseChanges)
    found = find_intervals(history, first, [fact], limits, renames, in_any_place=True)[fact]
    intervals = tuple(
        Spell(
            since=since,
            since_ns=stamp_of(journal, since),
            until=until,
            until_ns=None if until is None else stamp_of(journal, until),
        )
        for since, until in found
    )
    return describe_spells(one, f"{_spoken(relation)} {other}", intervals, time.time_ns()), intervals


def _spoken(relation: TimedRelation) -> str:
    return PHRASES[relation].removeprefix("is ")


def _find_support(
    one: str, relation: TimedRelation, other: str, entities: Mapping[str, Entity], limits: Thresholds
) -> tuple[KeptRelation, str] | None:
    """Return what an object is on or inside now, if that is itself on or inside `other`, else None."""
    if relation not in ("isOn", "isInside"):
        return None
    space = Space(map(PlacedEntity.of, entities.values()), limits)
    if (solid := space.solids.get(one)) is None:
        return None
    container, supports, _ = space.spatial_relations(solid)
    below: list[tuple[KeptRelation, Solid]] = [("isOn", support) for support, _ in supports]
    if container is not None:
        below.insert(0, ("isInside", container[0]))
    holds = is_on if relation == "isOn" else is_in
    for how, bearer in below:
        if holds(space, bearer, {other}, frozenset()):
            return how, bearer.name
    return None
