"""What relations of two things are called in a TBox: their properties, and those that these imply."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Set
from typing import Final

from semmap.nodes.kb_node.relations.facts.pair_facts import MIRRORED, PairFacts
from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple
from semmap.schemas.relations import RelationName

_SUB: Final = v.iri(v.RDFS + "subPropertyOf")
_EQUIVALENT: Final = v.iri(v.OWL + "equivalentProperty")
_INVERSE: Final = v.iri(v.OWL + "inverseOf")
_SYMMETRIC: Final = v.iri(v.OWL + "SymmetricProperty")
_Way = tuple[Term, bool]
"""A property, and whether it is told of the other thing."""


class PairProperties:
    """The properties that hold of a pair by its relations, of those that a TBox declares."""

    def __init__(self, triples: Iterable[Triple] = ()) -> None:
        """`triples` has the TBox's; others do not matter."""
        implied: dict[Term, set[_Way]] = defaultdict(set)
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
        self._ways: dict[RelationName, frozenset[_Way]] = {
            relation: _closed(implied, relation, declared) for relation in MIRRORED
        }
        self.sources: dict[Term, frozenset[RelationName]] = {
            property_: frozenset(r for r, ways in self._ways.items() if any(p == property_ for p, _ in ways))
            for ways in self._ways.values()
            for property_, _ in ways
        }
        """By property, of which relations it may follow."""

    def triples(self, fact: Fact, iris: dict[str, Term]) -> Iterator[Triple]:
        """What holds of a pair by one of its relations. `iris` by the things' names."""
        name, relation, other = fact
        s, o = iris[name], iris[other]
        for property_, is_turned in self._ways[relation]:
            yield (o, property_, s) if is_turned else (s, property_, o)

    def holds(self, triple: Triple, pairs: PairFacts, names: dict[Term, str]) -> bool:
        """Whether a triple holds by what is measured. `names` by IRI."""
        s, p, o = triple
        name, other = names.get(s), names.get(o)
        if name is None or other is None:
            return False
        return any(
            pairs.holds(*((other, relation, name) if is_turned else (name, relation, other)))
            for relation in self.sources.get(p, ())
            for property_, is_turned in self._ways[relation]
            if property_ == p
        )


def _closed(implied: dict[Term, set[_Way]], relation: RelationName, declared: Set[Term]) -> frozenset[_Way]:
    own, mirrored = v.dm(relation), v.dm(MIRRORED[relation])
    found: set[_Way] = {way for way in ((own, False), (mirrored, True)) if way[0] in declared}
    waiting = list(found)
    while waiting:
        property_, is_turned = waiting.pop()
        for further, turns in implied.get(property_, ()):
            way = (further, is_turned != turns)
            if way not in found and further.startswith("<"):
                found.add(way)
                waiting.append(way)
    return frozenset(found)
