"""An ABox in columns that can be written down.

Only of an ABox in which no nodes are the same: what makes them so is not kept. Classes and properties go by
their terms, because another process may number them otherwise.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator

from msgspec import Struct

from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.terms import TYPE

ASSERTED = 0
"""The source of an edge that is asserted."""
Claimed = tuple[int, ...]
"""A claim: a member and its class; or an edge, with the role that it implies, if any (1 for backwards)."""


class KindSaid(Struct, frozen=True, array_like=True):
    """A kind, by the numbers of classes: the given ones, all, and of a literal the excluded datatypes."""

    given: list[int]
    classes: list[int]
    excluded: list[int] | None
    ill_typed: bool
    told: list[Term]
    """The classes that were asserted."""


class Columns(Struct, frozen=True, kw_only=True):
    """The columns of a store, and the reasons of derived edges.

    Those of nodes are as long as `terms`, those of edges as `subject`; see `store.Store`.
    """

    schema: bytes
    """A digest of what it was worked out by."""
    size: int
    """How many triples are asserted, the schema's included."""
    classes: list[Term]
    """By their numbers, as `properties` and `kinds`."""
    properties: list[Term]
    kinds: list[KindSaid]
    reasons: list[tuple[int, list[Claimed]]]
    """Derived edges in the order of their derivation, and what each rests on."""
    terms: list[Term]
    """Those of the nodes; "" for a free one."""
    kind: array[int]
    places: array[int]
    subject: array[int]
    predicate: array[int]
    """`NONE` for a free edge."""
    object: array[int]
    source: bytes
    out: tuple[array[int], ...]
    """Of the edges that leave: heads, after, before, group."""
    into: tuple[array[int], ...]

    def triples(self) -> Iterator[Triple]:
        """The asserted triples but those of the schema, subject by subject."""
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
