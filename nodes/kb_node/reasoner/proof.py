"""From triples that are enough for a conclusion to an explanation: a smallest set of them, and the steps."""

from __future__ import annotations

from collections.abc import Iterable

from nodes.kb_node.reasoner.closure import Closure
from nodes.kb_node.reasoner.sentences import sentence
from schemas.explanations import Explanation, Step, Triple


def prove(triples: Iterable[Triple], goal: Triple | None) -> Explanation:
    """Explain why `goal` follows from `triples`, or with None why they are inconsistent.

    `support` is minimal: without any one of its triples the conclusion does not follow.

    Raises:
        ValueError: it does not follow.
    """
    closure = Closure(triples)
    if not _reached(closure, goal):
        raise ValueError(f"{goal} does not follow")
    support = closure.leaves(goal)
    for triple in support:
        fewer = Closure(other for other in support if other != triple)
        if _reached(fewer, goal):
            support = fewer.leaves(goal)
            closure = fewer
    closure = Closure(support)
    steps = _steps(closure, goal)
    asserted = tuple(closure.leaves(goal))
    return Explanation(conclusion=goal, support=asserted, steps=steps, text=sentence(goal, asserted, steps))


def _reached(closure: Closure, goal: Triple | None) -> bool:
    return closure.clash is not None if goal is None else closure.clash is None and closure.holds(goal)


def _steps(closure: Closure, goal: Triple | None) -> tuple[Step, ...]:
    steps: list[Step] = []
    done: set[Triple | None] = set()
    pending: list[tuple[Triple | None, bool]] = [(goal, False)]
    while pending:
        fact, premises_done = pending.pop()
        if fact in done and not premises_done:
            continue
        reason = closure.reason(fact)
        if reason is None:
            done.add(fact)
        elif premises_done:
            steps.append(Step(rule=reason.rule, premises=reason.premises, conclusion=fact))
        else:
            done.add(fact)
            pending.append((fact, True))
            pending += [(premise, False) for premise in reversed(reason.premises)]
    return tuple(steps)
