"""What happened to the map between two commits, and when a spatial relation held: read off the journal."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from typing import Final, get_args

from nodes.kb_node.answers.beginnings import Moves
from nodes.kb_node.answers.beginnings import spells as spells_of
from nodes.kb_node.relations.facts.place_facts import Fact, Facts
from nodes.kb_node.relations.measuring.phrases import SPOKEN
from nodes.kb_node.relations.measuring.thresholds import Thresholds
from nodes.kb_node.relations.selection import only_meant
from nodes.kb_node.storage.history import Past
from nodes.kb_node.storage.journal import Journal
from schemas import errors, wording
from schemas.changes import Change, between, removed
from schemas.commands import Diff, WasWhen
from schemas.entities import Entity
from schemas.happenings import Difference, KeptRelation, Related, Spell, Spells
from schemas.relations import RelationName

_KEPT: Final[dict[RelationName, KeptRelation]] = {name: name for name in get_args(KeptRelation)}
_LONGEST = 10
"""Spells that are told one by one in words."""


def difference(past: Past, query: Diff, limits: Thresholds) -> Difference:
    """What is otherwise after `query.until` than after `query.since`. Raises Refused, BadRequest."""
    first = past.commit_at(query.since)
    last = past.last if query.until is None else past.commit_at(query.until)
    if first > last:
        raise errors.BadRequest(f"commit {first} comes after commit {last}; give the earlier one first")
    then, now = ({entity.name: entity for entity in past.entities(seq)} for seq in (first, last))
    changes: list[Change] = []
    for name in sorted(then.keys() | now.keys()):
        if name in now:
            changes += between(then.get(name), now[name])
        else:
            changes.append(removed(name, then[name].class_))
    was, is_ = (_facts(there.values(), limits) for there in (then, now))
    differing = sorted([(fact, False) for fact in was - is_] + [(fact, True) for fact in is_ - was])
    relations = tuple(
        Related(subject=s, relation=_KEPT[relation], object=o, came=came, text=_said(relation, came, o))
        for (s, relation, o), came in differing
    )
    return Difference(first=first, last=last, changes=tuple(changes), relations=relations)


def _said(relation: RelationName, came: bool, other: str) -> str:
    words = SPOKEN[relation]
    return f"{words if came else words.replace('is ', 'is no longer ', 1)} {other}"


def _facts(there: Iterable[Entity], limits: Thresholds) -> set[Fact]:
    facts = Facts(limits)
    for _ in facts.filling(there):
        pass
    return set(facts)


def spells(journal: Journal, past: Past, query: WasWhen, limits: Thresholds) -> Spells:
    """When the relation held. Raises UnknownName, BadRequest for a word that several things have."""
    there = {entity.name: entity for entity in past.entities(past.last)} if past.last else {}
    one, other = (_name(word, there, past) for word in (query.name, query.other))
    fact = (one, query.relation, other)
    found = spells_of(journal.outlines(Moves), past.at_the_beginning().values(), [fact], limits)[fact]
    told = tuple(
        Spell(
            since=since,
            since_ns=journal.stamps.of(max(since, journal.first)),
            until=until,
            until_ns=None if until is None else journal.stamps.of(until),
        )
        for since, until in found
    )
    now_ns = time.time_ns()
    total_s = sum(((spell.until_ns or now_ns) - spell.since_ns) / 1e9 for spell in told)
    return Spells(
        subject=one,
        relation=query.relation,
        object=other,
        spells=told,
        total_s=total_s,
        text=_in_words(f"{one} {SPOKEN[query.relation]} {other}", told, total_s),
    )


def _name(word: str, there: Mapping[str, Entity], past: Past) -> str:
    """The entity that a word names: by its name, now or ever, else by reference or class."""
    if word in there or past.knows(word):
        return word
    return only_meant(tuple(there.values()), word)


def _in_words(said: str, told: tuple[Spell, ...], total_s: float) -> str:
    """`cup1 is on table1 since commit 4; before, from commit 1 until commit 3; 2 times, 4 min in all`."""
    if not told:
        return f"it was never so that {said}"
    *before, last = told
    spans = [f"from {_commit(spell)} until commit {spell.until}" for spell in told if spell.until is not None]
    shown = spans if len(spans) <= _LONGEST else [*spans[:3], f"{len(spans) - 6} more", *spans[-3:]]
    times = "once" if len(told) == 1 else f"{len(told)} times"
    length = f"{times}, for {wording.duration(total_s)} in all"
    if last.until is None:
        earlier = f"; before that {', '.join(shown)}" if before else ""
        return f"{said} since {_commit(last)}{earlier}; {length}"
    return f"{said} no longer; it was so {', '.join(shown)}; {length}"


def _commit(spell: Spell) -> str:
    return f"commit {spell.since}" if spell.since else "before the history begins"
