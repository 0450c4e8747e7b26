"""Terms, triples, and the proofs that the reasoner gives for what it says."""

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
    """None when the rule concludes that the map is inconsistent."""


class Explanation(Struct, frozen=True, kw_only=True):
    """A proof: `steps` lead from the asserted triples in `support`, a minimal set, to `conclusion`.

    `steps` are in order: each premise is in `support`, is `supposed`, or was concluded by an earlier step.
    A conclusion that was asserted has itself as support and no steps.
    """

    conclusion: Triple | None
    """None for an inconsistency, and for what no single triple says."""
    support: tuple[Triple, ...]
    steps: tuple[Step, ...]
    text: str
    """The same in one sentence, with labels instead of IRIs."""
    supposed: Triple | None = None
    """For a proof by refutation, the triple that cannot hold: `support` contradicts it, as `steps` show.

    `conclusion` is then what follows from that, if a triple says it, or else None.
    """
