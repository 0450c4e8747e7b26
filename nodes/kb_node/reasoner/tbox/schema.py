"""The compiled TBox: classes as bits, properties as roles, and their axioms.

A *role* is a property or its inverse: for an edge x-y, `(q, False)` is x q y and `(q, True)` is y q x. An
edge of one property implies a set of roles (super-properties, inverses and symmetry). So implied edges are
not stored. A *mask* is a set of classes as the bits of an integer.

It is compiled from the schema's closure, which contains all conclusions of the scm-* rules.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from itertools import combinations

from semmap.nodes.kb_node.reasoner import data_ranges, datatypes
from semmap.nodes.kb_node.reasoner.data_ranges import Definition
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.lexical_forms import Value
from semmap.nodes.kb_node.reasoner.rules import swrl
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.nodes.kb_node.reasoner.rules.rule_table import NUMBERS
from semmap.nodes.kb_node.reasoner.rules.swrl import Atom, SwrlRule
from semmap.nodes.kb_node.reasoner.tbox.axioms import ANY, DIFFERENT, Axioms, Chain, Group, Key, Limit, Role
from semmap.nodes.kb_node.reasoner.tbox.transitive import compile_transitive
from semmap.nodes.kb_node.reasoner.terms import DIFFERENT_FROM, NOTHING, SAME_AS, THING, TYPE, iri, is_literal

_MEMBERSHIP = " by rule"
"""The end of the names of auxiliary properties for the membership in a class."""


class Schema:
    """A compiled TBox. Classes and properties without axioms may be added later."""

    def __init__(self, closure: Facts, rules: Sequence[SwrlRule] = ()) -> None:
        """Compile a closure, and the SWRL rules of its graph."""
        self.closure = closure
        self.classes: list[Term] = []
        self.supers: list[int] = []
        self.disjoint: list[int] = []
        self.intersections: list[tuple[int, int]] = []
        self.values: dict[int, tuple[int, Term]] = {}
        self.nominals: dict[Term, int] = {}
        self.literals: dict[Value, int] = {}
        self.negatives: dict[int, Term] = {}
        """Classes of individuals that must not have a value, with their negative assertion."""
        self.listed: dict[Term, list[Term]] = {}
        """The AllDisjoint and AllDifferent axioms that list a term."""
        self.axioms: list[Axioms] = []
        self.chains: dict[Chain, None] = {}
        self.virtual: tuple[int, ...] = ()
        """The transitive properties whose chains are followed by queries instead of being stored."""
        self.passed_on: dict[int, tuple[int, int]] = {}
        """Auxiliary classes along a transitive property: the restriction, and the class of their members."""
        self.rules = rules
        self.rules_by_class: dict[int, list[tuple[SwrlRule, int]]] = {}
        """The rules with a class in their body, and the position of the atom."""
        self.rules_by_property: dict[int, list[tuple[SwrlRule, int]]] = {}
        self.rule_classes = 0
        """The classes in the bodies of rules, as a mask."""
        self.lone_rule_classes = 0
        """Those of `rule_classes` that a rule may match with an individual that has no matching edge."""
        self.rules_by_head: dict[int, list[SwrlRule]] = {}
        """The rules whose conclusion is an edge of a property."""
        self.rule_results: set[Term] = set()
        """The individuals that the conclusions of rules mention."""
        self.memberships: dict[int, None] = {}
        """The auxiliary properties of `membership`."""
        self._class_numbers: dict[Term, int] = {}
        self._property_numbers: dict[Term, int] = {}
        self._roles: dict[int, dict[Role, tuple[Triple, ...]]] = {}
        self._groups: dict[Role, Group] = {}
        self.property(SAME_AS)
        self.property(DIFFERENT_FROM)
        self._compile_classes()
        self._compile_properties()
        self._compile_restrictions()
        self._compile_individuals()
        self._compile_rules()
        self.virtual = tuple(compile_transitive(self))

    # Numbers

    def cls(self, term: Term) -> int:
        """Return the number of a class. Adds the class if it is new."""
        number = self._class_numbers.get(term)
        if number is None:
            number = self._class_numbers[term] = len(self.classes)
            self.classes.append(term)
            self.supers.append(1 << number)
            self.disjoint.append(0)
        return number

    def property(self, term: Term) -> int:
        """Return the number of a property. Adds the property if it is new."""
        number = self._property_numbers.get(term)
        if number is None:
            number = self._property_numbers[term] = len(self.axioms)
            self.axioms.append(Axioms(term))
            self._groups.clear()
        return number

    def find_class(self, term: Term) -> int | None:
        """Return the number of a class, or None if it is unknown."""
        return self._class_numbers.get(term)

    def find_property(self, term: Term) -> int | None:
        """Return the number of a property, or None if it is unknown."""
        return self._property_numbers.get(term)

    def is_used(self, term: Term) -> bool:
        """Return whether a term is used as a class or a property."""
        return term in self._class_numbers or term in self._property_numbers

    @cached_property
    def datatypes(self) -> dict[Term, int]:
        """The supported datatypes that the schema mentions, with their class numbers."""
        return {term: n for term, n in self._class_numbers.items() if datatypes.is_datatype(term)}

    @cached_property
    def data_ranges(self) -> dict[int, Definition]:
        """The data ranges that the schema defines and mentions, by their class numbers."""
        defined = data_ranges.read_all(self.closure.match)
        return {self._class_numbers[t]: found for t, found in defined.items() if t in self._class_numbers}

    # Roles

    def roles(self, prop: int) -> dict[Role, tuple[Triple, ...]]:
        """Return the roles that an edge of a property implies, each with the schema facts that imply it."""
        found = self._roles.get(prop)
        if found is None:
            found = self._roles[prop] = {(prop, False): ()}
            pending: list[Role] = [(prop, False)]
            while pending:
                role = pending.pop(0)
                for wider, fact in self._wider(role):
                    if wider not in found:
                        found[wider] = (*found[role], fact)
                        pending.append(wider)
        return found

    def _wider(self, role: Role) -> Iterator[tuple[Role, Triple]]:
        prop, backwards = role
        term = self.axioms[prop].term
        match = self.closure.match
        for fact in match(term, iri("rdfs:subPropertyOf")):
            yield (self.property(fact[2]), backwards), fact
        for fact in match(term, iri("owl:inverseOf")):
            yield (self.property(fact[2]), not backwards), fact
        for fact in match(None, iri("owl:inverseOf"), term):
            yield (self.property(fact[0]), not backwards), fact
        for fact in match(term, TYPE, iri("owl:SymmetricProperty")):
            yield (prop, not backwards), fact

    def transitive_roles(self, prop: int) -> Iterator[Role]:
        """Yield the roles of virtual properties whose chains imply a property."""
        for p in self.virtual:
            for backwards in (False, True):
                if (prop, backwards) in self.roles(p):
                    yield p, backwards

    def group(self, role: Role) -> Group:
        """Return the edges of an individual along which a role leads."""
        found = self._groups.get(role)
        if found is None:
            prop, backwards = role
            numbers = range(len(self.axioms))
            found = self._groups[role] = Group(
                tuple(p for p in numbers if role in self.roles(p)),
                tuple(p for p in numbers if (prop, not backwards) in self.roles(p)),
            )
        return found

    # Compilation

    def _compile_classes(self) -> None:
        for c, _, d in self._facts("rdfs:subClassOf"):
            self.supers[self.cls(c)] |= 1 << self.cls(d)
        for c, _, d in self._facts("owl:disjointWith"):
            self._add_disjoint(self.cls(c), self.cls(d))
        for c, _, d in self._facts("owl:complementOf"):
            self._add_disjoint(self.cls(c), self.cls(d))
        for members in self._lists_of("owl:AllDisjointClasses", "owl:members"):
            for c, d in combinations(members, 2):
                self._add_disjoint(self.cls(c), self.cls(d))
        for c, _, head in self._facts("owl:intersectionOf"):
            if members := self._members(head):
                self.intersections.append((self._mask(members), self.cls(c)))
        nothing = self.cls(NOTHING)
        self._add_disjoint(nothing, nothing)

    def _add_disjoint(self, one: int, other: int) -> None:
        self.disjoint[one] |= 1 << other
        self.disjoint[other] |= 1 << one

    def _compile_properties(self) -> None:
        for p, _, q in list(self._facts("rdfs:subPropertyOf")):
            self.property(p), self.property(q)
        for p, _, q in list(self._facts("owl:inverseOf")):
            self.property(p), self.property(q)
        for p, _, c in self._facts("rdfs:domain"):
            self._axioms(p).domain |= 1 << self.cls(c)
        for p, _, c in self._facts("rdfs:range"):
            self._axioms(p).range |= 1 << self.cls(c)
        for p in self._typed("owl:FunctionalProperty"):
            self._axioms(p).limits.append(Limit((self.property(p), False), ANY, ANY))
        for p in self._typed("owl:InverseFunctionalProperty"):
            self._axioms(p).limits.append(Limit((self.property(p), True), ANY, ANY))
        for p in self._typed("owl:IrreflexiveProperty"):
            self._axioms(p).irreflexive = True
        for p in self._typed("owl:AsymmetricProperty"):
            self._axioms(p).exclusive.add((self.property(p), True))
        for p, _, q in self._facts("owl:propertyDisjointWith"):
            self._exclude(p, q)
        for members in self._lists_of("owl:AllDisjointProperties", "owl:members"):
            for p, q in combinations(members, 2):
                self._exclude(p, q)
        for p in self._typed("owl:TransitiveProperty"):
            self.chains[Chain(self.property(p), self.property(p), self.property(p))] = None
        for p, _, head in self._facts("owl:propertyChainAxiom"):
            self._chain(self._members(head), p)
        for c, _, head in self._facts("owl:hasKey"):
            key = Key(self.cls(c), tuple(map(self.property, self._members(head))))
            for number in key.properties:
                self.axioms[number].keys.append(key)

    def _exclude(self, p: Term, q: Term) -> None:
        self._axioms(p).exclusive.add((self.property(q), False))
        self._axioms(q).exclusive.add((self.property(p), False))

    def _chain(self, links: list[Term], result: Term) -> None:
        """Split a long chain into chains of two, with auxiliary properties for its beginnings."""
        if len(links) < 2:
            return  # OWL requires two; `profile` counts it
        first = self.property(links[0])
        for i, link in enumerate(links[1:], 2):
            end = self.property(result if i == len(links) else " ".join(links[:i]))
            self.chains[Chain(first, self.property(link), end)] = None
            first = end

    def _compile_restrictions(self) -> None:
        for r, _, p in self._facts("owl:onProperty"):
            axioms, number = self._axioms(p), self.cls(r)
            axioms.some += [(number, self._filler(c)) for c in self._objects(r, "owl:someValuesFrom")]
            axioms.only += [(number, self.cls(c)) for c in self._objects(r, "owl:allValuesFrom")]
            for value in self._objects(r, "owl:hasValue"):
                axioms.some.append((number, self.nominal(value)))
                self.values[number] = (self.property(p), value)
            fillers = [self._filler(c) for c in self._objects(r, "owl:onClass")]
            for name, classes in (("owl:maxCardinality", [ANY]), ("owl:maxQualifiedCardinality", fillers)):
                limits = set(self._objects(r, name))
                if NUMBERS[0] in limits:
                    axioms.none += [(number, filler) for filler in classes]
                if NUMBERS[1] in limits:
                    role = (self.property(p), False)
                    axioms.limits += [Limit(role, number, filler) for filler in classes]

    def _compile_individuals(self) -> None:
        for c, _, head in self._facts("owl:oneOf"):
            for member in self._members(head):
                self.supers[self.nominal(member)] |= self.supers[self.cls(c)]
        for name in ("owl:members", "owl:distinctMembers"):
            for members in self._lists_of("owl:AllDifferent", name):
                for one, other in combinations(members, 2):
                    self._add_disjoint(self.nominal(one), self.nominal(other))
        for n, _, s in self._facts("owl:sourceIndividual"):
            for p in self._objects(n, "owl:assertionProperty"):
                targets = (*self._objects(n, "owl:targetIndividual"), *self._objects(n, "owl:targetValue"))
                for o in targets:
                    forbidden = self.cls(f"{{{n} {p} {o}}}")
                    self.negatives[forbidden] = n
                    self._axioms(p).some.append((forbidden, self.nominal(o)))
                    self._add_disjoint(forbidden, self.nominal(s))

    def _compile_rules(self) -> None:
        for rule in self.rules:
            related = set[Term]().union(*(atom.variables for atom in rule.body if atom.kind == swrl.PROPERTY))
            for i, atom in enumerate(rule.body):
                if atom.kind == swrl.CLASS:
                    cls = self.cls(atom.predicate)
                    self.rules_by_class.setdefault(cls, []).append((rule, i))
                    self.rule_classes |= 1 << cls
                    if related.isdisjoint(atom.variables):
                        self.lone_rule_classes |= 1 << cls
                elif atom.kind in (swrl.PROPERTY, swrl.DIFFERENT):
                    number = self.property(atom.predicate) if atom.kind == swrl.PROPERTY else DIFFERENT
                    self.rules_by_property.setdefault(number, []).append((rule, i))
            if rule.head is not None and (conclusion := self.conclusion(rule.head)) is not None:
                self.rules_by_head.setdefault(conclusion, []).append(rule)
            if rule.head is not None:
                self.rule_results.update(term for term in rule.head.arguments if not swrl.is_variable(term))

    def conclusion(self, head: Atom) -> int | None:
        """Return the property of the edge that a rule adds; None for an equality."""
        if head.kind == swrl.CLASS:
            return self.membership(head.predicate)
        if head.kind == swrl.PROPERTY:
            return self.property(head.predicate)
        return DIFFERENT if head.kind == swrl.DIFFERENT else None

    def membership(self, cls: Term) -> int:
        """Return the auxiliary property that stores the membership in a class that edges imply.

        Its edges lead from an individual to itself. The class is its domain.
        """
        number = self.property(f"{cls}{_MEMBERSHIP}")
        self.axioms[number].domain |= 1 << self.cls(cls)
        self.memberships[number] = None
        return number

    def property_by_name(self, name: str) -> int:
        """Return the number of a property, which may be one of `membership`. Adds it if it is new."""
        cls = name.removesuffix(_MEMBERSHIP)
        return self.property(name) if cls == name else self.membership(cls)

    def nominal(self, term: Term) -> int:
        """Return the class that has one individual or value as its only member."""
        if term not in self.nominals:
            number = self.nominals[term] = self.cls(f"{{{term}}}")
            if is_literal(term) and (value := datatypes.value(term)) is not None:
                number = self.nominals[term] = self.literals.setdefault(value, number)
        return self.nominals[term]

    def _filler(self, term: Term) -> int:
        return ANY if term == THING else self.cls(term)

    def _axioms(self, term: Term) -> Axioms:
        return self.axioms[self.property(term)]

    def _mask(self, terms: Iterable[Term]) -> int:
        mask = 0
        for term in terms:
            mask |= 1 << self.cls(term)
        return mask

    def _facts(self, name: str) -> Iterable[Triple]:
        return self.closure.match(None, iri(name), None)

    def _objects(self, subject: Term, name: str) -> list[Term]:
        return [o for _, _, o in self.closure.match(subject, iri(name))]

    def _typed(self, name: str) -> list[Term]:
        return [s for s, _, _ in self.closure.match(None, TYPE, iri(name))]

    def _members(self, head: Term) -> list[Term]:
        found = self.closure.members(head)
        return found[0] if found else []

    def _lists_of(self, kind: str, predicate: str) -> Iterator[list[Term]]:
        for axiom in self._typed(kind):
            for head in self._objects(axiom, predicate):
                members = self._members(head)
                for member in members:
                    self.listed.setdefault(member, []).append(axiom)
                yield members
