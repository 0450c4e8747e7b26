"""What new individuals of one shape leave in the store: worked out once, written down for each."""

from __future__ import annotations

from typing import NamedTuple

from semmap.nodes.kb_node.reasoner.abox.kinds import Kind


class Layout(NamedTuple):
    """New individuals and the edges that leave from them.

    A *place* counts the new individuals first, then the other objects. Edges are counted, too.
    """

    kinds: tuple[Kind, ...]
    """Those of the individuals."""
    others: tuple[Kind, ...]
    """Those of the other objects, which they have already if they are there."""
    edges: tuple[tuple[int, int, int], ...]
    """The place of the subject, the predicate, the place of the object."""
    values: tuple[int, ...]
    """The edges that come with classes; the others are asserted."""
    heads: tuple[tuple[int, int], ...]
    """The place of an individual, its first edge."""
    groups: tuple[tuple[int, int], ...]
    """The first edge of a group, that of the next group."""
    pairs: tuple[tuple[int, int], ...]
    """An edge, the one after it in its group."""
