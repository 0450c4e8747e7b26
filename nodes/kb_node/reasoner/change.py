"""The effect of a transaction on the individuals."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from typing import NamedTuple

from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.fastpaths.shapes import UniformRuns


class Change(NamedTuple):
    """The individuals whose asserted triples, inferred named classes or equal individuals changed.

    `alike` has the individuals that were added in runs of known shapes. They are also in `others` if triples
    outside their run changed them.
    """

    others: frozenset[Term]
    alike: Sequence[UniformRuns] = ()
    implied: frozenset[Triple] | None = None
    """For an update of computed facts: all relations of which some were added or removed. None if they are
    unknown or were not requested."""

    @classmethod
    def together(cls, changes: Sequence[Change]) -> Change:
        """Return several consecutive changes as one."""
        others = frozenset[Term]().union(*(change.others for change in changes))
        return cls(others, tuple(chain.from_iterable(change.alike for change in changes)))

    @property
    def touched(self) -> frozenset[Term]:
        """All changed individuals."""
        return self.others.union(*(runs.touched for runs in self.alike))
