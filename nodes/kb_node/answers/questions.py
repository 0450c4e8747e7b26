"""The commands `explain` and `could`: why a statement holds or cannot hold, and whether it could."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import chain, islice
from typing import NamedTuple

from msgspec import structs

from semmap.nodes.kb_node import proofs
from semmap.nodes.kb_node.answers import term_resolution
from semmap.nodes.kb_node.answers.term_resolution import RELATIONS
from semmap.nodes.kb_node.reasoner import GivenFacts, Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner import explanations as reasons
from semmap.nodes.kb_node.reasoner.entailment.explaining import nearby, why_entailed, why_excluded
from semmap.nodes.kb_node.reasoner.explain.sentences import mark_measured, triple_clause
from semmap.nodes.kb_node.reasoner.refutation import refute, why_different
from semmap.nodes.kb_node.reasoner.tbox.axioms import NotCompilable
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Could, Explain
from semmap.schemas.explanations import Explanation, Term, Triple
from semmap.schemas.replies import Possible

_QUICK = 2000
"""Triples about an individual up to which an assumption about it takes milliseconds."""
_COMPARED = 50
"""Values that are compared for what would become the same."""


class Undecided(NotCompilable):
    """Raised if neither the rules nor a refutation decide it, so that a proof must be searched on a copy."""


class StatementQuestion(NamedTuple):
    """A statement as triples: one triple, or several if a word is ambiguous."""

    triples: tuple[Triple, ...]
    negated: bool = False

    @property
    def terms(self) -> tuple[Term, ...]:
        """The subjects and objects."""
        return tuple(dict.fromkeys(term for s, _, o in self.triples for term in (s, o)))


def parse_explain(semantic_map: SemanticMap, question: Explain) -> StatementQuestion:
    """Return the statement that `explain` is about. Raises UnknownName, UnknownClass, BadRequest."""
    predicate = term_resolution.resolve_property(semantic_map, question.predicate)
    subject = term_resolution.resolve_end(semantic_map, predicate, question.name)
    values = term_resolution.resolve_values(semantic_map, subject, predicate, question.value)
    return StatementQuestion(tuple((subject, predicate, value) for value in values), question.negated)


def parse_could(semantic_map: SemanticMap, question: Could) -> StatementQuestion:
    """Return the statement that `could` is about. Raises UnknownName, UnknownClass, BadRequest."""
    predicate = term_resolution.resolve_property(semantic_map, question.predicate)
    subject = term_resolution.resolve_end(semantic_map, predicate, question.name)
    return StatementQuestion(
        ((subject, predicate, term_resolution.resolve_value(semantic_map, predicate, question.value)),)
    )


def is_quick(reasoner: Reasoner, asked: StatementQuestion) -> bool:
    """Return whether an assumption is quick: the reasoner is incremental, and few triples change."""
    return reasoner.is_compiled and not any(
        _has_many(reasoner, term)
        for s, p, o in asked.triples
        for term in ((s,) if p == v.RDF_TYPE or o.startswith('"') else (s, o))
    )


def copy_reasoner(held: GivenFacts, names: Mapping[Term, str]) -> Reasoner:
    """Return a reasoner for another thread; `names` distinguish classes with equal local names."""
    reasoner = Reasoner.of(held)
    reasoner.words.disambiguate(names)
    reasoner.words.name_individual = v.entity_name
    return reasoner


def _to_message(reasoner: Reasoner, found: reasons.Explanation) -> Explanation:
    """Return an explanation as a wire message; computed facts are described as measured."""
    computed = [fact for fact in found.support if reasoner.is_computed(fact)]
    message = proofs.to_message(found, computed)
    if not computed:
        return message
    return structs.replace(message, text=mark_measured(message.text, computed, reasoner.words))


def why(reasoner: Reasoner, asked: StatementQuestion) -> Explanation | None:
    """Return why the statement holds by the rules, or None."""
    found = next(filter(None, map(reasoner.explain, asked.triples)), None)
    return None if found is None else _to_message(reasoner, found)


def explain(reasoner: Reasoner, asked: StatementQuestion, *, recompute: bool = True) -> Explanation:
    """Return why the statement holds or cannot hold.

    If no rule derives or contradicts it, a proof or a refutation is searched in the nearby triples.

    Raises:
        Refused: it does not hold, or (negated) it holds or is not excluded.
        NotCompilable: everything must be computed again, and `recompute` is False; Undecided if only the
            nearby triples must be.
    """
    first = asked.triples[0]
    clause = triple_clause(first, reasoner.words)
    if asked.negated:
        if (denied := refute(reasoner, first, allow_recompute=recompute)) is not None:
            return _to_message(reasoner, denied)
        holds = reasoner.explain(first)
        if holds is None:
            if not recompute:
                raise Undecided("no rule excludes it, and none derives it")
            near = _near(reasoner, asked)
            if (further := why_excluded(near, first, words=reasoner.words)) is not None:
                return _to_message(reasoner, further)
            holds = why_entailed(near, first, words=reasoner.words)
        if holds is None:
            raise errors.Refused(f"it is not known that {clause}, but nothing excludes it")
        message = _to_message(reasoner, holds)
        raise errors.Refused(f"it holds: {message.text}", explanation=message)
    if (found := why(reasoner, asked)) is not None:
        return found
    if (different := why_different(reasoner, first, allow_recompute=recompute)) is not None:
        return _to_message(reasoner, different)
    if (excluded := refute(reasoner, first, allow_recompute=recompute)) is not None:
        message = _to_message(reasoner, excluded)
        raise errors.Refused(f"it does not hold: {message.text}", explanation=message)
    if not recompute:
        raise Undecided("no rule derives it, and none excludes it")
    near = _near(reasoner, asked)
    if (further := why_entailed(near, first, words=reasoner.words)) is not None:
        return _to_message(reasoner, further)
    if (excluded := why_excluded(near, first, words=reasoner.words)) is not None:
        message = _to_message(reasoner, excluded)
        raise errors.Refused(f"it does not hold: {message.text}", explanation=message)
    raise errors.Refused(f"it does not hold that {clause}, and nothing excludes it")


def _near(reasoner: Reasoner, asked: StatementQuestion) -> Reasoner:
    """Return a reasoner with the nearby triples, in which a proof is searched."""
    return Reasoner(nearby(reasoner, asked.terms), closed=reasoner.closed)


def could(
    reasoner: Reasoner, asked: StatementQuestion, *, recompute: bool = True, against: str | None = None
) -> Possible:
    """Return whether the statement could hold. The reasoner is unchanged. `against` is a geometric conflict.

    Raises:
        NotCompilable: everything must be computed again, and `recompute` is False.
    """
    triple = asked.triples[0]
    clause = triple_clause(triple, reasoner.words)
    if reasoner.holds(triple):
        return Possible(possible=True, text=f"yes: {clause} already")
    measured: list[Triple] = []
    try:
        while (excluded := refute(reasoner, triple, allow_recompute=recompute)) is not None:
            computed = [fact for fact in excluded.support if reasoner.is_computed(fact)]
            if not computed:
                text = f"no: {excluded.text}"
                return Possible(possible=False, text=text, explanation=_to_message(reasoner, excluded))
            reasoner.update_computed(remove=computed)  # computed facts never cause a commit to be rejected
            measured += computed
    finally:
        if measured:
            reasoner.update_computed(add=measured)
    text = f"yes: nothing excludes that {clause}"
    if measured:
        sentences = " and ".join(triple_clause(fact, reasoner.words) for fact in measured)
        text += f", although by their poses {sentences}"
    elif against is not None:
        text += f", but according to the poses, {against}"
    if same := sorted(_would_be_same(reasoner, triple)):
        text += "; but then " + " and ".join(triple_clause(pair, reasoner.words) for pair in same)
    return Possible(possible=True, text=text)


def _would_be_same(reasoner: Reasoner, triple: Triple) -> Iterator[Triple]:
    """Yield the equalities that a triple would imply, for example by a functional property."""
    s, p, o = triple
    if o.startswith('"') or p in RELATIONS.values():
        return
    others = [(o, y) for y in _known(reasoner, s, p, None, 2)] + [
        (s, x) for x in _known(reasoner, None, p, o, 0)
    ]
    pairs = [(x, v.OWL_SAME_AS, y) for x, y in others if x != y and not reasoner.holds((x, v.OWL_SAME_AS, y))]
    if not pairs:
        return
    try:
        with reasoner.assuming([triple]):
            same = [pair for pair in pairs if reasoner.holds(pair)]
    except Inconsistent:
        return
    yield from same


def _known(reasoner: Reasoner, s: Term | None, p: Term, o: Term | None, place: int) -> list[Term]:
    both = chain(reasoner.asserted(s, p, o), reasoner.inferred(s, p, o))
    return list(dict.fromkeys(triple[place] for triple in islice(both, _COMPARED)))


def _has_many(reasoner: Reasoner, term: Term) -> bool:
    about = chain(reasoner.asserted(term, None, None), reasoner.asserted(None, None, term))
    return next(islice(about, _QUICK, None), None) is not None
