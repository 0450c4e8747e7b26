"""Computes which triples a transaction removes and adds, and the notes about it."""

from __future__ import annotations

import time
from collections.abc import Collection
from typing import Final, NamedTuple

import numpy as np
from msgspec import structs

from semmap.nodes.kb_node import preconditions
from semmap.nodes.kb_node.entities import entity_writing
from semmap.nodes.kb_node.map_state import MapState
from semmap.ontology import vocabulary as v
from semmap.schemas import agents, errors, wording
from semmap.schemas.commits import Commit, Edit, Transaction
from semmap.schemas.entities import Entity
from semmap.schemas.explanations import Triple

_VERY_MANY: Final = 100_000
"""Number of triples."""


class Plan(NamedTuple):
    """The triples that a transaction removes, which all exist, and adds, none of which exists."""

    retracted: tuple[Triple, ...]
    inserted: tuple[Triple, ...]
    notes: tuple[str, ...]
    """Messages for the client."""


def make_plan(state: MapState, transaction: Transaction) -> Plan | None:
    """Return what a transaction changes, or None if it changes nothing.

    Raises PreconditionFailed, NameTaken, BadRequest for invalid content, UnknownName for an entity that does
    not exist, and Refused if it removes triples of the TBox or changes reserved properties.
    """
    if transaction.unchanged:
        preconditions.require_unchanged(transaction, state.by_name)
    retract, insert, notes = _expand_intents(state, transaction)
    if transaction.others:
        others, count = _find_others(state)
        retract = dict.fromkeys((*retract, *others))
        if count:
            notes = [*notes, f"also removed {wording.counted(count, 'individual')} without a place in space"]
    asserted = preconditions.find_asserted(
        state.reasoner, (transaction.require, retract, insert), state.progress
    )
    preconditions.require(transaction, asserted)
    wanted = set(insert) if retract else frozenset[Triple]()
    retracted = tuple([t for t in dict.fromkeys(retract) if t not in wanted and t in asserted])
    inserted = _unique(insert)
    if asserted:
        inserted = tuple([t for t in inserted if t not in asserted])
    if not retracted and not inserted:
        return None
    preconditions.require_unreserved(transaction, state.by_name, (*inserted, *retracted), state.reasoner)
    denied = state.places.find_denied_locations(state.reasoner, state.classes, retracted, inserted)
    if denied.triples:
        wanted = wanted or set(insert)
        retracted += tuple(t for t in denied.triples if t not in state.tbox and t not in wanted)
    for triple in retracted:
        if triple in state.tbox:
            raise errors.Refused(
                f"the TBox states that {v.to_words(triple)}, and commands cannot change the TBox"
            )
    return Plan(retracted, inserted, (*notes, *denied.notes))


def _unique(triples: Collection[Triple]) -> tuple[Triple, ...]:
    """Return the triples without duplicates, in their order.

    For very many triples their hashes are compared first, which takes a tenth of the memory.
    """
    if isinstance(triples, dict):
        return tuple(triples)
    if len(triples) < _VERY_MANY:
        return tuple(dict.fromkeys(triples))
    hashes = np.fromiter(map(hash, triples), np.int64, len(triples))
    hashes.sort()
    differ = bool((hashes[1:] != hashes[:-1]).all())
    return tuple(triples) if differ else tuple(dict.fromkeys(triples))


def make_commit(transaction: Transaction, plan: Plan, seq: int, *, tbox: bool = False) -> Commit:
    """Return commit `seq` of a plan by the transaction's author, without effects and digest."""
    return Commit(
        seq=seq,
        stamp_ns=time.time_ns(),
        id=transaction.id,
        source=transaction.source,
        agent=agents.name_of(transaction.agent),
        authenticated=agents.is_proved(transaction.agent),
        verb=transaction.verb,
        reason=transaction.reason,
        confidence=transaction.confidence,
        undoes=transaction.undoes,
        tbox=tbox,
        retracted=plan.retracted,
        inserted=plan.inserted,
        notes=plan.notes,
    )


def _find_others(state: MapState) -> tuple[list[Triple], int]:
    """Return all asserted triples but the header of the map, and the number of individuals without a place.

    Individuals that only describe an entity are not counted.
    """
    triples = [t for t in state.abox() if t[0] != v.ABOX_ONTOLOGY]
    return triples, len(state.individuals.terms()) if triples else 0


def _expand_intents(
    state: MapState, transaction: Transaction
) -> tuple[Collection[Triple], Collection[Triple], list[str]]:
    """Return the triples that a transaction removes and adds, with its edits as triples, and notes."""
    remove, edit, add = transaction.remove, transaction.edit, transaction.add
    if not (remove or edit or add):
        return transaction.retract, transaction.insert, []
    draft = entity_writing.Draft(
        state.reasoner, state.classes, state.tbox, state.by_name, state.individuals.find_term
    )
    notes: list[str] = []
    if remove:
        leaving = [state.described(name) for name in state.with_progress(remove)]
        draft.remove(leaving)
        notes += state.places.describe_left_behind([entity.name for entity in leaving if entity.in_space])
    for one in state.with_progress(edit):
        entity = state.described(one.name)
        if not entity.in_space:
            _require_no_place(entity, one)
        draft.edit(entity, one)
        if one.carry:
            load = state.places.load_edits(one, edit)
            for other in load:
                draft.edit(state.by_name[other.name], other)
            if load or transaction.source == "operator":
                notes.append(wording.carried(one.name, [other.name for other in load], one.leave))
    for new in state.with_progress(add):
        draft.add(new)
    if not (transaction.retract or transaction.insert):
        return draft.retract, draft.insert, notes
    return [*transaction.retract, *draft.retract], [*transaction.insert, *draft.insert], notes


def _require_no_place(individual: Entity, edit: Edit) -> None:
    """Raise Refused if an edit gives an individual that is not in space what only entities have."""
    properties = structs.replace(edit, set=(), unset=(), only_if=())
    if structs.replace(properties, rename=None, class_iri=None, ref=None, alt=None) != Edit(name=edit.name):
        raise errors.Refused(
            f"{individual.name} is not in space, so only its class, labels, properties and name can be"
            f" changed; see: semmap set {individual.name} PROPERTY VALUE"
        )
