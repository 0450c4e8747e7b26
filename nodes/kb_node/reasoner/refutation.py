"""Proof by refutation: assume a triple, keep the proof of the contradiction, retract the assumption."""

from __future__ import annotations

from msgspec import structs

from semmap.nodes.kb_node.reasoner.explain.sentences import refutation_sentence
from semmap.nodes.kb_node.reasoner.explanations import Explanation, Triple
from semmap.nodes.kb_node.reasoner.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.terms import DIFFERENT_FROM, SAME_AS, is_literal


def refute(reasoner: Reasoner, supposed: Triple, *, allow_recompute: bool = True) -> Explanation | None:
    """Return the proof that a triple would make the map inconsistent; None if it would not.

    Applies and reverts a transaction with the triple, which takes about 0.1 ms. The conclusion of the
    explanation is None, or for `owl:sameAs` that the two individuals are different.

    Raises:
        NotCompilable: everything would have to be recomputed, which `allow_recompute` forbids.
    """
    try:
        with reasoner.assuming([supposed], allow_recompute=allow_recompute):
            return None
    except Inconsistent as inconsistent:
        found = inconsistent.explanation
    s, p, o = supposed
    conclusion = (s, DIFFERENT_FROM, o) if p == SAME_AS else None
    support = tuple(triple for triple in found.support if triple != supposed)
    return structs.replace(
        found,
        conclusion=conclusion,
        supposed=supposed,
        support=support,
        text=refutation_sentence(supposed, found.support, reasoner.words),
    )


def why_different(reasoner: Reasoner, triple: Triple, *, allow_recompute: bool = True) -> Explanation | None:
    """Return the proof that two individuals are different, by refutation; None if they may be the same."""
    s, p, o = triple
    if p != DIFFERENT_FROM or is_literal(o):
        return None
    return refute(reasoner, (s, SAME_AS, o), allow_recompute=allow_recompute)
