"""An explanation as indented lines: the premises of each conclusion are below it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final, Literal, NamedTuple

from semmap.nodes.kb_node.reasoner.explain.sentences import Clause, clauses
from semmap.nodes.kb_node.reasoner.explain.words import Words
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import ClassInfo, PropertyInfo
from semmap.schemas.explanations import Explanation, Step, Term, Triple

Basis = Literal["inferred", "asserted", "computed", "axiom", "assumption", "contradiction"]

BASIS_LABELS: Final[Mapping[Basis, str]] = {
    "inferred": "inferred",
    "asserted": "asserted",
    "computed": "computed",
    "axiom": "ontology",
    "assumption": "assumption",
    "contradiction": "contradiction",
}
"""The label of each basis."""

_DEEPEST: Final = 40


class Line(NamedTuple):
    """One line of a proof; `depth` is its indentation."""

    depth: int
    text: str
    basis: Basis
    rule: str = ""
    """The rule that infers it, by its name in the OWL 2 RL/RDF tables."""
    repeated: bool = False
    """Whether it is shown above, with its premises."""


def words_of(classes: Iterable[ClassInfo], properties: Iterable[PropertyInfo]) -> Words:
    """Return the labels of classes and properties for sentences."""
    labels: dict[Term, str] = {}
    data: set[Term] = set()
    for c in classes:
        _label(labels, c.iri, c.labels)
    for p in properties:
        _label(labels, p.iri, p.labels)
        if p.kind == "data":
            data.add(v.iri(p.iri))
    return Words(labels, frozenset(data))


def _label(labels: dict[Term, str], iri: str, known: Mapping[str, str]) -> None:
    if label := known.get("en") or known.get(""):
        labels[v.iri(iri)] = label


def proof_lines(explanation: Explanation, words: Words) -> list[Line]:
    """Return the proof, from its conclusion down to asserted and computed facts and axioms.

    An explanation that only has a text has no lines.
    """
    return list(_Proof(explanation, words).lines())


class _Proof:
    def __init__(self, explanation: Explanation, words: Words) -> None:
        e = explanation
        self._explanation = e
        every = [*e.support, *(triple for step in e.steps for triple in step.premises)]
        every += [step.conclusion for step in e.steps if step.conclusion is not None]
        every += [triple for triple in (e.conclusion, e.supposed) if triple is not None]
        every = list(dict.fromkeys(every))
        self._clauses: dict[Triple, Clause] = clauses(every, every, words)
        self._by: dict[Triple, Step] = {}
        for step in e.steps:
            if step.conclusion is not None and step.conclusion not in e.support:
                self._by.setdefault(step.conclusion, step)
        self._shown: set[Triple] = set()

    def lines(self) -> Iterable[Line]:
        e = self._explanation
        if e.conclusion is not None and e.supposed is None:
            yield from self._lines_of(e.conclusion, 0)
            if e.conclusion not in self._by and e.conclusion not in e.support:  # found by another search
                for triple in e.support:
                    yield from self._lines_of(triple, 1)
            return
        if not e.support and not e.steps:  # a measurement that is not about a single triple: its text is all
            return
        last = next((step for step in reversed(e.steps) if step.conclusion is None), None)
        premises = e.support if last is None else last.premises
        yield Line(
            0, "these facts contradict one another", "contradiction", "" if last is None else last.rule
        )
        for triple in self._facts_first(premises):
            yield from self._lines_of(triple, 1)

    def _lines_of(self, triple: Triple, depth: int) -> Iterable[Line]:
        clause = self._clauses.get(triple)
        if clause is None:
            return
        step = self._by.get(triple)
        if step is None:
            yield Line(depth, clause.text, self._basis_of(triple, clause))
            return
        repeated = triple in self._shown or depth >= _DEEPEST
        yield Line(depth, clause.text, "inferred", step.rule, repeated)
        if not repeated:
            self._shown.add(triple)
            yield from self._premises(step, clause.text, depth)

    def _premises(self, step: Step, text: str, depth: int) -> Iterable[Line]:
        """Yield the premises of a step. A premise with the same text is replaced by its own premises."""
        for premise in self._facts_first(step.premises):
            before = self._by.get(premise)
            if before is not None and self._clauses[premise].text == text and premise not in self._shown:
                self._shown.add(premise)
                yield from self._premises(before, text, depth)
            else:
                yield from self._lines_of(premise, depth + 1)

    def _basis_of(self, triple: Triple, clause: Clause) -> Basis:
        if triple == self._explanation.supposed:
            return "assumption"
        if triple in self._explanation.computed:
            return "computed"
        if triple not in self._explanation.support:
            return "axiom" if clause.is_axiom and triple != self._explanation.conclusion else "inferred"
        return "axiom" if clause.is_axiom else "asserted"

    def _facts_first(self, triples: Iterable[Triple]) -> list[Triple]:
        worded = [triple for triple in dict.fromkeys(triples) if triple in self._clauses]
        return sorted(worded, key=lambda triple: self._clauses[triple].is_axiom)
