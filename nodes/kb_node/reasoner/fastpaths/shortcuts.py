"""Fast paths for changes that affect no other individual.

The two that robots ask for all day: a thing is removed with all that was said of it, and a number is
replaced by another. Everything else is left to `retraction.Retraction`.
"""

from __future__ import annotations

from collections.abc import Sequence, Set

from nodes.kb_node.reasoner.abox.abox import ABox
from nodes.kb_node.reasoner.abox.adjacency import NONE
from nodes.kb_node.reasoner.abox.store import ASSERTED, DERIVED
from nodes.kb_node.reasoner.explanations import Term, Triple
from nodes.kb_node.reasoner.terms import TYPE

_MOST = 256
"""Edges that are looked at besides those asked for: who has more, as values or computed, is no plain case."""


def depart(abox: ABox, triples: Sequence[Triple]) -> set[Term] | None:
    """Forget individuals of which these are all assertions.

    Who they were; None, with nothing done, where it is not plain.
    """
    store = abox.store
    wanted, subjects = set(triples), {triple[0] for triple in triples}
    going = {store.numbers.get(subject, NONE) for subject in subjects}
    is_doubtful = NONE in going or len(wanted) < len(triples)
    edges = None if is_doubtful else _edges_of(abox, going, wanted)
    if edges is None or not _concern_nobody(abox, going, edges):
        return None
    if abox.spellings:
        literals = [node for node in {store.object[edge] for edge in edges} if abox.is_literal(node)]
        last = [node for node in literals if all(store.subject[e] in going for e in store.into.all(node))]
        for node in last:
            abox.forget_spelling(node)
    store.erase(going, edges)
    return subjects


def _edges_of(abox: ABox, nodes: Set[int], wanted: set[Triple]) -> list[int] | None:
    """The edges that leave from nodes; None if what was asserted of these is not exactly what is wanted."""
    store, classes, axioms = abox.store, abox.schema.classes, abox.schema.axioms
    terms, subject, predicate, object_ = store.terms, store.subject, store.predicate, store.object
    asserted = 0
    for node in nodes:
        for cls in store.kind[node].given:
            if (terms[node], TYPE, classes[cls]) not in wanted:
                return None
            asserted += 1
    most, source = _MOST + 2 * len(wanted), store.source
    edges = store.out.gather(nodes, most)
    if len(edges) > most:
        return None
    for edge in edges:
        if source[edge] == ASSERTED:
            if (terms[subject[edge]], axioms[predicate[edge]].term, terms[object_[edge]]) not in wanted:
                return None
            asserted += 1
    return edges if asserted == len(wanted) else None


def _concern_nobody(abox: ABox, nodes: Set[int], edges: Sequence[int]) -> bool:
    """Whether nothing is otherwise for anybody else without nodes and the edges that leave from them."""
    store, kinds = abox.store, abox.store.kind
    if not abox.equals.keys().isdisjoint(nodes):
        return False
    if not (abox.rest_on_node.keys().isdisjoint(nodes) and abox.rest_on_edge.keys().isdisjoint(edges)):
        return False
    entering = store.into.gather(nodes, len(edges))
    if not nodes >= {store.subject[edge] for edge in entering}:
        return False
    source, object_ = store.source, store.object
    for edge in edges:
        node = object_[edge]
        if source[edge] == DERIVED or (node not in nodes and kinds[node].base is not kinds[node]):
            return False
    return not abox.spellings or abox.equals.keys().isdisjoint(object_[edge] for edge in edges)


def exchange(abox: ABox, delete: Sequence[Triple], insert: Sequence[Triple]) -> set[Term] | None:
    """Replace values by others of their kind, pair by pair.

    Whose values they are; None, with nothing done, where it is not plain.
    """
    if len(delete) != len(insert) or abox.is_mixed:
        return None
    store = abox.store
    found: dict[int, Term] = {}
    for (s, p, old), (subject, predicate, new) in zip(delete, insert, strict=True):
        if s != subject or p != predicate or old[0] != '"' or new[0] != '"':
            return None
        edge = _only_edge(abox, s, p, old)
        if edge == NONE or edge in found:
            return None
        kind, node = store.kind[store.object[edge]], store.numbers.get(new)
        if (abox.kinds.literal(new) if node is None else store.kind[node]) is not kind:
            return None
        found[edge] = new
    for edge, new in found.items():
        store.turn(edge, new)
    return {triple[0] for triple in delete}


def _only_edge(abox: ABox, s: Term, p: Term, o: Term) -> int:
    """The edge of an asserted triple from which nothing follows and which has none beside it; or NONE."""
    store = abox.store
    subject, predicate, literal = store.numbers.get(s), abox.schema.find_property(p), store.numbers.get(o)
    if subject is None or predicate is None or literal is None:
        return NONE
    edge = store.edge(subject, predicate, literal)
    if edge == NONE or store.source[edge] != ASSERTED or not store.out.is_alone(edge):
        return NONE
    if subject in abox.equals or literal in abox.equals or edge in abox.rest_on_edge:
        return NONE
    if abox.spellings and abox.value(literal) in abox.spellings:
        return NONE
    kind = store.kind[literal]
    comes_back = store.kind[subject].values or abox.steps.made_by(predicate)
    return NONE if kind.base is not kind or comes_back or not abox.is_plain(edge) else edge
