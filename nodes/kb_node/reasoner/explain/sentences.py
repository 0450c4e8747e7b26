"""Explanations in words: one sentence, with names instead of IRIs, for somebody who builds robots."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import lru_cache
from typing import Final

from nodes.kb_node.reasoner.rules.rule_table import AXIOMS
from nodes.kb_node.reasoner.terms import (
    DIFFERENT_FROM,
    FIRST,
    NIL,
    REST,
    SAME_AS,
    TYPE,
    iri,
    iris,
    is_literal,
    literal,
)
from schemas.explanations import Step, Term, Triple

_STRUCTURE: Final = frozenset(
    iris(
        "rdf:first rdf:rest owl:onProperty owl:onClass owl:onDataRange owl:members owl:distinctMembers "
        "owl:sourceIndividual owl:assertionProperty owl:targetIndividual owl:targetValue owl:someValuesFrom "
        "owl:allValuesFrom owl:hasValue owl:maxCardinality owl:cardinality owl:maxQualifiedCardinality "
        "owl:qualifiedCardinality"
    )
)
"""Predicates that are told with the class or axiom they are a part of."""

_PHRASES: Final = {
    iri(name): phrase
    for name, phrase in {
        "rdfs:subClassOf": "every {s} is {a:o}",
        "owl:equivalentClass": "{s} and {o} are the same class",
        "owl:disjointWith": "nothing is both {a:s} and {a:o}",
        "owl:complementOf": "{s} is everything that is not {a:o}",
        "owl:intersectionOf": "{s} is what is {l:and}",
        "owl:unionOf": "{s} is what is {l:or}",
        "owl:oneOf": "{s} is one of {m:o}",
        "owl:hasKey": "{s} is identified by {m:o}",
        "rdfs:subPropertyOf": "whatever {s} relates, {o} relates",
        "owl:equivalentProperty": "{s} and {o} are the same property",
        "owl:propertyDisjointWith": "{s} and {o} never relate the same two things",
        "owl:inverseOf": "{s} is the inverse of {o}",
        "owl:propertyChainAxiom": "{p:o} make {s}",
        "rdfs:domain": "what has {s} is {a:o}",
        "rdfs:range": "a value of {s} is {a:o}",
        "owl:sameAs": "{s} is the same as {o}",
        "owl:differentFrom": "{s} is different from {o}",
    }.items()
}
_KINDS: Final = {
    iri(f"owl:{name}"): phrase
    for name, phrase in {
        "FunctionalProperty": "{s} has one value at most",
        "InverseFunctionalProperty": "a value of {s} belongs to one thing only",
        "IrreflexiveProperty": "{s} never relates a thing to itself",
        "SymmetricProperty": "{s} holds in both directions",
        "AsymmetricProperty": "{s} never holds in both directions",
        "TransitiveProperty": "{s} is passed on along itself",
        "AllDifferent": "{n:s} are all different",
        "AllDisjointClasses": "nothing is two of {n:s}",
        "AllDisjointProperties": "no two of {n:s} relate the same two things",
        "Class": "{s} is a class",
    }.items()
}


_LIMITS: Final = ("prp-fp", "prp-ifp", "cls-maxc2", "cls-maxqc3", "cls-maxqc4")


class _Speaker:
    """Names for terms; anonymous classes and lists are told by what the given triples say of them."""

    def __init__(self, triples: Sequence[Triple]) -> None:
        self._values: dict[tuple[Term, Term], Term] = {}
        for s, p, o in triples:
            self._values.setdefault((s, p), o)

    def name(self, term: Term) -> str:
        if is_literal(term):
            return f'"{literal(term).text}"'
        if term.startswith("_:"):
            return self._anonymous(term)
        return local_name(term)

    def a(self, term: Term) -> str:
        name = self.name(term)
        if not name[:1].isalnum() or name.startswith(("something ", "a ", "an ")) or " " in name:
            return name
        return f"{'an' if name[0] in 'aeiouAEIO' else 'a'} {name}"

    def each(self, head: Term, last: str, article: bool = False) -> str:
        names = [self.a(member) if article else self.name(member) for member in self.members(head)]
        return f"{', '.join(names[:-1])} {last} {names[-1]}" if len(names) > 1 else ", ".join(names)

    def members(self, head: Term) -> list[Term]:
        found: list[Term] = []
        while head != NIL and (head, FIRST) in self._values and len(found) <= len(self._values):
            found.append(self._values[head, FIRST])
            head = self._values.get((head, REST), NIL)
        return found

    def say(self, triple: Triple, subject: Term | None = None) -> str:
        """A triple as a clause; `subject` is the individual that is called "it"."""
        s, p, o = triple
        template = _KINDS.get(o) if p == TYPE else _PHRASES.get(p)
        who = "it" if s == subject else self.name(s)
        if p in (SAME_AS, DIFFERENT_FROM):
            return self._fill(template or "", s, o).replace(self.name(s), who, 1)
        if template is not None:
            return self._fill(template, s, o)
        if p == TYPE:
            return f"{who} is {self.a(o)}"
        return f"{who} {self.name(p)} {'itself' if s == o else self.name(o)}"

    def _fill(self, template: str, s: Term, o: Term) -> str:
        members = self._get(s, "owl:members") or self._get(s, "owl:distinctMembers") or NIL
        fillers = {
            "{s}": lambda: self.name(s),
            "{o}": lambda: self.name(o),
            "{a:s}": lambda: self.a(s),
            "{a:o}": lambda: self.a(o),
            "{l:and}": lambda: self.each(o, "and", article=True),
            "{l:or}": lambda: self.each(o, "or", article=True),
            "{m:o}": lambda: self.each(o, "and"),
            "{p:o}": lambda: " then ".join(map(self.name, self.members(o))),
            "{n:s}": lambda: self.each(members, "and"),
        }
        return re.sub(r"\{[^}]*\}", lambda found: fillers[found[0]](), template)

    def _get(self, subject: Term, name: str) -> Term | None:
        return self._values.get((subject, iri(name)))

    def _anonymous(self, node: Term) -> str:
        prop = self._get(node, "owl:onProperty")
        if prop is not None:
            return self._restriction(node, self.name(prop))
        for name, last in (("owl:unionOf", "or"), ("owl:intersectionOf", "and")):
            if head := self._get(node, name):
                return f"something that is {self.each(head, last, article=True)}"
        if head := self._get(node, "owl:oneOf"):
            return f"one of {self.each(head, 'and')}"
        if negated := self._get(node, "owl:complementOf"):
            return f"something that is not {self.a(negated)}"
        return "something unnamed"

    def _restriction(self, node: Term, prop: str) -> str:
        if filler := self._get(node, "owl:someValuesFrom"):
            return f"something with {prop} to {self.a(filler)}"
        if filler := self._get(node, "owl:allValuesFrom"):
            return f"something whose every {prop} is {self.a(filler)}"
        if filler := self._get(node, "owl:hasValue"):
            return f"something with {prop} {self.name(filler)}"
        for name in ("maxCardinality", "maxQualifiedCardinality", "cardinality", "qualifiedCardinality"):
            if number := self._get(node, f"owl:{name}"):
                kind = self._get(node, "owl:onClass") or self._get(node, "owl:onDataRange")
                most = "no" if literal(number).text == "0" else "at most one"
                return f"something with {most} {prop}" + (f" to {self.a(kind)}" if kind else "")
        return f"something with {prop}"


@lru_cache(maxsize=4096)
def local_name(term: Term) -> str:
    """How an IRI is called: its last part."""
    return re.split(r"[#/]", term.strip("<>").rstrip("#/"))[-1] or term


def sentence(goal: Triple | None, support: Sequence[Triple], steps: Sequence[Step]) -> str:
    """Tell a proof: what is the case or cannot be, and the asserted facts that make it so."""
    speaker = _Speaker(support)
    if goal is not None and not steps:
        return f"{speaker.say(goal)} ({'asserted' if support else 'always'})."
    subject, headline = _headline(goal, steps, speaker)
    clauses: list[str] = []
    for triple in support:
        if triple[1] in _STRUCTURE or (triple[0].startswith("_:") and _is_part(triple)):
            continue
        told = _is_schema(triple)
        clauses.append(speaker.say(triple, subject) + ("" if told else " (asserted)"))
    clauses += [_negative(triple, speaker) for triple in support if triple[1] == iri("owl:assertionProperty")]
    return f"{headline}: {', '.join(clauses)}." if clauses else f"{headline}."


def _is_schema(triple: Triple) -> bool:
    _, p, o = triple
    said = p in _PHRASES and p not in (SAME_AS, DIFFERENT_FROM)
    return said or (p == TYPE and o in _KINDS) or triple in AXIOMS


def _is_part(triple: Triple) -> bool:
    """Whether a triple about a blank node is told where the node is named."""
    return triple[1] in iris("owl:unionOf owl:intersectionOf owl:oneOf owl:complementOf")


def _negative(triple: Triple, speaker: _Speaker) -> str:
    node, _, prop = triple
    source = speaker.name(speaker._get(node, "owl:sourceIndividual") or node)
    target = speaker._get(node, "owl:targetIndividual") or speaker._get(node, "owl:targetValue") or node
    return f"{source} is stated not to have {speaker.name(prop)} {speaker.name(target)}"


def _headline(goal: Triple | None, steps: Sequence[Step], speaker: _Speaker) -> tuple[Term | None, str]:
    """Who it is about, and the claim."""
    if goal is not None:
        return goal[0], f"{speaker.say(goal)} because"
    last = steps[-1]
    facts = [triple for triple in last.premises if not _is_schema(triple) and triple[1] not in _STRUCTURE]
    s, p, o = facts[0] if facts else last.premises[0]
    who, what = speaker.name(s), speaker.name(p)
    if last.rule in ("cax-dw", "cax-adc", "cls-com") and len({fact[2] for fact in facts}) > 1:
        return s, f"{who} cannot be both {speaker.a(o)} and {speaker.a(facts[1][2])}"
    if last.rule == "dt-not-type":
        return _ill_typed((s, p, o), speaker)
    if last.rule.startswith("eq-diff"):
        if s == o:
            return s, f"{who} cannot be different from itself"
        if told := _one_too_many({(s, o), (o, s)}, steps, speaker):
            return told
        return s, f"{who} and {speaker.name(o)} cannot be both the same and different"
    if last.rule in ("cls-nothing2", "cax-dw", "cax-adc", "cls-com"):
        return s, f"{who} cannot be {speaker.a(o)}"
    if last.rule == "prp-irp" or s == o:
        return s, f"{who} cannot have {what} to itself"
    if last.rule == "prp-asyp":
        return s, f"{who} and {speaker.name(o)} cannot have {what} in both directions"
    if last.rule in ("prp-pdw", "prp-adp"):
        other = speaker.name(facts[-1][1])
        return s, f"{who} cannot have both {what} and {other} to {speaker.name(o)}"
    return s, f"{who} cannot have {what} {speaker.name(o)}"


def _one_too_many(
    pairs: set[tuple[Term, Term]], steps: Sequence[Step], speaker: _Speaker
) -> tuple[Term, str] | None:
    """The claim when two values that differ had to be the same: who has them, by which property."""
    for step in steps:
        fact = step.conclusion
        if fact is None or (fact[0], fact[2]) not in pairs or step.rule not in _LIMITS:
            continue
        first, second = [triple for triple in step.premises if _is_value(triple, fact, step.rule)][:2]
        what = speaker.name(first[1])
        if step.rule == "prp-ifp":
            names = " and ".join(map(speaker.name, (first[0], second[0])))
            return first[2], f"{speaker.name(first[2])} cannot be the {what} of both {names}"
        names = " and ".join(map(speaker.name, (first[2], second[2])))
        return first[0], f"{speaker.name(first[0])} cannot have both {names} as {what}"
    return None


def _is_value(triple: Triple, fact: Triple, rule: str) -> bool:
    """Whether a premise relates the owner to one of the two values."""
    return triple[1] != TYPE and triple[0 if rule == "prp-ifp" else 2] in (fact[0], fact[2])


def _ill_typed(fact: Triple, speaker: _Speaker) -> tuple[Term, str]:
    """The claim is about the literal, so who has it is named in the facts."""
    s, p, o = fact
    text, kind = (s, o) if p == TYPE and is_literal(s) else (o, f"<{literal(o).datatype}>")
    return text, f"{speaker.name(text)} is not a value of {speaker.name(kind)}"
