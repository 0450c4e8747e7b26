"""The TBox properties that follow from a relation of two objects."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Set
from typing import Final

from semmap.nodes.kb_node.relations.facts.pair_facts import PairFacts
from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.nodes.kb_node.relations.measuring.relation_table import MIRRORED, PAIR_RELATIONS
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple
from semmap.schemas.relations import RelationName

_SUB: Final = v.iri(v.RDFS + "subPropertyOf")
_EQUIVALENT: Final = v.iri(v.OWL + "equivalentProperty")
_INVERSE: Final = v.iri(v.OWL + "inverseOf")
_SYMMETRIC: Final = v.iri(v.OWL + "SymmetricProperty")
_Implication = tuple[Term, bool]
"""A property, and whether subject and object are swapped."""


class PairProperties:
    """The TBox properties that hold for a pair because of its relations."""

    def __init__(self, triples: Iterable[Triple] = ()) -> None:
        """`triples` must contain the TBox. Other triples are ignored."""
        implied: dict[Term, set[_Implication]] = defaultdict(set)
        declared = set[Term]()
        for s, p, o in triples:
            if p == v.RDF_TYPE:
                declared.add(s)
                if o == _SYMMETRIC:
                    implied[s].add((s, True))
            elif p in (_SUB, _EQUIVALENT):
                implied[s].add((o, False))
                if p == _EQUIVALENT:
                    implied[o].add((s, False))
            elif p == _INVERSE:
                implied[s].add((o, True))
                implied[o].add((s, True))
        self._implications: dict[RelationName, frozenset[_Implication]] = {
            relation: _compute_closure(implied, relation, declared) for relation in PAIR_RELATIONS
        }
        self.sources: dict[Term, frozenset[RelationName]] = {
            property_: frozenset(
                r
                for r, implications in self._implications.items()
                if any(p == property_ for p, _ in implications)
            )
            for implications in self._implications.values()
            for property_, _ in implications
        }
        """By property, the relations from which it may follow."""

    def triples(self, fact: Fact, iris: dict[str, Term]) -> Iterator[Triple]:
        """Yield the triples that follow from a fact. `iris` are by name."""
        name, relation, other = fact
        s, o = iris[name], iris[other]
        for property_, is_inverse in self._implications[relation]:
            yield (o, property_, s) if is_inverse else (s, property_, o)

    def holds(self, triple: Triple, pairs: PairFacts, names: dict[Term, str]) -> bool:
        """Return whether a triple follows from measured relations. `names` are by IRI."""
        s, p, o = triple
        name, other = names.get(s), names.get(o)
        if name is None or other is None:
            return False
        return any(
            pairs.holds(*((other, relation, name) if is_inverse else (name, relation, other)))
            for relation in self.sources.get(p, ())
            for property_, is_inverse in self._implications[relation]
            if property_ == p
        )


def _compute_closure(
    implied: dict[Term, set[_Implication]], relation: RelationName, declared: Set[Term]
) -> frozenset[_Implication]:
    own: list[_Implication] = [(v.dm(relation), False)]
    if relation in MIRRORED:
        own.append((v.dm(MIRRORED[relation]), True))
    found = {implication for implication in own if implication[0] in declared}
    waiting = list(found)
    while waiting:
        property_, is_inverse = waiting.pop()
        for further, inverts in implied.get(property_, ()):
            implication = (further, is_inverse != inverts)
            if implication not in found and further.startswith("<"):
                found.add(implication)
                waiting.append(implication)
    return frozenset(found)
