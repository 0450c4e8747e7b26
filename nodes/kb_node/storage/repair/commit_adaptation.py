"""Adaptation of a commit to a map in which an earlier commit is missing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from msgspec import structs

from semmap.nodes.kb_node.entities import entity_writing
from semmap.nodes.kb_node.map_state import MapState
from semmap.ontology import vocabulary as v
from semmap.schemas.commits import Commit
from semmap.schemas.explanations import Term, Triple


class DoesNotFit(Exception):
    """The commit changes something that is missing."""


def adapt_commit(state: MapState, commit: Commit) -> Commit:
    """Return `commit` with the changes that have the same result in the current map, without effects.

    Removed entities are removed as they are now. A replaced single value may have another old value now.
    Raises DoesNotFit if something else is missing, or nothing remains to be done. A commit with a new TBox
    always fits.
    """
    if commit.tbox:
        return structs.replace(commit, changed=(), removed=(), digest="")
    inserted = tuple(t for t in commit.inserted if not state.is_asserted(t))
    retracted = dict.fromkeys(_retracted(state, commit))
    retracted = {t: None for t in retracted if t not in set(commit.inserted)}
    _require_what_it_describes(state, commit)
    if not inserted and not retracted and (commit.inserted or commit.retracted):
        raise DoesNotFit
    return structs.replace(
        commit, inserted=inserted, retracted=tuple(retracted), changed=(), removed=(), digest=""
    )


def _retracted(state: MapState, commit: Commit) -> list[Triple]:
    replaced = _pairs(commit.retracted)
    replacing = _pairs(commit.inserted)
    found: list[Triple] = []
    for triple in commit.retracted:
        if state.is_asserted(triple):
            found.append(triple)
            continue
        pair = triple[:2]
        now = list(state.reasoner.asserted(*pair, None))
        if replaced[pair] == replacing[pair] == len(now) == 1:
            found += now
        elif not commit.removed:
            raise DoesNotFit
    leaving = [state.by_name[gone.name] for gone in commit.removed if gone.name in state.by_name]
    if leaving:
        draft = entity_writing.Draft(state.reasoner, state.classes, state.tbox, state.by_name)
        draft.remove(leaving)
        found += draft.retract
    return found


def _pairs(triples: Sequence[Triple]) -> Counter[tuple[Term, Term]]:
    """Return the number of values of each property of each individual."""
    return Counter((s, p) for s, p, _ in triples)


def _require_what_it_describes(state: MapState, commit: Commit) -> None:
    typed = {s for s, p, _ in commit.inserted if p == v.RDF_TYPE}
    for entity in commit.changed:
        if entity.name not in state.by_name and v.iri(entity.iri) not in typed:
            raise DoesNotFit
