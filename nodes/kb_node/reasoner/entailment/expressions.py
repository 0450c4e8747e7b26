"""Class expressions as values: read from RDF, negated, and written as RDF."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import count

from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.terms import FIRST, NIL, REST, THING, TYPE, iri, is_named, literal

Match = Callable[[Term | None, Term | None, Term | None], Iterable[Triple]]
"""Returns the triples that match a pattern, in which None is a wildcard."""


@dataclass(frozen=True)
class Role:
    """A property, read from its subject or, `backwards`, from its object."""

    property: Term
    backwards: bool = False

    def edge(self, x: Term, y: Term) -> Triple:
        """Return the triple that states that the role leads from x to y."""
        return (y, self.property, x) if self.backwards else (x, self.property, y)


@dataclass(frozen=True)
class Named:
    """A named class or datatype."""

    term: Term


@dataclass(frozen=True)
class Not:
    """The complement of a class."""

    part: Expression


@dataclass(frozen=True)
class And:
    """The intersection of classes."""

    parts: tuple[Expression, ...]


@dataclass(frozen=True)
class Or:
    """The union of classes."""

    parts: tuple[Expression, ...]


@dataclass(frozen=True)
class OneOf:
    """An enumeration of individuals or of literals."""

    terms: tuple[Term, ...]


@dataclass(frozen=True)
class Only:
    """The individuals whose values of a role are all in a class (allValuesFrom)."""

    role: Role
    filler: Expression


@dataclass(frozen=True)
class AtLeast:
    """The individuals with at least `number` values of a role in a class (someValuesFrom: 1)."""

    number: int
    role: Role
    filler: Expression


@dataclass(frozen=True)
class AtMost:
    """The individuals with at most `number` values of a role in a class."""

    number: int
    role: Role
    filler: Expression


@dataclass(frozen=True)
class Has:
    """The individuals with a given value of a role (hasValue)."""

    role: Role
    value: Term


@dataclass(frozen=True)
class Self:
    """The individuals that are related to themselves (hasSelf)."""

    role: Role


Expression = Named | Not | And | Or | OneOf | Only | AtLeast | AtMost | Has | Self

ANYTHING = Named(THING)


class Unreadable(Exception):
    """A node is not an OWL 2 class expression, or it restricts a datatype by facets."""


def negated(expression: Expression) -> Expression:
    """Return the complement in negation normal form."""
    match expression:
        case Not(part):
            return part
        case And(parts):
            return Or(tuple(map(negated, parts)))
        case Or(parts):
            return And(tuple(map(negated, parts)))
        case OneOf(terms) if len(terms) != 1:
            return And(tuple(Not(OneOf((term,))) for term in terms))
        case Only(role, filler):
            return AtLeast(1, role, negated(filler))
        case AtLeast(number, role, filler):
            return AtMost(number - 1, role, filler) if number > 0 else Not(ANYTHING)
        case AtMost(number, role, filler):
            return AtLeast(number + 1, role, filler)
        case _:
            return Not(expression)


class Reader:
    """Reads expressions from a graph."""

    def __init__(self, match: Match) -> None:
        self._match = match

    def expression(self, node: Term) -> Expression:
        """Return the expression of a node. Raises Unreadable."""
        if is_named(node):
            return Named(node)
        found = next(self.definitions(node), None)
        if found is None:
            raise Unreadable(node)
        return found

    def definitions(self, node: Term) -> Iterator[Expression]:
        """Yield the expressions that define a named or anonymous node. Raises Unreadable."""
        for name, build in (("owl:intersectionOf", And), ("owl:unionOf", Or)):
            for head in self._objects(node, name):
                yield build(tuple(map(self.expression, self.members(head))))
        for head in self._objects(node, "owl:oneOf"):
            yield OneOf(tuple(self.members(head)))
        for name in ("owl:complementOf", "owl:datatypeComplementOf"):
            for part in self._objects(node, name):
                yield negated(self.expression(part))
        for prop in self._objects(node, "owl:onProperty"):
            yield from self._restrictions(node, self.role(prop))

    def role(self, node: Term) -> Role:
        """Return a property or the inverse of one. Raises Unreadable."""
        if is_named(node):
            return Role(node)
        for inverse in self._objects(node, "owl:inverseOf"):
            role = self.role(inverse)
            return Role(role.property, not role.backwards)
        raise Unreadable(node)

    def members(self, head: Term) -> list[Term]:
        """Return the members of a list. Raises Unreadable for an incomplete, branching or cyclic list."""
        found: list[Term] = []
        seen: set[Term] = set()
        while head != NIL:
            first, rest = list(self._match(head, FIRST, None)), list(self._match(head, REST, None))
            if len(first) != 1 or len(rest) != 1 or head in seen:
                raise Unreadable(head)
            seen.add(head)
            found.append(first[0][2])
            head = rest[0][2]
        return found

    def _restrictions(self, node: Term, role: Role) -> Iterator[Expression]:
        for filler in self._objects(node, "owl:someValuesFrom"):
            yield AtLeast(1, role, self.expression(filler))
        for filler in self._objects(node, "owl:allValuesFrom"):
            yield Only(role, self.expression(filler))
        for value in self._objects(node, "owl:hasValue"):
            yield Has(role, value)
        if self._objects(node, "owl:hasSelf"):
            yield Self(role)
        kinds = [*self._objects(node, "owl:onClass"), *self._objects(node, "owl:onDataRange")]
        filler_of = self.expression(kinds[0]) if kinds else ANYTHING
        for name, bounds in _BOUNDS.items():
            for number in self._objects(node, name):
                yield _bounded(bounds, _number(number), role, filler_of)

    def _objects(self, node: Term, name: str) -> list[Term]:
        return [o for _, _, o in self._match(node, iri(name), None)]


_BOUNDS: dict[str, tuple[type[AtLeast] | type[AtMost], ...]] = {
    "owl:minCardinality": (AtLeast,),
    "owl:minQualifiedCardinality": (AtLeast,),
    "owl:maxCardinality": (AtMost,),
    "owl:maxQualifiedCardinality": (AtMost,),
    "owl:cardinality": (AtLeast, AtMost),
    "owl:qualifiedCardinality": (AtLeast, AtMost),
}


def _bounded(
    bounds: tuple[type[AtLeast] | type[AtMost], ...], number: int, role: Role, filler: Expression
) -> Expression:
    parts = tuple(bound(number, role, filler) for bound in bounds)
    return parts[0] if len(parts) == 1 else And(parts)


def _number(term: Term) -> int:
    try:
        return int(literal(term).text)
    except ValueError:
        raise Unreadable(term) from None


class Writer:
    """Writes expressions as RDF with fresh blank nodes."""

    def __init__(self) -> None:
        self._numbers = count()

    def fresh(self) -> Term:
        """Return a fresh blank node."""
        return f"_:supposed.{next(self._numbers)}"

    def write(self, expression: Expression, into: list[Triple]) -> Term:
        """Append the triples of an expression and return its node. Raises Unreadable for hasSelf."""
        if isinstance(expression, Named):
            return expression.term
        node = self.fresh()
        match expression:
            case Not(part):
                into.append((node, iri("owl:complementOf"), self.write(part, into)))
            case And(parts):
                into.append((node, iri("owl:intersectionOf"), self._list(parts, into)))
            case Or(parts):
                into.append((node, iri("owl:unionOf"), self._list(parts, into)))
            case OneOf(terms):
                into.append((node, iri("owl:oneOf"), self._cells(terms, into)))
            case Only(role, filler):
                self._on(node, role, into)
                into.append((node, iri("owl:allValuesFrom"), self.write(filler, into)))
            case Has(role, value):
                self._on(node, role, into)
                into.append((node, iri("owl:hasValue"), value))
            case AtLeast(1, role, filler):
                self._on(node, role, into)
                into.append((node, iri("owl:someValuesFrom"), self.write(filler, into)))
            case AtLeast(number, role, filler) | AtMost(number, role, filler):
                self._on(node, role, into)
                bound = "min" if isinstance(expression, AtLeast) else "max"
                into += [
                    (node, iri(f"owl:{bound}QualifiedCardinality"), _literal(number)),
                    (node, iri("owl:onClass"), self.write(filler, into)),
                ]
            case _:
                raise Unreadable(str(expression))
        return node

    def _on(self, node: Term, role: Role, into: list[Triple]) -> None:
        prop = role.property
        if role.backwards:
            prop = self.fresh()
            into.append((prop, iri("owl:inverseOf"), role.property))
        into += [(node, TYPE, iri("owl:Restriction")), (node, iri("owl:onProperty"), prop)]

    def _list(self, parts: Iterable[Expression], into: list[Triple]) -> Term:
        return self._cells([self.write(part, into) for part in parts], into)

    def _cells(self, members: Iterable[Term], into: list[Triple]) -> Term:
        head = NIL
        for member in reversed(list(members)):
            cell = self.fresh()
            into += [(cell, FIRST, member), (cell, REST, head)]
            head = cell
        return head


def _literal(number: int) -> Term:
    return f'"{number}"^^{iri("xsd:nonNegativeInteger")}'
