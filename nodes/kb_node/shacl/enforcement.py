"""Rejects commits that violate the SHACL shapes of the TBox."""

from __future__ import annotations

import logging
from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING, Final

from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.shacl.results import Result
from semmap.nodes.kb_node.shacl.shape_triples import find_cycle, find_shapes, select_shapes
from semmap.nodes.kb_node.shacl.touched_individuals import Reach, TouchedIndividuals
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commits import Commit
from semmap.schemas.explanations import Term, Triple

if TYPE_CHECKING:  # pySHACL takes half a second to import
    from semmap.nodes.kb_node.shacl.shapes import Shapes

_VIOLATION: Final = "violation"
_MOST_FAILURES: Final = 100
"""The maximum number of errors that are logged."""

_LONGEST_TEXT: Final = 500

log = logging.getLogger(__name__)


class ViolatesShapes(Exception):
    """A commit with facts that violate shapes."""

    def __init__(self, results: list[Result], touched: set[Term] | None) -> None:
        """Create it; `touched` are the individuals that were validated, or None for all of the map."""
        super().__init__()
        self.results = results
        self.touched = touched


class ShapeEnforcement:
    """Validates what a commit touches against the shapes of a TBox."""

    def __init__(self, tbox: Iterable[Triple], *, is_stored: bool = False) -> None:
        """Read the shapes. Raises BadFile for those that are invalid or refer to themselves.

        Those of a stored map are logged instead: it must start, and then its TBox can be corrected.
        """
        tbox = list(tbox)
        self._shapes: Shapes | None = None
        self._reach = Reach.of(tbox)
        self._failures = set[str]()
        """The errors that have been logged."""
        if find_shapes(tbox):
            from semmap.nodes.kb_node.shacl.shapes import Shapes

            try:
                self._shapes = Shapes(tbox, "the TBox")
                _require_evaluable(self._shapes, tbox)
            except errors.BadFile as error:
                if not is_stored:
                    raise
                self._log_failure(error.text)

    def begin(self, commit: Commit, reasoner: Reasoner) -> TouchedIndividuals | None:
        """Prepare to find what a commit touches, before `reasoner` has it. Return None without shapes."""
        return None if self._shapes is None else TouchedIndividuals(commit, reasoner, self._reach)

    def require(self, touched: set[Term] | None, reasoner: Reasoner) -> None:
        """Raise ViolatesShapes if an individual that a commit touches, or any one, violates a shape."""
        if found := self.find_violations(touched, reasoner):
            raise ViolatesShapes(found, touched)

    def find_violations(self, touched: Collection[Term] | None, reasoner: Reasoner) -> list[Result]:
        """Return the violations of some individuals, or of all, without warnings.

        A shape that cannot be evaluated, for example because of the depth of the facts, is logged. It must
        not make the individuals unchangeable.
        """
        found = [] if self._shapes is None else self._shapes.validate(reasoner, touched, self._log_failure)
        return [result for result in found if result.severity == _VIOLATION]

    def _log_failure(self, text: str) -> None:
        """Log an error once."""
        text = errors.shortened(text, _LONGEST_TEXT)
        if text not in self._failures and len(self._failures) < _MOST_FAILURES:
            self._failures.add(text)
            log.warning("%s; it is not enforced", text)


def _require_evaluable(shapes: Shapes, tbox: Iterable[Triple]) -> None:
    """Raise BadFile for shapes that refer to themselves or cannot be evaluated."""
    if cycle := find_cycle(select_shapes(tbox)):
        name = next((v.local_name(term) for term in cycle if term.startswith("<")), "a shape")
        raise errors.BadFile(f"the TBox: invalid SHACL shape: {name} refers to itself")
    shapes.require_evaluable()
