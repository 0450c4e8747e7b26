"""Rejects commits that violate the SHACL shapes of the TBox."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from itertools import chain
from typing import TYPE_CHECKING, Final

from semmap.nodes.kb_node.derived_facts import DerivedChanges
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.shacl.results import Result
from semmap.nodes.kb_node.shacl.shape_triples import find_shapes
from semmap.ontology import vocabulary as v
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

    def require(self, commit: Commit, derived: DerivedChanges, reasoner: Reasoner) -> None:
        """Raise ViolatesShapes if what the commit touches violates a shape. `reasoner` has the change."""
        if self._shapes is None:
            return
        touched = touched_terms(commit, derived, reasoner)
        if found := self.find_violations(touched, reasoner):
            raise ViolatesShapes(found, touched)

    def find_violations(self, touched: Collection[Term], reasoner: Reasoner) -> list[Result]:
        """Return the violations of individuals, without warnings. Raises BadFile."""
        found = [] if self._shapes is None else self._shapes.validate(reasoner, touched)
        return [result for result in found if result.severity == _VIOLATION]


def touched_terms(commit: Commit, derived: DerivedChanges, reasoner: Reasoner) -> set[Term]:
    """Return the individuals that a commit may make valid or invalid.

    They are those whose facts change, their values, and what refers to them. A path of more steps may lead
    to others, which are not validated.
    """
    core = {v.iri(entity.iri) for entity in commit.changed}
    values = set[Term]()
    for s, p, o in chain(commit.inserted, commit.retracted, *derived):
        core.add(s)
        if p != v.RDF_TYPE and not o.startswith('"'):
            values.add(o)
    referring = {
        s
        for term in core
        for s, _, _ in chain(reasoner.given(None, None, term), reasoner.inferred(None, None, term))
    }
    return core | values | referring
