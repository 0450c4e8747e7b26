"""Finds the individuals that a commit may make valid or invalid."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import chain

from semmap.nodes.kb_node.derived_facts import DerivedChanges
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import vocabulary as v
from semmap.schemas.commits import Commit
from semmap.schemas.explanations import Term, Triple


class TouchedIndividuals:
    """Finds the individuals that a commit touches. It is created before the reasoner has the change.

    They are those whose facts or classes change, their values, and what refers to them. A fact that follows
    from a chain may change without them: the facts about both ends of each changed triple are compared. A
    path of more steps may lead to other individuals, which are not found.
    """

    def __init__(self, commit: Commit, reasoner: Reasoner) -> None:
        """Read the facts about the individuals of the commit."""
        self._reasoner = reasoner
        subjects, values = _ends(chain(commit.inserted, commit.retracted))
        self._ends = subjects | _individuals(values)
        self._before = self._facts_about(self._ends)
        self._reclassified = set[Term]()

    def add_reclassified(self, terms: Iterable[Term]) -> None:
        """Add individuals whose classes or equal individuals have changed."""
        self._reclassified.update(terms)

    def find(self, commit: Commit, derived: DerivedChanges) -> set[Term]:
        """Return the individuals and values. The reasoner has the change, and the commit its entities."""
        subjects, values = _ends(chain(commit.inserted, commit.retracted, *derived))
        core = subjects | self._reclassified | {v.iri(entity.iri) for entity in commit.changed}
        after = self._facts_about(self._ends)
        referring = {s for s, _, o in self._before | after if o in core}
        referring.update(s for s, _, _ in self._before ^ after)
        referring.update(s for s, _, _ in self._facts_about(core - self._ends))
        return core | values | referring

    def _facts_about(self, terms: Iterable[Term]) -> set[Triple]:
        """Return the facts whose value is one of `terms`."""
        reasoner = self._reasoner
        return {
            fact
            for term in terms
            for fact in chain(reasoner.given(None, None, term), reasoner.inferred(None, None, term))
        }


def _ends(triples: Iterable[Triple]) -> tuple[set[Term], set[Term]]:
    """Return the subjects of triples, and their values, which include literals but not classes."""
    subjects, values = set[Term](), set[Term]()
    for s, p, o in triples:
        subjects.add(s)
        if p != v.RDF_TYPE:
            values.add(o)
    return subjects, values


def _individuals(values: Iterable[Term]) -> set[Term]:
    return {term for term in values if not term.startswith('"')}
