"""The stored form of new individuals of one shape: computed once, written for each run."""

from __future__ import annotations

from typing import NamedTuple

from semmap.nodes.kb_node.reasoner.abox.kinds import Kind


class Layout(NamedTuple):
    """New individuals and their outgoing edges.

    A *place* is the position of a term: first the new individuals, then the other objects. Edges are also
    referred to by position.
    """

    kinds: tuple[Kind, ...]
    """The kinds of the individuals."""
    others: tuple[Kind, ...]
    """The kinds of the other objects."""
    edges: tuple[tuple[int, int, int], ...]
    """(place of the subject, predicate, place of the object)"""
    values: tuple[int, ...]
    """The edges implied by classes. The others are asserted."""
    heads: tuple[tuple[int, int], ...]
    """(place of an individual, its first edge)"""
    groups: tuple[tuple[int, int], ...]
    """(first edge of a group, first edge of the next group)"""
    pairs: tuple[tuple[int, int], ...]
    """(edge, next edge of its group)"""
