"""The interface to the fast paths. They can be disabled; then the rules are applied to every change."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from semmap.nodes.kb_node.reasoner.abox.abox import ABox
from semmap.nodes.kb_node.reasoner.abox.store import COMPUTED
from semmap.nodes.kb_node.reasoner.explain.proof import Proof
from semmap.nodes.kb_node.reasoner.explanations import Explanation, Term, Triple
from semmap.nodes.kb_node.reasoner.fastpaths.many_edges import ManyEdges
from semmap.nodes.kb_node.reasoner.fastpaths.shapes import Contradiction, KnownShape, Shapes, UniformRuns
from semmap.nodes.kb_node.reasoner.fastpaths.shortcuts import (
    remove_independent,
    remove_individuals,
    replace_literals,
)

MANY = 32
"""Number of computed facts from which they are inserted column by column."""
MANY_DELETED = 1000
"""Number of deleted triples from which independent individuals are removed first."""
ApplyRules = Callable[[Sequence[Triple]], None]
"""Inserts triples and draws all conclusions by the rules."""
Insert = Callable[[Triple, int], bool]
"""Inserts a triple from a source and returns whether it is new. Does not run the rules."""


class KnownContradiction(Exception):
    """Triples of a shape that is known to be contradictory."""

    def __init__(self, explanation: Explanation) -> None:
        super().__init__(explanation.text)
        self.explanation = explanation


class NoFastPaths:
    """No fast paths: the rules are applied to every change."""

    def apply_independent(self, delete: Sequence[Triple], insert: Sequence[Triple]) -> set[Term] | None:
        """Apply a change with deletions that affects no other individuals; return the changed individuals.

        Returns None and changes nothing if it may affect others.
        """
        return None

    def remove_individuals(self, triples: Sequence[Triple]) -> list[Triple]:
        """Delete those of many triples that affect no other individuals, and return them."""
        return []

    def insert(
        self, triples: Sequence[Triple], apply_rules: ApplyRules, added: list[Triple]
    ) -> list[UniformRuns]:
        """Insert triples. Runs of known shapes are stored directly, appended to `added`, and returned.

        `apply_rules` is called for the others.

        Raises:
            KnownContradiction: the triples are known to contradict each other; nothing was changed.
        """
        if triples:
            apply_rules(triples)
        return []

    def compute(self, triples: Sequence[Triple], insert: Insert, added: list[Triple]) -> None:
        """Insert computed triples and append the new ones to `added`. Does not run the rules."""
        for triple in triples:
            if insert(triple, COMPUTED):
                added.append(triple)

    def note_rejection(self, triples: Sequence[Triple], proof: Proof, terms: Sequence[Term]) -> None:
        """Remember triples that were rejected, with their proof, in which `terms` can be replaced."""


class FastPaths(NoFastPaths):
    """Fast paths for known shapes, and for changes that affect no other individuals."""

    def __init__(self, abox: ABox) -> None:
        self._abox = abox
        self._edges = ManyEdges(abox)
        self.shapes = Shapes(abox)

    def apply_independent(self, delete: Sequence[Triple], insert: Sequence[Triple]) -> set[Term] | None:
        """See `NoFastPaths`."""
        return (
            replace_literals(self._abox, delete, insert) if insert else remove_individuals(self._abox, delete)
        )

    def remove_individuals(self, triples: Sequence[Triple]) -> list[Triple]:
        """See `NoFastPaths`."""
        return remove_independent(self._abox, triples) if len(triples) >= MANY_DELETED else []

    def insert(
        self, triples: Sequence[Triple], apply_rules: ApplyRules, added: list[Triple]
    ) -> list[UniformRuns]:
        """See `NoFastPaths`. Known shapes are stored run by run, the other triples are inserted together."""
        shapes, at = self.shapes, 0
        alike: list[UniformRuns] = []
        rest: list[Triple] = []
        while at < len(triples):
            stored, end = (
                ([], len(triples)) if self._abox.has_unknown_equals else shapes.write_all(triples, at)
            )
            if stored:
                added += triples[at:end]
                alike += stored
                at = end
                continue
            for run in shapes.runs(triples, at, end):
                at += len(run.triples)
                has_unknown_equals = self._abox.has_unknown_equals
                form = run.form
                known = None if has_unknown_equals or form is None else shapes.known.get(run.shape, run)
                if form is not None and isinstance(known, KnownShape) and shapes.write(known, run):
                    added += run.triples
                    alike.append(UniformRuns(known, form, list(zip(run.individuals)), list(zip(run.others))))
                elif known is run:
                    apply_rules(run.triples)
                    shapes.learn(run)
                elif isinstance(known, Contradiction) and not added:
                    raise KnownContradiction(known.of(run))
                else:
                    rest += run.triples
        if rest:
            apply_rules(rest)
        return alike

    def compute(self, triples: Sequence[Triple], insert: Insert, added: list[Triple]) -> None:
        """See `NoFastPaths`. Many triples are stored column by column."""
        if len(triples) >= MANY and not (self._abox.equals or self._abox.has_unknown_equals):
            stored, triples = self._edges.insert(triples, COMPUTED)
            added += stored
        super().compute(triples, insert, added)

    def note_rejection(self, triples: Sequence[Triple], proof: Proof, terms: Sequence[Term]) -> None:
        """See `NoFastPaths`."""
        self.shapes.note_rejection(triples, proof, terms)
