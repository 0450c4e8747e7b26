"""The fast paths behind one interface, which can be switched off: then the rules work every change out."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from semmap.nodes.kb_node.reasoner.abox.abox import ABox
from semmap.nodes.kb_node.reasoner.abox.store import COMPUTED
from semmap.nodes.kb_node.reasoner.explain.proof import Proof
from semmap.nodes.kb_node.reasoner.explanations import Explanation, Term, Triple
from semmap.nodes.kb_node.reasoner.fastpaths.many_edges import ManyEdges
from semmap.nodes.kb_node.reasoner.fastpaths.shapes import Alike, Contradiction, Shapes, Written
from semmap.nodes.kb_node.reasoner.fastpaths.shortcuts import depart, depart_among, exchange

MANY = 32
"""Computed facts that are worth being taken together."""
MANY_GO = 1000
"""Triples that are deleted: of so many, those who go without concerning anybody are told apart first."""
WorkOut = Callable[[Sequence[Triple]], None]
"""Inserts triples and draws all conclusions, by the rules."""
Insert = Callable[[Triple, int], bool]
"""Inserts a triple from a source, and tells whether it is new; the rules are yet to be run."""


class Known(Exception):
    """Triples that contradict each other as others of their shape did."""

    def __init__(self, explanation: Explanation) -> None:
        super().__init__(explanation.text)
        self.explanation = explanation


class PlainPaths:
    """No fast paths: every change is worked out."""

    def change(self, delete: Sequence[Triple], insert: Sequence[Triple]) -> set[Term] | None:
        """Make a change with deletions of which it is plain whom it concerns: who that is.

        None, with nothing done, where it is not plain.
        """
        return None

    def depart(self, triples: Sequence[Triple]) -> list[Triple]:
        """Delete those of many triples of which it is plain whom it concerns; they are returned."""
        return []

    def insert(self, triples: Sequence[Triple], work_out: WorkOut, added: list[Triple]) -> list[Alike]:
        """Insert triples: what is known is written down, `added`, and returned; all else is worked out.

        Raises:
            Known: they are known to contradict each other; nothing was done.
        """
        if triples:
            work_out(triples)
        return []

    def compute(self, triples: Sequence[Triple], insert: Insert, added: list[Triple]) -> None:
        """Have triples as computed; those that are new are `added`. The rules are yet to be run."""
        for triple in triples:
            if insert(triple, COMPUTED):
                added.append(triple)

    def refuse(self, triples: Sequence[Triple], proof: Proof, terms: Sequence[Term]) -> None:
        """Take note of triples that were refused, by a proof that is about `terms`."""


class FastPaths(PlainPaths):
    """Shapes whose consequences are known, and changes that affect no other individual."""

    def __init__(self, abox: ABox) -> None:
        self._abox = abox
        self._edges = ManyEdges(abox)
        self.shapes = Shapes(abox)

    def change(self, delete: Sequence[Triple], insert: Sequence[Triple]) -> set[Term] | None:
        """See `PlainPaths`."""
        return exchange(self._abox, delete, insert) if insert else depart(self._abox, delete)

    def depart(self, triples: Sequence[Triple]) -> list[Triple]:
        """See `PlainPaths`."""
        return depart_among(self._abox, triples) if len(triples) >= MANY_GO else []

    def insert(self, triples: Sequence[Triple], work_out: WorkOut, added: list[Triple]) -> list[Alike]:
        """See `PlainPaths`. Run by run as far as what follows is known, and the others together."""
        shapes, at = self.shapes, 0
        alike: list[Alike] = []
        rest: list[Triple] = []
        while at < len(triples):
            stars, end = ([], len(triples)) if self._abox.is_mixed else shapes.write_all(triples, at)
            if stars:
                added += triples[at:end]
                alike += stars
                at = end
                continue
            for run in shapes.runs(triples, at, end):
                at += len(run.triples)
                is_mixed = self._abox.is_mixed
                form = run.form
                known = None if is_mixed or form is None else shapes.known.get(run.shape, run)
                if form is not None and isinstance(known, Written) and shapes.write(known, run):
                    added += run.triples
                    alike.append(Alike(known, form, list(zip(run.individuals)), list(zip(run.others))))
                elif known is run:
                    work_out(run.triples)
                    shapes.learn(run)
                elif isinstance(known, Contradiction) and not added:
                    raise Known(known.of(run))
                else:
                    rest += run.triples
        if rest:
            work_out(rest)
        return alike

    def compute(self, triples: Sequence[Triple], insert: Insert, added: list[Triple]) -> None:
        """See `PlainPaths`. Many are stored column by column."""
        if len(triples) >= MANY and not (self._abox.equals or self._abox.is_mixed):
            stored, triples = self._edges.insert(triples, COMPUTED)
            added += stored
        super().compute(triples, insert, added)

    def refuse(self, triples: Sequence[Triple], proof: Proof, terms: Sequence[Term]) -> None:
        """See `PlainPaths`."""
        self.shapes.refuse(triples, proof, terms)
