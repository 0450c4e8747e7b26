"""Fast paths for changes that affect no other individual.

The two that robots ask for all day: a thing is removed with all that was said of it, and a number is
replaced by another. Everything else is left to `retraction.Retraction`.
"""

from __future__ import annotations

from collections.abc import Sequence, Set

from semmap.nodes.kb_node.reasoner.abox.abox import ABox
from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE
from semmap.nodes.kb_node.reasoner.abox.store import ASSERTED, DERIVED
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.terms import TYPE

_MOST = 256
"""Edges that are looked at besides those asked for: who has more, as values or computed, is no plain case."""


def remove_individuals(abox: ABox, triples: Sequence[Triple]) -> set[Term] | None:
    """Forget individuals of which these are all assertions.

    Who they were; None, with nothing done, where it is not plain.
    """
    store = abox.store
    wanted, subjects = set(triples), {triple[0] for triple in triples}
    going = {store.numbers.get(subject, NONE) for subject in subjects}
    is_doubtful = NONE in going or len(wanted) < len(triples)
    edges = None if is_doubtful else _edges_of(abox, going, wanted)
    if edges is None or not _are_independent(abox, going, edges):
        return None
    _forget_spellings(abox, going, edges)
    store.erase(going, edges)
    return subjects


def remove_independent(abox: ABox, triples: Sequence[Triple]) -> list[Triple]:
    """Forget those individuals of which it is plain, among very many: the triples that went with them.

    Plain is who is described by these triples alone, concerns nobody who stays, and is not joined to
    somebody of whom it is not plain.
    """
    store, wanted = abox.store, set(triples)
    going = {store.numbers.get(subject, NONE) for subject in {triple[0] for triple in triples}} - {NONE}
    said: dict[int, list[Triple]] = {}
    doubtful = [node for node in going if not _is_plain(abox, node, going, wanted, said)]
    plain = going.difference(doubtful)
    while doubtful:
        node = doubtful.pop()
        others = {store.object[edge] for edge in store.out.all(node)}
        others.update(store.subject[edge] for edge in store.into.all(node))
        others &= plain
        plain -= others
        doubtful += others
    edges = store.out.gather(plain, len(store.predicate))
    _forget_spellings(abox, plain, edges)
    store.erase(plain, edges)
    return [triple for node in plain for triple in said[node]]


def _is_plain(
    abox: ABox, node: int, going: Set[int], wanted: set[Triple], said: dict[int, list[Triple]]
) -> bool:
    """Whether nobody who stays is otherwise without a node, all that is asserted of which is `said`, too."""
    store, schema, kinds = abox.store, abox.schema, abox.store.kind
    if node in abox.equals or node in abox.reasons_by_node:
        return False
    term = store.terms[node]
    mine = said[node] = [(term, TYPE, schema.classes[cls]) for cls in kinds[node].given]
    for edge in store.out.all(node):
        source, other = store.source[edge], store.object[edge]
        if source == DERIVED or edge in abox.reasons_by_edge:
            return False
        if other not in going and (kinds[other].base is not kinds[other] or other in abox.equals):
            return False
        if source == ASSERTED:
            mine.append((term, schema.axioms[store.predicate[edge]].term, store.terms[other]))
    if not wanted.issuperset(mine):
        return False
    return all(store.subject[edge] in going for edge in store.into.all(node))


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


def _are_independent(abox: ABox, nodes: Set[int], edges: Sequence[int]) -> bool:
    """Whether nothing is otherwise for anybody else without nodes and the edges that leave from them."""
    store, kinds = abox.store, abox.store.kind
    if not abox.equals.keys().isdisjoint(nodes):
        return False
    if not (abox.reasons_by_node.keys().isdisjoint(nodes) and abox.reasons_by_edge.keys().isdisjoint(edges)):
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


def _forget_spellings(abox: ABox, nodes: Set[int], edges: Sequence[int]) -> None:
    """Of literals that only these nodes have, by these edges."""
    if not abox.spellings:
        return
    store = abox.store
    for literal in [node for node in {store.object[edge] for edge in edges} if abox.is_literal(node)]:
        if all(store.subject[edge] in nodes for edge in store.into.all(literal)):
            abox.forget_spelling(literal)


def replace_literals(abox: ABox, delete: Sequence[Triple], insert: Sequence[Triple]) -> set[Term] | None:
    """Replace values by others of their kind, pair by pair.

    Whose values they are; None, with nothing done, where it is not plain.
    """
    if len(delete) != len(insert) or abox.has_unknown_equals:
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
        store.replace_literal(edge, new)
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
    if subject in abox.equals or literal in abox.equals or edge in abox.reasons_by_edge:
        return NONE
    if abox.spellings and abox.value(literal) in abox.spellings:
        return NONE
    kind = store.kind[literal]
    comes_back = store.kind[subject].values or abox.steps.producing_chains(predicate)
    return NONE if kind.base is not kind or comes_back or not abox.is_plain(edge) else edge
