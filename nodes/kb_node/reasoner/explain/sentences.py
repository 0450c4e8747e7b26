"""Explanations as English sentences, with labels instead of IRIs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final, NamedTuple

from semmap.nodes.kb_node.reasoner.data_ranges import FACETS
from semmap.nodes.kb_node.reasoner.explain.axiom_sentences import AxiomVerbalizer
from semmap.nodes.kb_node.reasoner.explain.words import Words, base_form
from semmap.nodes.kb_node.reasoner.explanations import Step, Term, Triple
from semmap.nodes.kb_node.reasoner.terms import (
    DIFFERENT_FROM,
    SAME_AS,
    TYPE,
    iri,
    iris,
    is_literal,
    is_named,
    literal,
)

_STRUCTURE: Final = FACETS.union(
    iris(
        "owl:onDatatype owl:withRestrictions owl:datatypeComplementOf "
        "rdf:first rdf:rest owl:onProperty owl:onClass owl:onDataRange owl:members owl:distinctMembers "
        "owl:sourceIndividual owl:assertionProperty owl:targetIndividual owl:targetValue owl:someValuesFrom "
        "owl:allValuesFrom owl:hasValue owl:hasSelf owl:maxCardinality owl:cardinality "
        "owl:maxQualifiedCardinality owl:qualifiedCardinality owl:minCardinality owl:minQualifiedCardinality"
    )
)
"""Predicates that are included in the clause of their class or axiom."""
_PARTS: Final = frozenset(iris("owl:unionOf owl:intersectionOf owl:oneOf owl:complementOf owl:inverseOf"))
"""Predicates that are included where their anonymous subject occurs."""
_LIMITS: Final = ("prp-fp", "prp-ifp", "cls-maxc2", "cls-maxqc3", "cls-maxqc4")
_CLASHES: Final = ("cax-dw", "cax-adc", "cls-com")


def proof_sentence(
    goal: Triple | None, support: Sequence[Triple], steps: Sequence[Step], words: Words
) -> str:
    """Return the sentence of a proof: the conclusion or contradiction, and the asserted facts behind it."""
    verbalizer = _Verbalizer(support, words)
    if goal is not None:
        claim = verbalizer.clause(goal)
        if not steps:
            return f"{claim} ({'asserted' if support else 'axiomatic'})."
        return _because(claim, verbalizer.reasons(support, goal))
    subject, headline = _headline(steps, verbalizer)
    reasons = verbalizer.reasons(support, (subject, TYPE, "") if subject else None)
    return f"{headline}: {_joined(reasons)}." if reasons else f"{headline}."


def entailment_sentence(goal: Triple, support: Sequence[Triple], words: Words) -> str:
    """Return the sentence of a proof without rules: the conclusion and its support, facts before axioms."""
    verbalizer = _Verbalizer((*support, goal), words)
    facts_first = sorted(support, key=verbalizer.axioms.is_axiom)
    claim = verbalizer.clause(goal)
    return _because(claim, verbalizer.reasons(facts_first, goal)) if support else f"{claim} (axiomatic)."


def refutation_sentence(supposed: Triple, support: Sequence[Triple], words: Words) -> str:
    """Return the sentence of a refutation: the negated assumption, and the triples that contradict it."""
    verbalizer = _Verbalizer(support, words)
    others = [triple for triple in support if triple != supposed]
    others.sort(key=verbalizer.axioms.is_axiom)  # facts before axioms
    claim = verbalizer.negated_clause(supposed)
    reasons = verbalizer.reasons(others, supposed)
    is_asserted = claim in map(verbalizer.clause, others)
    if is_asserted or reasons == [f"{claim} (asserted)"]:
        return f"{claim} (asserted)."
    return _because(claim, reasons)


def triple_clause(triple: Triple, words: Words) -> str:
    """Return a triple as a clause: "milk1 is on counter1"."""
    return _Verbalizer((triple,), words).clause(triple)


class Clause(NamedTuple):
    """A triple in words, and whether it is an axiom of the TBox rather than a fact."""

    text: str
    is_axiom: bool


def clauses(triples: Iterable[Triple], proof: Sequence[Triple], words: Words) -> dict[Triple, Clause]:
    """Return triples of a proof as clauses. Parts of an axiom are included in the clause of the axiom.

    `proof` has all triples of the proof, which define the anonymous classes and lists.
    """
    verbalizer = _Verbalizer(proof, words)
    return {
        triple: Clause(verbalizer.clause(triple), verbalizer.axioms.is_axiom(triple))
        for triple in triples
        if not verbalizer.is_part_of_axiom(triple)
    }


def mark_measured(text: str, facts: Iterable[Triple], words: Words) -> str:
    """Return the sentence of a proof with the computed `facts` marked as measured instead of asserted."""
    for fact in facts:
        verbalizer = _Verbalizer((fact,), words)
        for subject in (None, "it"):
            clause = verbalizer.clause(fact, subject)
            text = text.replace(f"{clause} (asserted)", f"{clause} (measured)")
    return text


def _because(claim: str, reasons: Sequence[str]) -> str:
    reasons = sorted(reasons, key=lambda reason: reason.startswith("because "))  # rules are last
    return f"{claim}, because {_joined(reasons).removeprefix('because ')}." if reasons else f"{claim}."


def _joined(clauses: Sequence[str]) -> str:
    return f"{', '.join(clauses[:-1])}, and {clauses[-1]}" if len(clauses) > 1 else "".join(clauses)


class _Verbalizer:
    """Converts the triples of one proof to clauses."""

    def __init__(self, triples: Sequence[Triple], words: Words) -> None:
        self.axioms = AxiomVerbalizer(triples, words)
        self.words = words

    def name(self, term: Term) -> str:
        """Return the name of an individual, or a value."""
        return self.words.name(term)

    def member_phrase(self, cls: Term) -> str:
        """Return a phrase for a member of a class."""
        return self.axioms.member_phrase(cls)

    def clause(self, triple: Triple, subject: str | None = None) -> str:
        """Return a triple as a clause. `subject` replaces the name of its subject."""
        axiom = self.axioms.axiom_clause(triple)
        if axiom is not None:
            return axiom
        s, p, o = forwards = self.forwards(triple)
        subject = self.name(s) if forwards != triple else subject or self.name(s)
        if p == TYPE:
            return f"{subject} {self.axioms.membership(o)}"
        if p == SAME_AS:
            return f"{subject} is the same as {self.name(o)}"
        if p == DIFFERENT_FROM:
            return f"{subject} is different from {'itself' if s == o else self.name(o)}"
        return f"{subject} {self.words.predicate_phrase(p, o, reflexive=s == o)}"

    def forwards(self, triple: Triple) -> Triple:
        """Return the triple of the property itself for that of its anonymous inverse."""
        s, p, o = triple
        inverse = None if is_named(p) else self.axioms.get(p, "owl:inverseOf")
        return triple if inverse is None else (o, inverse, s)

    def negated_clause(self, triple: Triple) -> str:
        """Return the negation of a triple as a clause."""
        s, p, o = triple
        if self.axioms.is_axiom(triple):
            return f"it is not true that {self.clause(triple)}"
        if p == SAME_AS:
            return f"{self.name(s)} is different from {self.name(o)}"
        if p == DIFFERENT_FROM:
            return f"{self.name(s)} is the same as {self.name(o)}"
        if p == TYPE:
            return f"{self.name(s)} is not {self.member_phrase(o)}"
        return f"{self.name(s)} {self.words.predicate_phrase(p, o, negated=True, reflexive=s == o)}"

    def reasons(self, support: Sequence[Triple], claim: Triple | None) -> list[str]:
        """Return the clauses of a support, in order.

        A subject is replaced by "it" if it is the only individual named in the clause before.
        """
        clauses: list[str] = []
        before = self._sole_individual(claim) if claim else None
        for triple in support:
            if triple[1] == iri("owl:assertionProperty"):
                clauses.append(self._negative(triple))
                before = None
            if triple[1] == iri("owl:onProperty") and is_named(triple[0]):
                clauses.append(self.axioms.definition(triple[0]))
                before = None
            if self.is_part_of_axiom(triple):
                continue
            if self.axioms.is_axiom(triple):
                clauses.append(self.clause(triple))
                before = None
                continue
            clauses.append(f"{self.clause(triple, 'it' if triple[0] == before else None)} (asserted)")
            before = self._sole_individual(triple)
        return clauses

    def _sole_individual(self, triple: Triple) -> Term | None:
        """Return the subject of a triple if its clause names no other individual, else None."""
        s, p, o = triple
        return s if p == TYPE or is_literal(o) or s == o else None

    def is_part_of_axiom(self, triple: Triple) -> bool:
        """Return whether a triple is part of an axiom and therefore has no clause of its own."""
        return triple[1] in _STRUCTURE or self._is_part(triple) or self.axioms.is_part_of_rule(triple)

    def _is_part(self, triple: Triple) -> bool:
        s, p, o = triple
        if not s.startswith("_:"):
            return False
        return p in _PARTS or (p == TYPE and o == iri("owl:NegativePropertyAssertion"))

    def _negative(self, triple: Triple) -> str:
        node, _, prop = triple
        get = self.axioms.get
        source = get(node, "owl:sourceIndividual") or node
        target = get(node, "owl:targetIndividual") or get(node, "owl:targetValue") or node
        return f"{self.negated_clause((source, prop, target))} (asserted)"


def _headline(steps: Sequence[Step], verbalizer: _Verbalizer) -> tuple[Term | None, str]:
    """Return the subject of a contradiction, if there is only one, and the clause that states it."""
    last = steps[-1]
    is_axiom = verbalizer.axioms.is_axiom
    facts = [triple for triple in last.premises if not is_axiom(triple) and triple[1] not in _STRUCTURE]
    s, p, o = verbalizer.forwards(facts[0] if facts else last.premises[0])
    name = verbalizer.name(s)
    if last.rule in _CLASHES and len({fact[2] for fact in facts}) > 1:
        one, other = verbalizer.member_phrase(o), verbalizer.member_phrase(facts[1][2])
        return s, f"{name} cannot be both {one} and {other}"
    if last.rule == "dt-not-type":
        return None, _ill_typed((s, p, o), verbalizer)
    if last.rule.startswith("eq-diff"):
        if s == o:
            return s, f"{name} cannot be different from itself"
        if claim := _value_conflict({(s, o), (o, s)}, steps, verbalizer):
            return None, claim
        return None, f"{name} and {verbalizer.name(o)} cannot be both the same and different"
    if last.rule in ("cls-nothing2", *_CLASHES):
        return s, f"{name} cannot be {verbalizer.member_phrase(o)}"
    if last.rule == "prp-asyp" and s != o:
        predicate = _infinitive(verbalizer.words.verb_phrase(p).with_pronoun("the other"))
        return None, f"{name} and {verbalizer.name(o)} cannot each {predicate}"
    if last.rule in ("prp-pdw", "prp-adp") and len(facts) > 1:
        phrase = verbalizer.words.predicate_phrase
        predicates = [_infinitive(phrase(q, y, reflexive=x == y)) for x, q, y in facts]
        return None, f"{name} cannot both {predicates[0]} and {predicates[-1]}"
    return None, f"{name} cannot {_infinitive(verbalizer.words.predicate_phrase(p, o, reflexive=s == o))}"


def _infinitive(clause: str) -> str:
    """Return a verb phrase as it follows "cannot": "be on table1", "have mass 3"."""
    first, blank, rest = clause.partition(" ")
    base = {"is": "be", "has": "have", "does": "do"}.get(first)
    return base_form(clause) if base is None else base + blank + rest


def _value_conflict(
    pairs: set[tuple[Term, Term]], steps: Sequence[Step], verbalizer: _Verbalizer
) -> str | None:
    """Return the clause for two different values of a property that allows one; None if there are none."""
    for step in steps:
        fact = step.conclusion
        if fact is None or (fact[0], fact[2]) not in pairs or step.rule not in _LIMITS:
            continue
        first, second = [triple for triple in step.premises if _is_value(triple, fact, step.rule)][:2]
        verb = verbalizer.words.verb_phrase(first[1])
        if step.rule == "prp-ifp":
            names = " and ".join(map(verbalizer.name, (first[0], second[0])))
            if verb.kind == "has":
                return f"{verbalizer.name(first[2])} cannot be the {verb.rest} of both {names}"
            return f"{names} cannot both {_infinitive(verb.with_object(verbalizer.name(first[2])))}"
        names = " and ".join(map(verbalizer.name, (first[2], second[2])))
        name = verbalizer.name(first[0])
        if verb.kind == "has":
            return f"{name} cannot have both {names} as {verb.rest}"
        if verbalizer.words.is_data(first[1]) and verb.kind == "is":
            predicates = [
                verbalizer.words.predicate_phrase(first[1], value).removeprefix("is ")
                for value in (first[2], second[2])
            ]
            predicates.sort(key=lambda text: text.startswith("not "))
            return f"{name} cannot be both {predicates[0]} and {predicates[1]}"
        return f"{name} cannot {_infinitive(verb.with_object('both ' + names))}"
    return None


def _is_value(triple: Triple, fact: Triple, rule: str) -> bool:
    """Return whether a premise relates the owner to one of the two values."""
    return triple[1] != TYPE and triple[0 if rule == "prp-ifp" else 2] in (fact[0], fact[2])


def _ill_typed(fact: Triple, verbalizer: _Verbalizer) -> str:
    """Return the clause for a literal outside its datatype. Its subject is named in the facts."""
    s, p, o = fact
    text, kind = (s, o) if p == TYPE and is_literal(s) else (o, f"<{literal(o).datatype}>")
    own, words, name = f"<{literal(text).datatype}>", verbalizer.words, verbalizer.name(text)
    wanted = verbalizer.axioms.range_phrase(kind) or words.cls(kind)
    found = f"{name} ({words.cls(own)})" if own != kind else name
    return f"{found} is not {wanted if wanted.startswith('one of ') else f'a value of {wanted}'}"
