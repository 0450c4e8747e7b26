"""Checks whether a transaction still fits the map, and which of its triples are asserted already."""

from __future__ import annotations

from collections.abc import Callable, Collection, Container, Iterable, Mapping
from itertools import chain, islice
from operator import itemgetter

from semmap.nodes.kb_node.progress import with_progress
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commits import Transaction
from semmap.schemas.entities import Entity
from semmap.schemas.explanations import Term, Triple

_FEW = 64
"""Up to this number, the triples of a subject are read at once; beyond it, each triple is looked up."""

_FEW_OF_ALL = 8
"""Triples are many if they are more than one in this number."""
_FEW_AT_ALL = 1000


def subjects(*groups: Iterable[Triple]) -> set[Term]:
    """Return the subjects of all triples."""
    return set(map(itemgetter(0), chain(*groups)))


def is_large_share(groups: Iterable[Collection[Triple]], reasoner: Reasoner) -> bool:
    """Return whether it is faster to scan all asserted triples than to look these up."""
    return sum(map(len, groups)) > max(_FEW_AT_ALL, len(reasoner) // _FEW_OF_ALL)


def find_asserted(
    reasoner: Reasoner, groups: Iterable[Collection[Triple]], progress: Callable[[], None] = lambda: None
) -> set[Triple]:
    """Return those of the triples that are asserted already. `progress` is called now and then."""
    groups = tuple(groups)
    known = reasoner.mentioned(subjects(*groups))
    if not known:
        return set()
    named = {t for triples in groups for t in triples if t[0] in known}
    if is_large_share((named,), reasoner):
        return named.intersection(chain.from_iterable(with_progress(reasoner.by_subject(), progress)))
    found: set[Triple] = set()
    many: set[Term] = set()
    for subject in with_progress(known, progress):
        asserted = list(islice(reasoner.asserted(subject), _FEW))
        found.update(asserted)
        if len(asserted) == _FEW:
            many.add(subject)
    return {t for t in named if t in found or (t[0] in many and any(reasoner.asserted(*t)))}


def require(transaction: Transaction, held: Container[Triple]) -> None:
    """Raise PreconditionFailed for a required triple that is not in `held`."""
    for triple in transaction.require:
        if triple not in held:
            raise errors.PreconditionFailed(f"it no longer holds that {v.to_words(triple)}; repeat the query")


def require_unchanged(transaction: Transaction, entities: Mapping[str, Entity]) -> None:
    """Raise PreconditionFailed if an entity that must be unchanged was removed or changed."""
    for name in transaction.unchanged:
        if (entity := entities.get(name)) is None:
            raise errors.PreconditionFailed(f"{name} has been removed from the map; repeat the query")
        if (commit := entity.provenance.commit) > transaction.since:
            raise errors.PreconditionFailed(
                f"{name} was changed by commit {commit}, after commit {transaction.since}; repeat the query"
            )


def require_unreserved(
    transaction: Transaction, entities: Mapping[str, Entity], triples: Iterable[Triple], reasoner: Reasoner
) -> None:
    """Raise Refused if triples that a transaction changes state or imply a reserved property."""
    reserved = {
        (v.iri(entity.iri), property_): (name, one.why)
        for one in transaction.reserved
        for name in one.names
        if (entity := entities.get(name)) is not None
        for property_ in one.properties
    }
    if not reserved:
        return
    for s, p, o in triples:
        for property_, is_swapped in _implied(p, reasoner):
            name = v.local_name(property_)
            if found := reserved.get((o if is_swapped else s, name)):
                raise errors.Refused(f"{name} of {found[0]} {found[1].replace('{name}', found[0])}")


def _implied(property_: Term, reasoner: Reasoner) -> set[tuple[Term, bool]]:
    """Return the properties that a property implies, and whether they swap subject and object."""
    found: set[tuple[Term, bool]] = set()
    pending = [(property_, False)]
    while pending:
        if (role := pending.pop()) in found:
            continue
        found.add(role)
        p, is_swapped = role
        wider = chain(*(find(p, v.RDFS_SUB_PROPERTY_OF) for find in (reasoner.asserted, reasoner.inferred)))
        pending += ((t[2], is_swapped) for t in wider)
        pending += ((t[2], not is_swapped) for t in reasoner.asserted(p, v.OWL_INVERSE_OF))
        pending += ((t[0], not is_swapped) for t in reasoner.asserted(None, v.OWL_INVERSE_OF, p))
    return found
