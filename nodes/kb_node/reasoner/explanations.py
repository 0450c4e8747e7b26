"""Terms, triples, and the proofs of the reasoner's conclusions."""

from __future__ import annotations

from msgspec import Struct

Term = str
"""One RDF term in N-Triples syntax: `<iri>`, `_:label`, `"text"`, `"text"@en`, `"1.0"^^<datatype>`."""

Triple = tuple[Term, Term, Term]
"""Subject, predicate, object."""


class Step(Struct, frozen=True, kw_only=True):
    """One application of a rule, by its name in the OWL 2 RL/RDF tables (`cax-sco`, `prp-dom`, ...)."""

    rule: str
    premises: tuple[Triple, ...]
    conclusion: Triple | None
    """None if the rule concludes that the map is inconsistent."""


class Explanation(Struct, frozen=True, kw_only=True):
    """A proof: `steps` derive `conclusion` from the asserted triples in `support`, which is minimal.

    The steps are in order: each premise is in `support`, is `supposed`, or was derived by an earlier step.
    The support of an asserted conclusion is the conclusion itself, without steps.
    """

    conclusion: Triple | None
    """None for an inconsistency, and for a conclusion that is not a single triple."""
    support: tuple[Triple, ...]
    steps: tuple[Step, ...]
    text: str
    """The proof in one sentence, with labels instead of IRIs."""
    supposed: Triple | None = None
    """For a proof by refutation: the assumed triple, which contradicts `support` as `steps` show.

    `conclusion` is then its negation, if that is a single triple, or else None.
    """
