"""The properties whose facts imply facts of other properties: subproperties and inverses."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final, NamedTuple

from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple

_EQUIVALENT: Final = v.iri(f"{v.OWL}equivalentProperty")
_INVERSE: Final = v.iri(f"{v.OWL}inverseOf")
_SYMMETRIC: Final = v.iri(f"{v.OWL}SymmetricProperty")


class Relations(NamedTuple):
    """Some properties, and the properties that imply them."""

    properties: frozenset[Term]
    same: frozenset[Term]
    """The properties themselves, and those whose facts imply a fact with the same subject."""
    reverse: frozenset[Term]
    """Those whose facts imply a fact with the value as its subject."""

    @classmethod
    def of(cls, properties: Iterable[Term], tbox: Iterable[Triple]) -> Relations:
        """Return the relations of `properties` by the axioms of a TBox."""
        properties = frozenset(properties)
        below: dict[Term, list[tuple[Term, bool]]] = {}
        """By property: those that imply it, each with whether it does so in reverse."""
        for s, p, o in tbox:
            if p in (v.RDFS_SUB_PROPERTY_OF, _EQUIVALENT):
                below.setdefault(o, []).append((s, False))
            if p == _EQUIVALENT:
                below.setdefault(s, []).append((o, False))
            elif p == _INVERSE:
                below.setdefault(o, []).append((s, True))
                below.setdefault(s, []).append((o, True))
            elif p == v.RDF_TYPE and o == _SYMMETRIC:
                below.setdefault(s, []).append((s, True))
        found = {(p, False) for p in properties}
        waiting = list(found)
        while waiting:
            p, is_reverse = waiting.pop()
            newest = {(q, is_reverse != flips) for q, flips in below.get(p, ())} - found
            found |= newest
            waiting += newest
        return cls(
            properties,
            same=frozenset(p for p, is_reverse in found if not is_reverse),
            reverse=frozenset(p for p, is_reverse in found if is_reverse),
        )

    def select(self, facts: Iterable[Triple]) -> Iterator[tuple[Term, Term]]:
        """Yield subject and value of each fact of `properties` that one of `facts` is or implies."""
        for s, p, o in facts:
            if p in self.same:
                yield s, o
            if p in self.reverse and not o.startswith('"'):
                yield o, s
