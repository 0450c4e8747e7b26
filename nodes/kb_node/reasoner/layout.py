"""What new individuals of one shape leave in the store: worked out once, written down for each."""

from __future__ import annotations

from typing import NamedTuple

from nodes.kb_node.reasoner.kinds import Kind


class NewEdge(NamedTuple):
    """An edge of a layout: its ends by place, its neighbours by their index in the layout or NONE."""

    subject: int
    predicate: int
    object: int
    source: int
    after: int
    before: int
    group: int


class Layout(NamedTuple):
    """New individuals and the edges that leave from them.

    A *place* counts the new individuals first, then the other objects.
    """

    kinds: tuple[Kind, ...]
    """Those of the individuals."""
    others: tuple[Kind, ...]
    """Those of the other objects, which they have already if they are there."""
    edges: tuple[NewEdge, ...]
    heads: tuple[int, ...]
    """The index of each individual's first edge, or NONE."""
