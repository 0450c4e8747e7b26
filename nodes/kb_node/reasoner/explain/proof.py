"""Explanations from triples that entail a conclusion: a minimal subset of them, and the steps.

This needs many small closures, so proofs are cached by *shape*: triples that differ only in individuals and
numbers have the same proof.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

from semmap.nodes.kb_node.reasoner import datatypes
from semmap.nodes.kb_node.reasoner.explain.sentences import proof_sentence
from semmap.nodes.kb_node.reasoner.explain.words import PLACEHOLDER, Words
from semmap.nodes.kb_node.reasoner.explanations import Explanation, Step, Term, Triple
from semmap.nodes.kb_node.reasoner.lexical_forms import Value
from semmap.nodes.kb_node.reasoner.rules import swrl
from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.reasoner.terms import TYPE, iri, is_literal, is_named, literal

_MOST = 2000
"""Number of cached shapes."""
_FREE_DATATYPES = {iri(name)[1:-1] for name in ("xsd:float", "xsd:double")}
"""Datatypes whose values the cache treats as interchangeable."""
_MARK = re.compile(f"{PLACEHOLDER}(\\d+)\ue001")
"""Placeholder for a term in the text of a proof."""


class Proof:
    """A proof, and the terms that can be replaced for another proof of the same shape."""

    def __init__(self, explanation: Explanation, terms: tuple[Term, ...], words: Words) -> None:
        self.explanation = explanation
        self.terms = terms
        self._words = words
        self._pattern = _Pattern(explanation, terms)
        self._text = _template(explanation.text, self._pattern, terms, words)

    def about(self, terms: Sequence[Term]) -> Explanation:
        """Return the same proof about other terms."""
        goal, support, steps = self._pattern.renamed(dict(zip(self.terms, terms, strict=True)))
        if self._text is None:
            text = proof_sentence(goal, support, steps, self._words)
        else:
            name = self._words.name
            text = "".join([name(terms[part]) if isinstance(part, int) else part for part in self._text])
        return Explanation(conclusion=goal, support=support, steps=steps, text=text)


class Prover:
    """Creates explanations and caches them by shape."""

    def __init__(self, words: Words) -> None:
        """`words` are the words for terms in sentences."""
        self.words = words
        self._proofs: dict[tuple[object, ...], Proof] = {}

    def prove(self, triples: Iterable[Triple], goal: Triple | None) -> Explanation:
        """Explain why `goal` follows from `triples`, or if it is None, why they are inconsistent.

        The support is minimal: if any of its triples is removed, the conclusion does not follow.

        Raises:
            ValueError: `goal` does not follow.
        """
        proof, terms = self.proof(triples, goal)
        return proof.explanation if terms == proof.terms else proof.about(terms)

    def proof(self, triples: Iterable[Triple], goal: Triple | None) -> tuple[Proof, tuple[Term, ...]]:
        """Return the proof of the shape, and the terms to insert into it."""
        triples = list(triples)
        shape, terms = _shape(triples, goal)
        proof = self._proofs.get(shape)
        if proof is None:
            support, steps = _shrink(triples, goal)
            text = proof_sentence(goal, support, steps, self.words)
            explanation = Explanation(conclusion=goal, support=support, steps=steps, text=text)
            if len(self._proofs) >= _MOST:
                self._proofs.clear()
            proof = self._proofs[shape] = Proof(explanation, terms, self.words)
        return proof, terms


def _shape(triples: Sequence[Triple], goal: Triple | None) -> tuple[tuple[object, ...], tuple[Term, ...]]:
    """Return triples and goal with numbers for individuals, and the numbered terms."""
    fixed = {triple[1] for triple in triples} | {o for _, p, o in triples if p == TYPE}
    fixed.update(term for triple in triples if is_schema(triple) for term in triple)
    if any(triple[2] == swrl.RULE for triple in triples):  # its built-ins distinguish values
        fixed.update(o for _, _, o in (*triples, *([goal] if goal else ())) if is_literal(o))
    fixed_values = {datatypes.value(term) for term in fixed if is_literal(term)}
    numbers: dict[Term, object] = {}

    def number(term: Term) -> object:
        found = numbers.get(term)
        if found is None:
            found = numbers[term] = _number(term, numbers, fixed_values)
        return found

    rows = triples if goal is None else [*triples, goal]
    shape = tuple((s if s in fixed else number(s), p, o if o in fixed else number(o)) for s, p, o in rows)
    return (goal is None, *shape), tuple(numbers)


def _number(term: Term, numbers: dict[Term, object], fixed: set[Value | None]) -> object:
    """Return the key of a term in a shape. For a literal it includes the datatype and equal literals."""
    if not is_literal(term):
        return len(numbers)
    datatype, value = literal(term).datatype, datatypes.value(term)
    if value is None or value in fixed or datatype not in _FREE_DATATYPES:
        return (len(numbers), term)
    literals = ((i, other) for i, other in enumerate(numbers) if is_literal(other))
    same = next((i for i, other in literals if datatypes.value(other) == value), None)
    return (len(numbers), datatype, same)


class _Pattern:
    """A proof in which some terms can be replaced: its facts, and which of them contain these terms."""

    def __init__(self, explanation: Explanation, terms: Iterable[Term]) -> None:
        number: dict[Triple, int] = {}
        goal, free = explanation.conclusion, frozenset(terms)

        def place(fact: Triple) -> int:
            return number.setdefault(fact, len(number))

        self._goal = None if goal is None else place(goal)
        self._support = tuple(map(place, explanation.support))
        steps = [
            (step, tuple(map(place, step.premises)), step.conclusion and place(step.conclusion))
            for step in explanation.steps
        ]
        self._facts = list(number)
        self._varying = [(i, s, p, o) for i, (s, p, o) in enumerate(number) if s in free or o in free]
        varying = {i for i, *_ in self._varying}
        self._steps = [
            (step, premises, conclusion, not varying.isdisjoint((*premises, conclusion)))
            for step, premises, conclusion in steps
        ]

    def renamed(
        self, names: Mapping[Term, Term]
    ) -> tuple[Triple | None, tuple[Triple, ...], tuple[Step, ...]]:
        """Return goal, support and steps with other terms."""
        facts, name = self._facts.copy(), names.get
        for i, s, p, o in self._varying:
            facts[i] = (name(s, s), p, name(o, o))
        steps = tuple(
            [
                Step(
                    rule=step.rule,
                    premises=tuple([facts[i] for i in premises]),
                    conclusion=None if conclusion is None else facts[conclusion],
                )
                if varies
                else step
                for step, premises, conclusion, varies in self._steps
            ]
        )
        support = tuple([facts[i] for i in self._support])
        return None if self._goal is None else facts[self._goal], support, steps


def _template(text: str, pattern: _Pattern, terms: Sequence[Term], words: Words) -> list[str | int] | None:
    """Return the sentence as text pieces with the numbers of terms between them.

    Returns None if the text contains a placeholder itself.
    """
    if _MARK.search(text):
        return None
    marks = {term: _mark(term, i) for i, term in enumerate(terms) if _is_free(term)}
    pieces: list[str | int] = list(_MARK.split(proof_sentence(*pattern.renamed(marks), words)))
    pieces[1::2] = map(int, pieces[1::2])
    return pieces


def _is_free(term: Term) -> bool:
    """Return whether a term can be replaced in another proof of the shape."""
    return not is_literal(term) or literal(term).datatype in _FREE_DATATYPES


def _mark(term: Term, number: int) -> Term:
    """Return a placeholder term of the same sort whose name is the number between marks."""
    text = f"{PLACEHOLDER}{number}\ue001"
    if is_literal(term):
        return f'"{text}{term[term.rindex(chr(34)) :]}'
    return f"<{text}>" if is_named(term) else f"_:{text}"


def _shrink(triples: Sequence[Triple], goal: Triple | None) -> tuple[tuple[Triple, ...], tuple[Step, ...]]:
    """Return a minimal set of the triples from which the goal follows, and the steps."""
    closure = Closure(triples, mentions=goal or ())
    if not _reached(closure, goal):
        raise ValueError(f"{goal} does not follow")
    support = closure.leaves(goal)
    for triple in support:
        if triple in closure.leaves(goal):
            fewer = Closure((t for t in closure.leaves(goal) if t != triple), mentions=goal or ())
            if _reached(fewer, goal):
                closure = fewer
    closure = Closure(closure.leaves(goal), mentions=goal or ())
    return tuple(closure.leaves(goal)), _steps(closure, goal)


def _reached(closure: Closure, goal: Triple | None) -> bool:
    return closure.clash is not None if goal is None else closure.clash is None and closure.holds(goal)


def _steps(closure: Closure, goal: Triple | None) -> tuple[Step, ...]:
    """Return the rule applications that lead to a conclusion, premises first."""
    steps: dict[Triple | None, Step] = {}
    pending: list[tuple[Triple | None, bool]] = [(goal, False)]
    while pending:
        fact, is_ready = pending.pop()
        reason = closure.reason(fact)
        if reason is None or fact in steps:
            continue
        if is_ready:
            steps[fact] = Step(rule=reason.rule, premises=reason.premises, conclusion=fact)
        else:
            pending.append((fact, True))
            pending += [(premise, False) for premise in reversed(reason.premises)]
    return tuple(steps.values())
