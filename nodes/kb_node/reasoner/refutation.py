"""Why something cannot be: it is supposed, the contradiction is kept, and the supposition is taken back."""

from __future__ import annotations

from msgspec import structs

from semmap.nodes.kb_node.reasoner.explain.sentences import denial
from semmap.nodes.kb_node.reasoner.explanations import Explanation, Triple
from semmap.nodes.kb_node.reasoner.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.terms import DIFFERENT_FROM, SAME_AS, is_literal


def refute(reasoner: Reasoner, supposed: Triple, *, anew: bool = True) -> Explanation | None:
    """Why a triple cannot hold, by the contradiction that it would make; None if it would make none.

    Costs what the transaction does that adds the triple and takes it back, about a tenth of a millisecond.
    The explanation's conclusion is None, or for `owl:sameAs` that the two are different.

    Raises:
        NotCompilable: everything would have to be worked out `anew`, and that is not wanted.
    """
    try:
        with reasoner.supposing([supposed], anew=anew):
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
        text=denial(supposed, found.support, reasoner.words),
    )


def why_different(reasoner: Reasoner, triple: Triple, *, anew: bool = True) -> Explanation | None:
    """Why two individuals are different although no rule says so; None if they may be the same."""
    s, p, o = triple
    if p != DIFFERENT_FROM or is_literal(o):
        return None
    return refute(reasoner, (s, SAME_AS, o), anew=anew)
