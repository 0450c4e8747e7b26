"""An ABox as columns that can be serialised.

This is only possible without equal nodes, because the reasons of equality are not stored. Classes and
properties are stored as terms, because their numbers differ between processes.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator

from msgspec import Struct

from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.terms import TYPE

ASSERTED = 0
"""The source of an asserted edge."""
Claimed = tuple[int, ...]
"""A claim: a node and its class, or an edge with the role that it implies, if any (1 for backwards)."""


class KindSaid(Struct, frozen=True, array_like=True):
    """A kind by class numbers: given classes, all classes, and for a literal the excluded datatypes."""

    given: list[int]
    classes: list[int]
    excluded: list[int] | None
    ill_typed: bool
    told: list[Term]
    """The asserted classes."""


class Columns(Struct, frozen=True, kw_only=True):
    """The columns of a store, and the reasons of derived edges.

    Node columns have the length of `terms`, edge columns that of `subject`; see `store.Store`.
    """

    schema: bytes
    """The digest of the schema."""
    size: int
    """The number of asserted triples, including the schema."""
    classes: list[Term]
    """The class terms by number. `properties` and `kinds` are also in the order of their numbers."""
    properties: list[Term]
    kinds: list[KindSaid]
    reasons: list[tuple[int, list[Claimed]]]
    """Derived edges in the order of derivation, with the claims that each depends on."""
    terms: list[Term]
    """The terms of the nodes; "" for a free row."""
    kind: array[int]
    places: array[int]
    subject: array[int]
    predicate: array[int]
    """`NONE` for a free row."""
    object: array[int]
    source: bytes
    out: tuple[array[int], ...]
    """The links of outgoing edges: heads, after, before, group."""
    into: tuple[array[int], ...]

    def triples(self) -> Iterator[Triple]:
        """Yield the asserted triples without the schema, subject by subject."""
        terms, subject, predicate, object_ = self.terms, self.subject, self.predicate, self.object
        heads, after, _, group = self.out
        for node, first in enumerate(heads):
            for cls in self.kinds[self.kind[node]].told if terms[node] else ():
                yield terms[node], TYPE, cls
            while first != NONE:
                edge = first
                while edge != NONE:
                    if self.source[edge] == ASSERTED:
                        yield terms[subject[edge]], self.properties[predicate[edge]], terms[object_[edge]]
                    edge = after[edge]
                first = group[first]
