"""Rejects commits that violate the SHACL shapes of the TBox."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING, Final

from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.shacl.results import Result
from semmap.nodes.kb_node.shacl.shape_triples import find_shapes
from semmap.nodes.kb_node.shacl.touched_individuals import TouchedIndividuals
from semmap.schemas.commits import Commit
from semmap.schemas.explanations import Term, Triple

if TYPE_CHECKING:  # pySHACL takes half a second to import
    from semmap.nodes.kb_node.shacl.shapes import Shapes

_VIOLATION: Final = "violation"


class ViolatesShapes(Exception):
    """A commit with facts that violate shapes."""

    def __init__(self, results: list[Result], touched: set[Term]) -> None:
        """Create it; `touched` are the individuals that were validated."""
        super().__init__()
        self.results = results
        self.touched = touched


class ShapeEnforcement:
    """Validates what a commit touches against the shapes of a TBox."""

    def __init__(self, tbox: Iterable[Triple]) -> None:
        """Read the shapes. Raises BadFile for invalid ones."""
        tbox = list(tbox)
        self._shapes: Shapes | None = None
        if find_shapes(tbox):
            from semmap.nodes.kb_node.shacl.shapes import Shapes

            self._shapes = Shapes(tbox, "the TBox")

    def begin(self, commit: Commit, reasoner: Reasoner) -> TouchedIndividuals | None:
        """Prepare to find what a commit touches, before `reasoner` has it. Return None without shapes."""
        return None if self._shapes is None else TouchedIndividuals(commit, reasoner)

    def require(self, touched: set[Term], reasoner: Reasoner) -> None:
        """Raise ViolatesShapes if an individual that a commit touches violates a shape."""
        if found := self.find_violations(touched, reasoner):
            raise ViolatesShapes(found, touched)

    def find_violations(self, touched: Collection[Term], reasoner: Reasoner) -> list[Result]:
        """Return the violations of individuals, without warnings. Raises BadFile."""
        found = [] if self._shapes is None else self._shapes.validate(reasoner, touched)
        return [result for result in found if result.severity == _VIOLATION]
