"""What a transaction did."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from typing import NamedTuple

from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.fastpaths.shapes import Alike


class Change(NamedTuple):
    """The individuals whose asserted triples or inferred named classes changed.

    Those who came in runs of known shapes are in `alike`; they are among the `others` only if triples
    beside their run changed them, too.
    """

    others: frozenset[Term]
    alike: Sequence[Alike] = ()
    implied: frozenset[Triple] | None = None
    """Of a change of beliefs: the relations of which some came or went, and no others; None if not known, or
    if nobody asked."""

    @classmethod
    def together(cls, changes: Sequence[Change]) -> Change:
        """Several, one after the other, as one."""
        others = frozenset[Term]().union(*(change.others for change in changes))
        return cls(others, tuple(chain.from_iterable(change.alike for change in changes)))

    @property
    def touched(self) -> frozenset[Term]:
        """All of them."""
        return self.others.union(*(stars.touched for stars in self.alike))
