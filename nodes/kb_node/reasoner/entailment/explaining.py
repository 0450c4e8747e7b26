"""Proofs beyond the rules: why a statement is entailed or excluded, as a set of asserted triples."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial

from semmap.nodes.kb_node.reasoner.entailment.conclusions import entails
from semmap.nodes.kb_node.reasoner.entailment.effort import Effort
from semmap.nodes.kb_node.reasoner.entailment.prover import Prover
from semmap.nodes.kb_node.reasoner.explain.sentences import entailment_sentence, refutation_sentence
from semmap.nodes.kb_node.reasoner.explain.words import Words
from semmap.nodes.kb_node.reasoner.explanations import Explanation, Term, Triple
from semmap.nodes.kb_node.reasoner.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.reasoner.terms import DIFFERENT_FROM, NOTHING, SAME_AS, TYPE, iri, is_literal

_LABEL, _SUB_CLASS_OF = iri("rdfs:label"), iri("rdfs:subClassOf")
_DENIED = "_:denied"
"""The blank node of a negated statement."""
_NEAR = 2
"""Number of steps from the terms of a query to the facts that are used."""
_FACTS = 2000
"""Maximum number of facts. With fewer facts proofs may be missed, but no proof is wrong."""
_SMALL = 5000
"""Maximum number of triples for assumptions about the schema: recomputing them takes about a second."""
PATIENCE_S = 2.0
"""CPU time limit for the search for a proof, and again for reducing it [s]."""


def nearby(reasoner: Reasoner, terms: Sequence[Term]) -> list[Triple]:
    """Return the schema with its labels, and the facts within a few steps of some individuals.

    All conclusions from these triples also follow from the whole map.
    """
    schema = [triple for triple in reasoner.asserted() if triple[1] == _LABEL or is_schema(triple)]
    facts: dict[Triple, None] = {}
    near = seen = {term for term in terms if not is_literal(term)}
    for _ in range(_NEAR):
        further: set[Term] = set()
        for term in sorted(near):
            for triple in (*reasoner.given(term), *reasoner.given(None, None, term)):
                s, p, o = triple
                if triple in facts or is_schema(triple) or (p == TYPE and s not in near):
                    continue
                if len(facts) >= _FACTS:
                    break
                facts[triple] = None
                further.update((s,) if p == TYPE or is_literal(o) else (s, o))
        near, seen = further - seen, seen | further
    return [*schema, *facts]


def why_entailed(
    reasoner: Reasoner, triple: Triple, *, words: Words | None = None, patience_s: float = PATIENCE_S
) -> Explanation | None:
    """Return why a triple follows that no rule derives; None if no proof is found in time.

    The proof uses refutation, generic individuals, and names for values that must exist. So it has no steps.
    Its support is minimal unless reducing it exceeds the time limit. `words` are used for its text.
    """
    support = _support(reasoner, [triple], patience_s)
    if support is None:
        return None
    text = entailment_sentence(triple, support, words or reasoner.words)
    return Explanation(conclusion=triple, support=support, steps=(), text=text)


def why_excluded(
    reasoner: Reasoner, supposed: Triple, *, words: Words | None = None, patience_s: float = PATIENCE_S
) -> Explanation | None:
    """Return why a triple about individuals cannot hold although no rule contradicts it; None without proof.

    Proves its negation as `why_entailed` does. The result has the form of `refutation.refute`.
    """
    support = None if is_schema(supposed) else _support(reasoner, _negation(supposed), patience_s)
    if support is None:
        return None
    s, p, o = supposed
    return Explanation(
        conclusion=(s, DIFFERENT_FROM, o) if p == SAME_AS else None,
        support=support,
        steps=(),
        text=refutation_sentence(supposed, (*support, supposed), words or reasoner.words),
        supposed=supposed,
    )


def _negation(triple: Triple) -> list[Triple]:
    """Return a graph that states the negation of a triple about individuals."""
    s, p, o = triple
    if p == TYPE:
        return [(s, TYPE, _DENIED), (_DENIED, iri("owl:complementOf"), o)]
    if p in (SAME_AS, DIFFERENT_FROM):
        return [(s, DIFFERENT_FROM if p == SAME_AS else SAME_AS, o)]
    return [
        (_DENIED, TYPE, iri("owl:NegativePropertyAssertion")),
        (_DENIED, iri("owl:sourceIndividual"), s),
        (_DENIED, iri("owl:assertionProperty"), p),
        (_DENIED, iri("owl:targetValue" if is_literal(o) else "owl:targetIndividual"), o),
    ]


def _support(reasoner: Reasoner, goal: Sequence[Triple], patience_s: float) -> tuple[Triple, ...] | None:
    """Return asserted triples that entail a graph, reduced within the time limit; None without a proof."""
    allow_recompute = len(reasoner) <= _SMALL
    if not entails(reasoner, goal, Effort(patience_s, allow_recompute=allow_recompute)):
        return None
    known = set(reasoner.asserted())
    effort = Effort(patience_s, traced=True, allow_recompute=allow_recompute)
    entails(reasoner, goal, effort)
    support = [one for one in effort.seen if one in known]
    if not _suffice(support, goal):
        support = sorted(known)
    return tuple(_shrunk(support, lambda some: _suffice(some, goal), time.thread_time() + patience_s))


def empty_classes(reasoner: Reasoner, classes: Iterable[Term], patience_s: float) -> Iterator[Explanation]:
    """Yield why classes are unsatisfiable because of values that their members must have.

    The rules do not find these. The search ends after `patience_s` seconds of CPU time.
    """
    until_s = time.process_time() + patience_s
    known = set(reasoner.asserted())
    prover = Prover(reasoner, Effort(allow_recompute=False))
    for cls in classes:
        if time.process_time() > until_s:
            return
        if not prover.is_unsatisfiable(cls):
            continue
        traced = Effort(traced=True, allow_recompute=False)
        Prover(reasoner, traced).is_unsatisfiable(cls)
        support = [one for one in traced.seen if one in known]
        support = _shrunk(support, partial(_suffices_for_empty, cls), time.thread_time() + PATIENCE_S)
        goal = (cls, _SUB_CLASS_OF, NOTHING)
        text = entailment_sentence(goal, support, reasoner.words)
        yield Explanation(conclusion=goal, support=tuple(support), steps=(), text=text)


def _suffices_for_empty(cls: Term, triples: Sequence[Triple]) -> bool:
    try:
        return Prover(Reasoner(triples), Effort(allow_recompute=False)).is_unsatisfiable(cls)
    except Inconsistent:
        return False


def _suffice(triples: Sequence[Triple], goal: Sequence[Triple]) -> bool:
    try:
        return entails(Reasoner(triples), goal, Effort(PATIENCE_S))
    except Inconsistent:
        return False


def _shrunk(
    triples: list[Triple], suffice: Callable[[Sequence[Triple]], bool], until_s: float
) -> list[Triple]:
    """Return fewer triples that suffice: first large parts are left out, then single triples.

    `until_s` is CPU time of this thread, so that results do not depend on the load of the machine.
    """
    size = len(triples)
    while size > 1 and time.thread_time() < until_s:
        size = (size + 1) // 2
        start = 0
        while start < len(triples) and time.thread_time() < until_s:
            rest = triples[:start] + triples[start + size :]
            if suffice(rest):
                triples = rest
            else:
                start += size
    return triples
