"""An explanation, step by step: each conclusion with what it rests on below it, in plain words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final, Literal, NamedTuple

from semmap.nodes.kb_node.reasoner.explain.sentences import Clause, clauses
from semmap.nodes.kb_node.reasoner.explain.words import Words
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import ClassInfo, PropertyInfo
from semmap.schemas.explanations import Explanation, Step, Term, Triple

How = Literal["follows", "asserted", "measured", "axiom", "supposed", "contradiction"]

HOW: Final[Mapping[How, str]] = {
    "follows": "follows",
    "asserted": "asserted",
    "measured": "measured",
    "axiom": "the ontology says so",
    "supposed": "supposed",
    "contradiction": "cannot be",
}
"""What is said of a line, in words."""

_DEEPEST: Final = 40


class Line(NamedTuple):
    """One line of a proof; `depth` is by how much it is indented."""

    depth: int
    text: str
    how: How
    rule: str = ""
    """The rule that it follows by, by its name in the OWL 2 RL/RDF tables."""
    again: bool = False
    """It is told above already, with what it rests on."""


def words_of(classes: Iterable[ClassInfo], properties: Iterable[PropertyInfo]) -> Words:
    """What the classes and properties of the TBox are called in a sentence."""
    labels: dict[Term, str] = {}
    data: set[Term] = set()
    for c in classes:
        _label(labels, c.iri, c.labels)
    for p in properties:
        _label(labels, p.iri, p.labels)
        if p.kind == "data":
            data.add(v.iri(p.iri))
    return Words(labels, frozenset(data))


def _label(labels: dict[Term, str], iri: str, said: Mapping[str, str]) -> None:
    if label := said.get("en") or said.get(""):
        labels[v.iri(iri)] = label


def lines(explanation: Explanation, words: Words) -> list[Line]:
    """The proof from its conclusion down to what was asserted or measured, and what the TBox says."""
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
        self._told: set[Triple] = set()

    def lines(self) -> Iterable[Line]:
        e = self._explanation
        if e.conclusion is not None and e.supposed is None:
            yield from self._about(e.conclusion, 0)
            if e.conclusion not in self._by and e.conclusion not in e.support:  # found by another search
                for triple in e.support:
                    yield from self._about(triple, 1)
            return
        last = next((step for step in reversed(e.steps) if step.conclusion is None), None)
        premises = e.support if last is None else last.premises
        yield Line(0, "these cannot all be", "contradiction", "" if last is None else last.rule)
        for triple in self._facts_first(premises):
            yield from self._about(triple, 1)

    def _about(self, triple: Triple, depth: int) -> Iterable[Line]:
        clause = self._clauses.get(triple)
        if clause is None:
            return
        step = self._by.get(triple)
        if step is None:
            yield Line(depth, clause.text, self._how(triple, clause))
            return
        again = triple in self._told or depth >= _DEEPEST
        yield Line(depth, clause.text, "follows", step.rule, again)
        if not again:
            self._told.add(triple)
            yield from self._premises(step, clause.text, depth)

    def _premises(self, step: Step, said: str, depth: int) -> Iterable[Line]:
        """What a step rests on; of one that is told in the same words, what that rests on."""
        for premise in self._facts_first(step.premises):
            before = self._by.get(premise)
            if before is not None and self._clauses[premise].text == said and premise not in self._told:
                self._told.add(premise)
                yield from self._premises(before, said, depth)
            else:
                yield from self._about(premise, depth + 1)

    def _how(self, triple: Triple, clause: Clause) -> How:
        if triple == self._explanation.supposed:
            return "supposed"
        if triple not in self._explanation.support:
            return "axiom" if clause.is_axiom and triple != self._explanation.conclusion else "follows"
        if clause.is_axiom:
            return "axiom"
        return "measured" if self._is_measured(triple, clause) else "asserted"

    def _is_measured(self, triple: Triple, clause: Clause) -> bool:
        """As the sentence says, where the same triple may have "it" as its subject."""
        text, name = self._explanation.text, v.entity_name(triple[0])
        of_it = f"it{clause.text.removeprefix(name)}"
        if f"{clause.text} (asserted)" in text or f"{of_it} (asserted)" in text:
            return False
        if f"{clause.text} (measured)" in text or f"{of_it} (measured)" in text:
            return True
        return triple == self._explanation.conclusion and text.startswith(f"{clause.text}:")

    def _facts_first(self, triples: Iterable[Triple]) -> list[Triple]:
        told = [triple for triple in dict.fromkeys(triples) if triple in self._clauses]
        return sorted(told, key=lambda triple: self._clauses[triple].is_axiom)
