"""From triples that are enough for a conclusion to an explanation: a smallest set of them, and the steps.

Finding it takes many small closures, so it is done once for each *shape*: the same triples with other
individuals and other numbers in them have the same proof.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from nodes.kb_node.reasoner import datatypes
from nodes.kb_node.reasoner.closure import Closure
from nodes.kb_node.reasoner.sentences import sentence
from nodes.kb_node.reasoner.split import is_schema
from nodes.kb_node.reasoner.terms import TYPE, iri, is_literal, literal
from schemas.explanations import Explanation, Step, Term, Triple

_MOST = 2000
"""Shapes remembered."""
_FREE_DATATYPES = {iri(name)[1:-1] for name in ("xsd:float", "xsd:double")}
"""Datatypes whose values differ in nothing but themselves, as far as the memo is concerned."""


class _Proof(NamedTuple):
    support: tuple[Triple, ...]
    steps: tuple[Step, ...]
    terms: tuple[Term, ...]
    """The terms that another proof of the shape has others for."""


class Prover:
    """Explains, and remembers the shapes it has explained."""

    def __init__(self) -> None:
        self._proofs: dict[tuple[object, ...], _Proof] = {}

    def prove(self, triples: Iterable[Triple], goal: Triple | None) -> Explanation:
        """Explain why `goal` follows from `triples`, or with None why they are inconsistent.

        `support` is minimal: without any one of its triples the conclusion does not follow.

        Raises:
            ValueError: it does not follow.
        """
        triples = list(triples)
        shape, terms = _shape(triples, goal)
        proof = self._proofs.get(shape)
        if proof is None:
            support, steps = _shrink(triples, goal)
            if len(self._proofs) >= _MOST:
                self._proofs.clear()
            self._proofs[shape] = _Proof(support, steps, terms)
        else:
            support, steps = _renamed(proof, dict(zip(proof.terms, terms, strict=True)))
        return Explanation(conclusion=goal, support=support, steps=steps, text=sentence(goal, support, steps))


def _shape(triples: Sequence[Triple], goal: Triple | None) -> tuple[tuple[object, ...], tuple[Term, ...]]:
    """Triples and goal with individuals by number, and the terms that were numbered."""
    fixed = {triple[1] for triple in triples} | {o for _, p, o in triples if p == TYPE}
    fixed.update(term for triple in triples if is_schema(triple) for term in triple)
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


def _number(term: Term, numbers: dict[Term, object], fixed: set[datatypes.Value | None]) -> object:
    """What a term is in a shape: for a literal also its datatype, and which other is of the same value."""
    if not is_literal(term):
        return len(numbers)
    datatype, value = literal(term).datatype, datatypes.value(term)
    if value is None or value in fixed or datatype not in _FREE_DATATYPES:
        return (len(numbers), term)
    literals = ((i, other) for i, other in enumerate(numbers) if is_literal(other))
    same = next((i for i, other in literals if datatypes.value(other) == value), None)
    return (len(numbers), datatype, same)


def _renamed(proof: _Proof, names: dict[Term, Term]) -> tuple[tuple[Triple, ...], tuple[Step, ...]]:
    def renamed(triple: Triple) -> Triple:
        s, p, o = triple
        return (names.get(s, s), p, names.get(o, o))

    steps = tuple(
        Step(
            rule=step.rule,
            premises=tuple(map(renamed, step.premises)),
            conclusion=step.conclusion and renamed(step.conclusion),
        )
        for step in proof.steps
    )
    return tuple(map(renamed, proof.support)), steps


def _shrink(triples: Sequence[Triple], goal: Triple | None) -> tuple[tuple[Triple, ...], tuple[Step, ...]]:
    """A minimal set of the triples from which the goal follows, and the steps."""
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
    """The rule applications below a conclusion, premises first."""
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
