"""Fast paths for changes that affect no other individual.

The two most frequent ones: an object is removed with all its triples, and a number is replaced by another.
All other deletions are left to `retraction.Retraction`.
"""

from __future__ import annotations

from collections.abc import Sequence, Set

from semmap.nodes.kb_node.reasoner.abox.abox import ABox
from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE
from semmap.nodes.kb_node.reasoner.abox.store import ASSERTED, DERIVED
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.terms import TYPE

_MOST = 256
"""Maximum number of edges beyond the deleted ones (values and computed edges) for a shortcut."""


def remove_individuals(abox: ABox, triples: Sequence[Triple]) -> set[Term] | None:
    """Remove individuals whose assertions are exactly these triples; return the individuals.

    Returns None and changes nothing if other individuals may be affected.
    """
    store = abox.store
    wanted, subjects = set(triples), {triple[0] for triple in triples}
    removed = {store.numbers.get(subject, NONE) for subject in subjects}
    is_doubtful = NONE in removed or len(wanted) < len(triples)
    edges = None if is_doubtful else _edges_of(abox, removed, wanted)
    if edges is None or not _are_independent(abox, removed, edges):
        return None
    _forget_spellings(abox, removed, edges)
    store.erase(removed, edges)
    return subjects


def remove_independent(abox: ABox, triples: Sequence[Triple]) -> list[Triple]:
    """Remove the independent individuals among many, and return their triples.

    An individual is independent if its assertions are all among the triples, if its removal does not affect
    remaining individuals, and if it is not related to a removed individual that is not independent.
    """
    store, wanted = abox.store, set(triples)
    removed = {store.numbers.get(subject, NONE) for subject in {triple[0] for triple in triples}} - {NONE}
    own: dict[int, list[Triple]] = {}
    doubtful = [node for node in removed if not _is_independent(abox, node, removed, wanted, own)]
    independent = removed.difference(doubtful)
    while doubtful:
        node = doubtful.pop()
        others = {store.object[edge] for edge in store.out.all(node)}
        others.update(store.subject[edge] for edge in store.into.all(node))
        others &= independent
        independent -= others
        doubtful += others
    edges = store.out.gather(independent, len(store.predicate))
    _forget_spellings(abox, independent, edges)
    store.erase(independent, edges)
    return [triple for node in independent for triple in own[node]]


def _is_independent(
    abox: ABox, node: int, removed: Set[int], wanted: set[Triple], own: dict[int, list[Triple]]
) -> bool:
    """Return whether removing a node affects no remaining node. Stores its assertions in `own`."""
    store, schema, kinds = abox.store, abox.schema, abox.store.kind
    if node in abox.equals or node in abox.reasons_by_node:
        return False
    term = store.terms[node]
    if term in schema.rule_results:
        return False
    assertions = own[node] = [(term, TYPE, schema.classes[cls]) for cls in kinds[node].given]
    for edge in store.out.all(node):
        source, other = store.source[edge], store.object[edge]
        if source == DERIVED or edge in abox.reasons_by_edge:
            return False
        if other not in removed and (kinds[other].base is not kinds[other] or other in abox.equals):
            return False
        if source == ASSERTED:
            assertions.append((term, schema.axioms[store.predicate[edge]].term, store.terms[other]))
    if not wanted.issuperset(assertions):
        return False
    return all(store.subject[edge] in removed for edge in store.into.all(node))


def _edges_of(abox: ABox, nodes: Set[int], wanted: set[Triple]) -> list[int] | None:
    """Return the outgoing edges of nodes; None if their assertions are not exactly `wanted`."""
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
    """Return whether removing nodes and their outgoing edges affects no other node."""
    store, kinds = abox.store, abox.store.kind
    if not abox.equals.keys().isdisjoint(nodes):
        return False
    results = abox.schema.rule_results  # a rule may imply an edge of them that was asserted, too
    if results and not results.isdisjoint(store.terms[node] for node in nodes):
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
    """Remove the spellings of literals that only these nodes use, by these edges."""
    if not abox.spellings:
        return
    store = abox.store
    for literal in [node for node in {store.object[edge] for edge in edges} if abox.is_literal(node)]:
        if all(store.subject[edge] in nodes for edge in store.into.all(literal)):
            abox.forget_spelling(literal)


def replace_literals(abox: ABox, delete: Sequence[Triple], insert: Sequence[Triple]) -> set[Term] | None:
    """Replace literals by others of the same kind, pair by pair; return their subjects.

    Returns None and changes nothing if the change is not that simple.
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
    """Return the edge of an asserted triple if it implies nothing and is the only one of its predicate."""
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
    may_reappear = store.kind[subject].values or abox.steps.may_be_derived(predicate)
    is_matched = kind.mask & abox.schema.rule_classes
    return NONE if kind.base is not kind or may_reappear or is_matched or not abox.is_plain(edge) else edge
