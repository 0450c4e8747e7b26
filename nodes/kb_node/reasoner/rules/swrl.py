"""SWRL rules: reading them from triples, and which of them are supported.

A supported rule is a Horn clause over classes, properties, owl:sameAs, owl:differentFrom and the built-ins
of `builtins.py`. Every variable is bound by a class or property in the body, or is calculated
from such variables. A rule with several head atoms is read as several rules.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence, Set
from typing import Final, NamedTuple

from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.rules import builtins
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.nodes.kb_node.reasoner.terms import DIFFERENT_FROM, FIRST, REST, SAME_AS, TYPE, iri, is_literal

NAMESPACE: Final = "<http://www.w3.org/2003/11/swrl#"
RULE: Final = f"{NAMESPACE}Imp>"
CLASS, PROPERTY, SAME, DIFFERENT, BUILT_IN = "class", "property", "same", "different", "built-in"
"""The kinds of atoms."""
_ENABLED: Final = "<http://swrl.stanford.edu/ontologies/3.3/swrla.owl#isRuleEnabled>"
_FALSE: Final = ("false", "0")


class Atom(NamedTuple):
    """An atom of a rule. Variables start with a question mark."""

    kind: str
    predicate: Term
    """The class or property; the local name of a built-in."""
    arguments: tuple[Term, ...]

    @property
    def variables(self) -> set[Term]:
        """The variables of the atom."""
        return set(filter(is_variable, self.arguments))


class SwrlRule(NamedTuple):
    """A supported rule with one head atom."""

    node: Term
    body: tuple[Atom, ...]
    head: Atom | None
    """None for a rule without a head: then its body must not hold."""
    triples: tuple[Triple, ...]
    """The asserted triples of the rule."""


class Rules(NamedTuple):
    """The rules of a graph: the supported ones, and the reason for each of the others."""

    supported: list[SwrlRule]
    unsupported: dict[Term, str]


class _Unsupported(Exception):
    """A rule is not supported. The message is a reason that several rules may share."""


def is_variable(term: Term) -> bool:
    """Return whether an argument of an atom is a variable."""
    return term[0] == "?"


def is_in_vocabulary(term: Term) -> bool:
    """Return whether a term is a class or property of the vocabulary of rules."""
    return term.startswith(NAMESPACE) or term == _ENABLED


def is_of_rule(triple: Triple) -> bool:
    """Return whether a triple is a part of a rule, apart from its lists."""
    return is_in_vocabulary(triple[2] if triple[1] == TYPE else triple[1])


def read_triples(triples: Iterable[Triple]) -> Rules:
    """Return the rules of a graph."""
    triples = list(triples)
    if not any(p == TYPE and o == RULE for _, p, o in triples):
        return Rules([], {})
    return read(Facts(dict.fromkeys(t for t in triples if is_of_rule(t) or t[1] in _OF_FLOW)))


def read(facts: Facts) -> Rules:
    """Return the rules of a graph."""
    found = Rules([], {})
    for node in dict.fromkeys(s for s, _, _ in facts.match(None, TYPE, RULE)):
        try:
            found.supported.extend(_Reader(facts, node).rules())
        except _Unsupported as reason:
            found.unsupported[node] = str(reason)
    for node in _recursive(found.supported, facts):
        found.unsupported[node] = "recursion through arithmetic"
    found.supported[:] = [rule for rule in found.supported if rule.node not in found.unsupported]
    return found


def ordered(body: Iterable[Atom], bound: Set[Term]) -> tuple[Atom, ...]:
    """Return the atoms of a body in an order in which they can be matched. `bound` variables are known.

    Raises ValueError if a variable cannot be bound.
    """
    rest, bound = list(body), set(bound)
    matched = find_matched(rest)
    found: list[Atom] = []
    while rest:
        best = min(rest, key=lambda atom: _rank(atom, bound, matched))
        if _rank(best, bound, matched) == _NEVER:
            raise ValueError(f"unbound variable in {best.kind}")
        rest.remove(best)
        found.append(best)
        bound |= best.variables
    return tuple(found)


_NEVER: Final = 9


def find_matched(body: Iterable[Atom]) -> set[Term]:
    """Return the variables of classes and properties. The others are calculated."""
    return set[Term]().union(*(atom.variables for atom in body if atom.kind in (CLASS, PROPERTY)))


def _rank(atom: Atom, bound: Set[Term], matched: Set[Term]) -> int:
    """Return how early an atom is matched: a small number if it has few matches.

    A `matched` variable is compared with the result of a calculation, and not bound by it.
    """
    unknown = atom.variables - bound
    if not unknown:
        return 0
    if atom.kind == BUILT_IN and not builtins.is_comparison(atom.predicate):
        needed = set(filter(is_variable, atom.arguments[1:])) | (matched & set(atom.arguments[:1]))
        return _NEVER if needed - bound else 1
    if atom.kind == PROPERTY:
        return 2 if len(unknown) < len(atom.arguments) else 4
    return 3 if atom.kind == CLASS else _NEVER


def read_all_different(facts: Facts) -> list[tuple[frozenset[Term], tuple[Triple, ...]]]:
    """Return the members of each AllDifferent axiom, with its triples."""
    found: list[tuple[frozenset[Term], tuple[Triple, ...]]] = []
    for kind in facts.match(None, TYPE, _ALL_DIFFERENT):
        for predicate in _LISTS:
            for head in facts.match(kind[0], predicate):
                members, cells = facts.members(head[2]) or ([], ())
                found.append((frozenset(members), (kind, head, *cells)))
    return found


class _Reader:
    """Reads one rule, and collects its triples."""

    def __init__(self, facts: Facts, node: Term) -> None:
        self._facts = facts
        self._node = node
        self._triples: dict[Triple, None] = {(node, TYPE, RULE): None}

    def rules(self) -> Iterator[SwrlRule]:
        """Yield the rule, once for each atom of its head."""
        for _, _, value in self._facts.match(self._node, _ENABLED):
            if value.strip('"').partition('"')[0] in _FALSE:
                raise _Unsupported("disabled")
        body, head = self._atoms("body"), self._atoms("head")
        if not (body or head):
            raise _Unsupported("empty")
        try:
            order = ordered(body, set())
        except ValueError:
            raise _Unsupported("unbound variable") from None
        bound = set[Term]().union(*(atom.variables for atom in order))
        for atom in head:
            if atom.kind == BUILT_IN:
                raise _Unsupported("built-in in the head")
            if atom.variables - bound:
                raise _Unsupported("unbound variable")
        triples = tuple(self._triples)
        for one in head or (None,):
            yield SwrlRule(self._node, order, one, triples)

    def _atoms(self, name: str) -> list[Atom]:
        heads = self._values(self._node, name)
        found = self._facts.members(heads[0]) if len(heads) == 1 else None
        if found is None:
            raise _Unsupported(f"incomplete {name}")
        for cell in {cell[0]: None for cell in found[1]}:
            self._note(cell, TYPE)
        self._triples |= dict.fromkeys(found[1])
        return [self._atom(node) for node in found[0]]

    def _atom(self, node: Term) -> Atom:
        self._note(node, TYPE)
        types = {o for _, _, o in self._facts.match(node, TYPE)}
        for name, (kind, predicate) in _ATOMS.items():
            if f"{NAMESPACE}{name}>" in types:
                predicates = self._values(node, predicate) if predicate else [""]
                if len(predicates) != 1:
                    raise _Unsupported("incomplete atom")
                return self._read(node, kind, predicates[0])
        raise _Unsupported("unknown atom")

    def _read(self, node: Term, kind: str, predicate: Term) -> Atom:
        if kind == BUILT_IN:
            name = predicate.removeprefix(builtins.NAMESPACE).rstrip(">")
            heads = self._values(node, "arguments")
            found = self._facts.members(heads[0]) if len(heads) == 1 else None
            if found is None:
                raise _Unsupported("incomplete atom")
            self._triples |= dict.fromkeys(found[1])
            known = predicate.startswith(builtins.NAMESPACE)
            if not known or not builtins.is_supported(name, len(found[0])):
                raise _Unsupported(f"unsupported built-in {name.strip('<')}")
            return Atom(kind, name, tuple(map(self._argument, found[0])))
        names = ("argument1",) if kind == CLASS else ("argument1", "argument2")
        values = [self._values(node, name) for name in names]
        if any(len(one) != 1 for one in values):
            raise _Unsupported("incomplete atom")
        if kind == PROPERTY and predicate in (SAME_AS, DIFFERENT_FROM):
            kind, predicate = (SAME if predicate == SAME_AS else DIFFERENT), ""
        if kind == PROPERTY and predicate == TYPE:
            raise _Unsupported("unsupported property rdf:type")
        return Atom(kind, predicate, tuple(self._argument(one[0]) for one in values))

    def _argument(self, term: Term) -> Term:
        if not is_literal(term) and (term, TYPE, _VARIABLE) in self._facts.facts:
            self._triples[term, TYPE, _VARIABLE] = None
            return f"?{term}"
        return term

    def _values(self, node: Term, name: str) -> list[Term]:
        return [fact[2] for fact in self._note(node, f"{NAMESPACE}{name}>")]

    def _note(self, node: Term, predicate: Term) -> list[Triple]:
        """Return the asserted triples of a node, which belong to the rule. Equal terms get the others."""
        known = [t for t in self._facts.match(node, predicate) if self._facts.facts[t] is None]
        found = [t for t in known if predicate != TYPE or is_of_rule(t)]
        self._triples |= dict.fromkeys(found)
        return found


_ALL_DIFFERENT: Final = iri("owl:AllDifferent")
_LISTS: Final = iri("owl:members"), iri("owl:distinctMembers")
_VARIABLE: Final = f"{NAMESPACE}Variable>"
_ATOMS: Final = {
    "ClassAtom": (CLASS, "classPredicate"),
    "DataRangeAtom": (CLASS, "dataRange"),
    "IndividualPropertyAtom": (PROPERTY, "propertyPredicate"),
    "DatavaluedPropertyAtom": (PROPERTY, "propertyPredicate"),
    "SameIndividualAtom": (SAME, ""),
    "DifferentIndividualsAtom": (DIFFERENT, ""),
    "BuiltinAtom": (BUILT_IN, "builtin"),
}
_WIDER: Final = iri("rdfs:subPropertyOf"), iri("owl:equivalentProperty")
_CHAIN: Final = iri("owl:propertyChainAxiom")
_OF_FLOW: Final = (FIRST, REST, *_WIDER, _CHAIN)


def _recursive(rules: Sequence[SwrlRule], facts: Facts) -> Iterator[Term]:
    """Yield the rules that might calculate new values from their own results, without an end.

    Values flow from properties to wider properties, and from the body of a rule to its head.
    """
    flow: dict[Term, set[Term]] = {}
    calculated: list[tuple[Term, Term, Term]] = []
    for predicate in _WIDER:
        for p, _, q in facts.match(None, predicate):
            flow.setdefault(p, set()).add(q)
            if predicate != _WIDER[0]:
                flow.setdefault(q, set()).add(p)
    for p, _, head in facts.match(None, _CHAIN):
        for member in (facts.members(head) or ([], ()))[0]:
            flow.setdefault(member, set()).add(p)
    for rule in rules:
        if rule.head is None or rule.head.kind != PROPERTY:
            continue
        result, new = rule.head.arguments[1], False
        sources = {result}
        for atom in reversed(rule.body):
            calculates = atom.kind == BUILT_IN and not builtins.is_comparison(atom.predicate)
            if calculates and atom.arguments[0] in sources:
                sources |= set(atom.arguments[1:])
                new = True
        for atom in rule.body:
            if atom.kind == PROPERTY and atom.arguments[1] in sources and is_variable(atom.arguments[1]):
                flow.setdefault(atom.predicate, set()).add(rule.head.predicate)
                if new:
                    calculated.append((rule.node, atom.predicate, rule.head.predicate))
    for node, source, target in calculated:
        reached, pending = {target}, [target]
        while pending:
            pending += (new_ones := flow.get(pending.pop(), set()) - reached)
            reached |= new_ones
        if source in reached:
            yield node
