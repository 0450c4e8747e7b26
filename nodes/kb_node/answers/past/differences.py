"""Differences between two commits, and the times at which a spatial relation held, from the journal."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from typing import Final, get_args

from msgspec import structs

from semmap.nodes.kb_node.answers.past.fact_intervals import PoseChanges, find_intervals
from semmap.nodes.kb_node.relations.facts.place_facts import Fact, Facts
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.relations.selection import is_in, is_on
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.schemas import errors, wording
from semmap.schemas.changes import Change, between, removed
from semmap.schemas.commands import Diff, WasWhen
from semmap.schemas.entities import Entity
from semmap.schemas.map_history import Difference, KeptRelation, Related, Spell, Spells
from semmap.schemas.relations import PHRASES, RelationName

_KEPT: Final[dict[RelationName, KeptRelation]] = {name: name for name in get_args(KeptRelation)}
_LONGEST = 10
"""Intervals that are listed one by one in the text."""


def compute_difference(journal: Journal, past: HistoryReader, query: Diff, limits: Thresholds) -> Difference:
    """Return what changed between `query.since` and `query.until`. Raises Refused, BadRequest."""
    first = past.commit_at(query.since)
    last = past.last if query.until is None else past.commit_at(query.until)
    if first > last:
        raise errors.BadRequest(f"commit {first} comes after commit {last}; give the earlier one first")
    then, now = ({entity.name: entity for entity in past.entities(seq)} for seq in (first, last))
    if come := now.keys() - then.keys():
        later = past.find_later_names(then.keys() - now.keys(), last)
        known_as = {name: new for name, new in later.items() if new in come}
        then = {known_as.get(name, name): entity for name, entity in then.items()}
    changes: list[Change] = []
    for name in sorted(then.keys() | now.keys()):
        if name in now:
            changes += between(then.get(name), now[name])
        else:
            changes.append(removed(name, then[name].class_))
    kept = [structs.replace(entity, name=name) for name, entity in then.items()]
    was, is_ = (_facts(entities, limits) for entities in (kept, now.values()))
    differing = sorted([(fact, False) for fact in was - is_] + [(fact, True) for fact in is_ - was])
    relations = tuple(
        Related(subject=s, relation=_KEPT[relation], object=o, came=came, text=_phrase(relation, came, o))
        for (s, relation, o), came in differing
    )
    return Difference(
        first=first,
        last=last,
        first_ns=_stamp_ns(journal, first),
        last_ns=_stamp_ns(journal, last),
        changes=tuple(changes),
        relations=relations,
    )


def _stamp_ns(journal: Journal, seq: int) -> int:
    """Return the time of a commit. Compacted commits have the time of the first snapshot."""
    begins = journal.beginning
    return begins.stamp_ns if begins.seq and seq <= begins.seq else journal.stamps.of(max(seq, 1))


def _phrase(relation: RelationName, came: bool, other: str) -> str:
    words = PHRASES[relation]
    return f"{words if came else words.replace('is ', 'is no longer ', 1)} {other}"


def _facts(entities: Iterable[Entity], limits: Thresholds) -> set[Fact]:
    facts = Facts(limits)
    for _ in facts.fill_steps(entities):
        pass
    return set(facts)


def find_spells(journal: Journal, past: HistoryReader, query: WasWhen, limits: Thresholds) -> Spells:
    """Return when the relation held. Raises UnknownName; BadRequest for an ambiguous word."""
    present = past.entities(past.last) if past.last else ()
    entities = {entity.name: entity for entity in present}
    one, other = (past.resolve(word, present) for word in (query.name, query.other))
    text, intervals = _find_spells(one, query.relation, other, journal, past, limits)
    if not intervals and (bearer := _find_support(one, query.relation, other, entities, limits)) is not None:
        relation, below = bearer
        part = _find_spells(one, relation, below, journal, past, limits)[0].replace(one, "it", 1)
        where = f"{_spoken(query.relation)} {other}"
        text = f"{one} was never itself {where}; {part}, and {below} is {where}"
    return Spells(
        subject=one,
        relation=query.relation,
        object=other,
        spells=intervals,
        total_s=sum(_lasted_s(spell, time.time_ns()) for spell in intervals),
        text=text,
    )


def _find_spells(
    one: str, relation: KeptRelation, other: str, journal: Journal, past: HistoryReader, limits: Thresholds
) -> tuple[str, tuple[Spell, ...]]:
    """Return when a relation held, as text and as intervals."""
    fact = (one, relation, other)
    first = past.initial_entities().values()
    found = find_intervals(journal.decode_partially(PoseChanges), first, [fact], limits, in_any_place=True)[
        fact
    ]
    intervals = tuple(
        Spell(
            since=since,
            since_ns=_stamp_ns(journal, since),
            until=until,
            until_ns=None if until is None else _stamp_ns(journal, until),
        )
        for since, until in found
    )
    return _describe(one, f"{_spoken(relation)} {other}", intervals, time.time_ns()), intervals


def _spoken(relation: KeptRelation) -> str:
    return PHRASES[relation].removeprefix("is ")


def _find_support(
    one: str, relation: KeptRelation, other: str, entities: Mapping[str, Entity], limits: Thresholds
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


def _describe(name: str, where: str, intervals: Sequence[Spell], now_ns: int) -> str:
    """Return `cup1 has been on table1 since commit 4 (for 2 min); before that from commit 1 until ...`."""
    if not intervals:
        return f"{name} was never {where}"
    spans = [_span(spell, now_ns) for spell in intervals if spell.until is not None]
    shown = spans if len(spans) <= _LONGEST else [*spans[:3], f"{len(spans) - 6} more times", *spans[-3:]]
    total_s = sum(_lasted_s(spell, now_ns) for spell in intervals)
    often = f"; {len(intervals)} times, {wording.duration(total_s)} in all" if len(intervals) > 1 else ""
    if (last := intervals[-1]).until is None:
        earlier = f"; before that {', '.join(shown)}" if shown else ""
        return f"{name} has been {where} since {_beginning(last)} ({_length(last, now_ns)}){earlier}{often}"
    return f"{name} is no longer {where}; it was {', '.join(shown)}{often}"


def _span(spell: Spell, now_ns: int) -> str:
    """Return `from commit 1 until commit 3 (for 20 s, until 5 min ago)`."""
    ago = wording.duration((now_ns - (spell.until_ns or now_ns)) / 1e9)
    return f"from {_beginning(spell)} until commit {spell.until} ({_length(spell, now_ns)}, until {ago} ago)"


def _beginning(spell: Spell) -> str:
    return f"commit {spell.since}" if spell.since else "before the history begins"


def _length(spell: Spell, now_ns: int) -> str:
    at_least = "" if spell.since else "at least "
    return f"for {at_least}{wording.duration(_lasted_s(spell, now_ns))}"


def _lasted_s(spell: Spell, now_ns: int) -> float:
    return ((spell.until_ns or now_ns) - spell.since_ns) / 1e9
