"""Explanations of inferred facts and inconsistencies, for people and programs."""

from __future__ import annotations

from msgspec import Struct

Term = str
"""One RDF term in N-Triples syntax: `<iri>`, `_:label`, `"text"`, `"text"@en`, `"1.0"^^<datatype>`."""

Triple = tuple[Term, Term, Term]
"""Subject, predicate, object."""


class Step(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One application of a rule, by its name in the OWL 2 RL/RDF tables (`cax-sco`, `prp-dom`, ...)."""

    rule: str
    premises: tuple[Triple, ...]
    conclusion: Triple | None
    """None if the rule concludes that the map is inconsistent."""


class Explanation(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """A proof: `steps` lead from the asserted triples in `support` (a minimal set) to `conclusion`.

    `steps` are in order: each premise is in `support` or is the conclusion of an earlier step. An asserted
    conclusion has itself as support and no steps.
    """

    conclusion: Triple | None
    """None for an inconsistency, and for a conclusion that is not a single triple."""
    support: tuple[Triple, ...]
    steps: tuple[Step, ...]
    text: str
    """The proof in one sentence, with labels instead of IRIs."""
    supposed: Triple | None = None
    """In a proof by refutation, the refuted assumption: `steps` derive a contradiction from it and `support`.

    `conclusion` is then the consequence of the refutation, or None if it is not a single triple. Premises can
    also be this triple.
    """
    computed: tuple[Triple, ...] = ()
    """The facts of the proof that are computed from poses: triples of `support`, or the conclusion itself."""
