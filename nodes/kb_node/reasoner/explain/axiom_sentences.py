"""Axioms of the TBox as English clauses: "every beer is a drink", "nothing has more than one mass"."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Final

from semmap.nodes.kb_node.reasoner.data_ranges import read_range
from semmap.nodes.kb_node.reasoner.explain.words import VerbPhrase, Words, article, is_uncountable
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.terms import (
    FIRST,
    NIL,
    NOTHING,
    REST,
    THING,
    TYPE,
    iri,
    is_literal,
    is_named,
    literal,
)

if TYPE_CHECKING:
    from semmap.nodes.kb_node.reasoner.rules.swrl import Atom, SwrlRule

_BOUNDS: Final = (
    "owl:maxCardinality", "owl:maxQualifiedCardinality", "owl:cardinality", "owl:qualifiedCardinality",
    "owl:minCardinality", "owl:minQualifiedCardinality",
)  # fmt: skip


class AxiomVerbalizer:
    """Converts axioms to clauses. Anonymous classes and lists are read from the given triples."""

    def __init__(self, triples: Sequence[Triple], words: Words) -> None:
        self._words = words
        self._values: dict[tuple[Term, Term], Term] = {}
        for s, p, o in triples:
            self._values.setdefault((s, p), o)
        from semmap.nodes.kb_node.reasoner.rules import swrl
        from semmap.nodes.kb_node.reasoner.rules.facts import Facts  # importing words does not load the rules

        self._facts = Facts(dict.fromkeys(triples))
        mentions = [triple for triple in triples if triple[1] not in (FIRST, REST)]
        self._mentioned = {term for s, _, o in mentions for term in (s, o)}
        self._relations: Final[dict[Term, Callable[[Term, Term], str]]] = {
            iri("rdfs:subClassOf"): self._sub_class,
            iri("owl:equivalentClass"): self._same_class,
            iri("owl:disjointWith"): self._disjoint,
            iri("owl:complementOf"): lambda c, d: self._defined(c, self._negated(d)),
            iri("owl:intersectionOf"): lambda c, head: self._defined(c, self._all_of(head)),
            iri("owl:unionOf"): lambda c, head: self._defined(c, self._one_of(head)),
            iri("owl:disjointUnionOf"): lambda c, head: self._defined(c, f"is either {self._either(head)}"),
            iri("owl:oneOf"): lambda c, head: f"{self.member_phrase(c)} is one of {self._names(head)}",
            iri("owl:hasKey"): self._key,
            iri("rdfs:subPropertyOf"): self._sub_property,
            iri("owl:equivalentProperty"): self._same_property,
            iri("owl:propertyDisjointWith"): lambda p, q: self._never_both([p, q]),
            iri("owl:inverseOf"): self._inverse,
            iri("owl:propertyChainAxiom"): self._chain,
            iri("rdfs:domain"): self._domain,
            iri("rdfs:range"): self._range,
        }
        self._kinds: Final[dict[Term, Callable[[Term], str]]] = {
            iri("owl:FunctionalProperty"): self._functional,
            iri("owl:InverseFunctionalProperty"): self._inverse_functional,
            iri("owl:IrreflexiveProperty"): lambda p: f"nothing {self.verb_phrase(p).with_pronoun('itself')}",
            iri("owl:ReflexiveProperty"): lambda p: (
                f"everything {self.verb_phrase(p).with_pronoun('itself')}"
            ),
            iri("owl:SymmetricProperty"): lambda p: self._reversed(p, self.verb_phrase(p).with_pronoun("it")),
            iri("owl:AsymmetricProperty"): self._asymmetric,
            iri("owl:TransitiveProperty"): lambda p: self._chained([p, p], p),
            iri("owl:AllDifferent"): self._all_different,
            iri("owl:AllDisjointClasses"): self._disjoint_classes,
            iri("owl:AllDisjointProperties"): lambda x: self._never_both(self.members(self._list(x))),
            swrl.RULE: self._rule,
            iri("owl:Class"): lambda c: f"{self.member_phrase(c)} is a class",
        }

    def axiom_clause(self, triple: Triple) -> str | None:
        """Return an axiom as a clause; None if the triple is not an axiom."""
        s, p, o = triple
        if p == TYPE:
            return self._kinds[o](s) if o in self._kinds else None
        return self._relations[p](s, o) if p in self._relations else None

    def definition(self, cls: Term) -> str:
        """Return the clause that defines a named class which is itself a restriction."""
        return self._defined(cls, self._restricted(cls, self.get(cls, "owl:onProperty") or cls))

    def is_axiom(self, triple: Triple) -> bool:
        """Return whether a triple is an axiom that has a clause."""
        _, p, o = triple
        return p in self._relations or (p == TYPE and o in self._kinds)

    # Classes

    def member_phrase(self, cls: Term) -> str:
        """Return a phrase for a member of a class: "a beer", "something that is on a table"."""
        if is_named(cls):
            special = {THING: "something", NOTHING: "a member of the empty class"}
            return special.get(cls) or article(self._words.cls(cls))
        if is_literal(cls):
            return self._words.name(cls)
        return f"something that {self.membership(cls)}"

    def membership(self, cls: Term) -> str:
        """Return the verb phrase for membership in a class: "is a beer", "has affordance drinking"."""
        if is_named(cls):
            return f"is {self.member_phrase(cls)}"
        if prop := self.get(cls, "owl:onProperty"):
            return self._restricted(cls, prop)
        if phrase := self.range_phrase(cls):
            return f"is {article(phrase)}"
        if head := self.get(cls, "owl:intersectionOf"):
            return self._all_of(head)
        if head := self.get(cls, "owl:unionOf"):
            return self._one_of(head)
        if head := self.get(cls, "owl:oneOf"):
            return f"is one of {self._names(head)}"
        if negated := self.get(cls, "owl:complementOf"):
            return self._negated(negated)
        return "belongs to an anonymous class"

    def range_phrase(self, cls: Term) -> str:
        """Return a phrase for an anonymous data range, such as `integer from 0 to 100`, or ""."""
        found = None if is_named(cls) else read_range(cls, self._facts.match)
        return "" if found is None else found[0].text

    def _restricted(self, cls: Term, prop: Term) -> str:
        verb = self.verb_phrase(prop)
        if filler := self.get(cls, "owl:someValuesFrom"):
            return self._some(prop, filler)
        if filler := self.get(cls, "owl:allValuesFrom"):
            only = f"only something that {self.membership(filler)}"
            return f"has {only} as {verb.rest}" if verb.kind == "has" else verb.with_object(only)
        if value := self.get(cls, "owl:hasValue"):
            if is_named(prop):
                return self._words.predicate_phrase(prop, value)
            return verb.with_object(self._words.name(value))
        if self.get(cls, "owl:hasSelf"):
            return verb.with_pronoun("itself")
        for name in _BOUNDS:
            if number := self.get(cls, name):
                kind = self.get(cls, "owl:onClass") or self.get(cls, "owl:onDataRange")
                text = literal(number).text
                least = "at least" if "min" in name else "at most"
                bound = {"0": "no", "1": f"{least} one"}.get(text, f"{least} {text}")
                return verb.with_count(bound, self._noun(kind) if kind else "")
        return self._some(prop)

    def _noun(self, cls: Term) -> str:
        return self._words.cls(cls) if is_named(cls) else f"thing that {self.membership(cls)}"

    def _negated(self, cls: Term) -> str:
        return f"is not {self.member_phrase(cls)}"

    def _all_of(self, head: Term) -> str:
        members = self.members(head)
        if all(map(is_named, members)):
            return f"is {_listed([self.member_phrase(member) for member in members], 'and')}"
        return _listed([self.membership(member) for member in members], "and")

    def _one_of(self, head: Term) -> str:
        members = self.members(head)
        if all(map(is_named, members)):
            return f"is {_listed([self.member_phrase(member) for member in members], 'or')}"
        return _listed([self.membership(member) for member in members], "or")

    def _either(self, head: Term) -> str:
        return _listed([self.member_phrase(member) for member in self.members(head)], "or")

    def _sub_class(self, narrow: Term, wide: Term) -> str:
        if wide == NOTHING:
            return f"nothing is {self.member_phrase(narrow)}"
        if is_named(narrow):
            noun = self._words.cls(narrow)
            subject = f"everything that is {noun}" if is_uncountable(noun) else f"every {noun}"
            return f"{subject} {self.membership(wide)}"
        return f"everything that {self.membership(narrow)} {self.membership(wide)}"

    def _same_class(self, one: Term, other: Term) -> str:
        if not is_named(one):
            one, other = other, one
        if is_named(other):
            return f"{self._sub_class(one, other)}, and vice versa"
        return self._defined(one, self.membership(other))

    def _defined(self, cls: Term, predicate: str) -> str:
        return f"{self.member_phrase(cls)} is by definition something that {predicate}"

    def _disjoint(self, one: Term, other: Term) -> str:
        return f"nothing is both {self.member_phrase(one)} and {self.member_phrase(other)}"

    def _disjoint_classes(self, axiom: Term) -> str:
        members = [self.member_phrase(member) for member in self._relevant_members(axiom)]
        return f"nothing is {'both' if len(members) == 2 else 'more than one of'} {_listed(members, 'and')}"

    def _all_different(self, axiom: Term) -> str:
        members = [self._words.name(member) for member in self._relevant_members(axiom)]
        return f"{_listed(members, 'and')} are {'' if len(members) == 2 else 'all '}different"

    def _relevant_members(self, axiom: Term) -> list[Term]:
        """Return the members of an axiom's list that occur elsewhere in the proof, or else all members."""
        members = self.members(self._list(axiom))
        relevant = [member for member in members if member in self._mentioned]
        return relevant if len(relevant) > 1 else members

    def _key(self, cls: Term, head: Term) -> str:
        shared = _listed([self._shared(prop) for prop in self.members(head)], "and")
        return f"no two things that are each {self.member_phrase(cls)} {shared}"

    # Properties

    def verb_phrase(self, prop: Term) -> VerbPhrase:
        """Return the verb phrase of a property, or of the inverse of one: "has inverse of “is on”"."""
        if not is_named(prop) and (inverse := self.get(prop, "owl:inverseOf")):
            return VerbPhrase("has", f"inverse of “{self.verb_phrase(inverse).with_object('').strip()}”")
        return self._words.verb_phrase(prop)

    def _some(self, prop: Term, filler: Term = THING) -> str:
        """Return the verb phrase for some value: "is on a table", "has a mass"."""
        verb = self.verb_phrase(prop)
        if filler == THING:
            return f"has {article(verb.rest)}" if verb.kind == "has" else verb.with_object("something")
        if verb.kind == "has":
            return f"has {article(verb.rest)} that {self.membership(filler)}"
        return verb.with_object(self.member_phrase(filler))

    def _shared(self, prop: Term) -> str:
        """Return the plural phrase for a shared value: "have the same mass", "are part of the same thing"."""
        verb = self.verb_phrase(prop)
        return f"have the same {verb.rest}" if verb.kind == "has" else f"{verb.plural} the same thing"

    def _functional(self, prop: Term) -> str:
        verb = self.verb_phrase(prop)
        if verb.kind == "has":
            return f"nothing has more than one {verb.rest}"
        if self._words.is_data(prop):
            return f"“{verb.kind} {verb.rest}” has at most one value"
        return f"nothing {verb.with_object('more than one thing')}"

    def _inverse_functional(self, prop: Term) -> str:
        return f"no two things {self._shared(prop)}"

    def _asymmetric(self, prop: Term) -> str:
        verb = self.verb_phrase(prop)
        if verb.kind == "has":
            return self._reversed(prop, f"does not have it as {verb.rest}")
        return self._reversed(prop, verb.with_negation("it"))

    def _reversed(self, prop: Term, predicate: str) -> str:
        return f"if one thing {self.verb_phrase(prop).with_pronoun('another')}, the other {predicate}"

    def _sub_property(self, narrow: Term, wide: Term) -> str:
        one, other = self.verb_phrase(narrow), self.verb_phrase(wide)
        return f"everything that {one.with_pronoun('something')} {other.with_pronoun('it')}"

    def _same_property(self, one: Term, other: Term) -> str:
        return f"{self._sub_property(one, other)}, and vice versa"

    def _inverse(self, one: Term, other: Term) -> str:
        return self._reversed(one, self.verb_phrase(other).with_pronoun("it"))

    def _never_both(self, props: Sequence[Term]) -> str:
        if len(props) == 2:
            one, other = map(self.verb_phrase, props)
            return f"nothing that {one.with_pronoun('something')} {other.with_pronoun('it')}"
        listed = _listed([self.verb_phrase(prop).with_pronoun("another") for prop in props], "or")
        return f"one thing never relates to another in more than one of these ways: {listed}"

    def _chain(self, prop: Term, head: Term) -> str:
        return self._chained(self.members(head), prop)

    def _chained(self, links: Sequence[Term], result: Term) -> str:
        path = " that ".join(self.verb_phrase(link).with_pronoun("something") for link in links)
        return f"everything that {path} {self.verb_phrase(result).with_pronoun('the latter')}"

    def _domain(self, prop: Term, cls: Term) -> str:
        verb = self.verb_phrase(prop)
        if verb.kind == "is" and self._words.is_data(prop):  # also for things that are not open
            return f"everything that has a value for “is {verb.rest}” {self.membership(cls)}"
        return f"everything that {self._some(prop)} {self.membership(cls)}"

    def _range(self, prop: Term, cls: Term) -> str:
        verb = self.verb_phrase(prop)
        if verb.kind == "has":
            same = is_named(cls) and self._words.cls(cls) == verb.rest
            subject = f"everything that something has as {verb.rest}" if same else f"every {verb.rest}"
            return f"{subject} {self.membership(cls)}"
        return f"everything that something {verb.with_object('').strip()} {self.membership(cls)}"

    # Rules

    def _rule(self, node: Term) -> str:
        from semmap.nodes.kb_node.reasoner.rules import swrl

        rules = [rule for rule in swrl.read(self._facts).supported if rule.node == node]
        return f"because of the rule “{self.rule_sentence(rules)}”" if rules else self._words.name(node)

    def is_part_of_rule(self, triple: Triple) -> bool:
        """Return whether a triple is included in the clause of a SWRL rule."""
        from semmap.nodes.kb_node.reasoner.rules import swrl

        return triple[2] != swrl.RULE and swrl.is_of_rule(triple)

    def rule_sentence(self, rules: Sequence[SwrlRule]) -> str:
        """Return a SWRL rule as a sentence: "if x is a cup and x is on y, then y is a table".

        `rules` has the rule once for each atom of its head.
        """
        body = [self._atom(atom) for atom in rules[0].body]
        head = [self._atom(rule.head) for rule in rules if rule.head is not None]
        if not head:
            return f"it is never true that {_listed(body, 'and')}"
        return f"if {_listed(body, 'and')}, then {_listed(head, 'and')}" if body else _listed(head, "and")

    def _atom(self, atom: Atom) -> str:
        from semmap.nodes.kb_node.reasoner.rules import builtins, swrl

        names = [self._argument(argument) for argument in atom.arguments]
        if atom.kind == swrl.CLASS:
            return f"{names[0]} {self.membership(atom.predicate)}"
        if atom.kind == swrl.SAME:
            return f"{names[0]} is the same as {names[1]}"
        if atom.kind == swrl.DIFFERENT:
            return f"{names[0]} is different from {names[1]}"
        if atom.kind == swrl.PROPERTY:
            if not swrl.is_variable(atom.arguments[1]):
                return f"{names[0]} {self._words.predicate_phrase(atom.predicate, atom.arguments[1])}"
            verb = self.verb_phrase(atom.predicate)
            if verb.kind == "is" and self._words.is_data(atom.predicate):
                return f"{names[0]} has {names[1]} as value of “is {verb.rest}”"
            return f"{names[0]} {verb.with_object(names[1])}"
        sign = builtins.SIGNS.get(atom.predicate)
        if builtins.is_comparison(atom.predicate):
            return f"{names[0]} {sign} {names[1]}"
        operands = f" {sign} ".join(names[1:]) if sign else f"{atom.predicate}({', '.join(names[1:])})"
        return f"{names[0]} = {operands}"

    def _argument(self, term: Term) -> str:
        return re.split(r"[#/:]", term.rstrip(">"))[-1] if term[0] == "?" else self._words.name(term)

    # Lists

    def get(self, subject: Term, name: str) -> Term | None:
        """Return the value of a property of a node."""
        return self._values.get((subject, iri(name)))

    def members(self, head: Term) -> list[Term]:
        """Return the members of an RDF list."""
        found: list[Term] = []
        while head != NIL and (head, FIRST) in self._values and len(found) <= len(self._values):
            found.append(self._values[head, FIRST])
            head = self._values.get((head, REST), NIL)
        return found

    def _list(self, axiom: Term) -> Term:
        return self.get(axiom, "owl:members") or self.get(axiom, "owl:distinctMembers") or NIL

    def _names(self, head: Term) -> str:
        return _listed(list(map(self._words.name, self.members(head))), "and")


def _listed(parts: Sequence[str], conjunction: str) -> str:
    """Join parts with commas, and the last part with a conjunction."""
    return f"{', '.join(parts[:-1])} {conjunction} {parts[-1]}" if len(parts) > 1 else "".join(parts)
