"""Data ranges: datatypes, their restrictions by facets, enumerations of values, and combinations of them.

Membership has three values: True, False, and None if it is unknown, as for a value of a datatype without a
definition. Nothing is concluded from what is unknown.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property
from typing import Any, Final

from semmap.nodes.kb_node.reasoner import datatypes
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.lexical_forms import Value
from semmap.nodes.kb_node.reasoner.terms import (
    FIRST,
    NIL,
    REST,
    TYPE,
    iri,
    iris,
    is_literal,
    is_named,
    is_reserved,
    literal,
)

Match = Callable[[Term | None, Term | None, Term | None], Iterable[Triple]]
"""A lookup of triples by a pattern, in which None is a wildcard."""
Definition = tuple["DataRange", dict[Triple, None]]
"""A data range, and the triples that define it."""

DEFINITIONS: Final = iris("owl:onDatatype owl:datatypeComplementOf owl:oneOf owl:unionOf owl:intersectionOf")
"""The predicates of which each defines a data range, if their objects are data ranges or values."""
_FACETS: Final = iri("owl:withRestrictions")
_SHOWN: Final = 5


class DataRange:
    """A set of values."""

    datatypes: tuple[Term, ...] = ()
    """The datatypes in which a value of the range is written, in the order in which to try them."""
    text = ""
    """The range in words, without an article: `integer from 0 to 100`."""

    def contains(self, term: Term) -> bool | None:
        """Return whether a literal is in the range; None if that is unknown."""
        raise NotImplementedError

    def values(self) -> tuple[Term, ...]:
        """Return the literals of an enumeration, or nothing for other ranges."""
        return ()


class Datatype(DataRange):
    """A supported datatype, or one that is declared without a definition."""

    def __init__(self, term: Term) -> None:
        self.term = term
        self.datatypes = (term,)
        self.text = re.split(r"[#/]", term.strip("<>"))[-1]
        self._is_supported = datatypes.is_datatype(term)

    def contains(self, term: Term) -> bool | None:
        """Return whether the value of a literal is in the datatype."""
        if f"<{literal(term).datatype}>" == self.term and not datatypes.is_ill_typed(term):
            return True
        if not self._is_supported:
            return None
        if datatypes.contains(self.term, term):
            return True
        return False if datatypes.excludes(self.term, term) else None


class Restricted(DataRange):
    """The values of a range that have some facets, such as a minimum."""

    def __init__(self, base: DataRange, facets: Sequence[tuple[Term, Term]]) -> None:
        self._base, self._facets = base, facets
        self.datatypes = base.datatypes
        self.text = " ".join((base.text, *_facet_words(facets)))

    def contains(self, term: Term) -> bool | None:
        """Return whether a literal is in the base and has all facets."""
        found = self._base.contains(term)
        if found is False:
            return False
        return _all((found, *(_has_facet(term, facet, bound) for facet, bound in self._facets)))


class Enumeration(DataRange):
    """The listed values."""

    def __init__(self, members: Sequence[Term]) -> None:
        self._members = members
        self.datatypes = tuple(dict.fromkeys(f"<{literal(term).datatype}>" for term in members))
        names = [_quoted(term) for term in members[:_SHOWN]]
        more = f" and {len(members) - _SHOWN} more" if len(members) > _SHOWN else ""
        self.text = f"one of {', '.join(names)}{more}"

    def values(self) -> tuple[Term, ...]:
        """Return the listed values."""
        return tuple(self._members)

    @cached_property
    def _known(self) -> set[Value | None]:
        return set(map(datatypes.value, self._members))

    def contains(self, term: Term) -> bool | None:
        """Return whether a literal is one of the values."""
        if term in self._members:
            return True
        value = datatypes.value(term)
        if value is None:
            return None
        return True if value in self._known else None if None in self._known else False


class Combination(DataRange):
    """The union or the intersection of ranges."""

    def __init__(self, parts: Sequence[DataRange], *, is_union: bool) -> None:
        self._parts, self._is_union = parts, is_union
        self.datatypes = tuple(dict.fromkeys(term for part in parts for term in part.datatypes))
        self.text = (" or " if is_union else " and ").join(part.text for part in parts)

    def values(self) -> tuple[Term, ...]:
        """Return the values of all parts that are enumerations."""
        return tuple(term for part in self._parts for term in part.values())

    def contains(self, term: Term) -> bool | None:
        """Return whether a literal is in one of the ranges, or in all."""
        found = [part.contains(term) for part in self._parts]
        if self._is_union:
            return _negated(_all(map(_negated, found)))
        return _all(found)


class Complement(DataRange):
    """All values outside a range."""

    def __init__(self, part: DataRange) -> None:
        self._part = part
        self.text = f"anything but {part.text}"

    def contains(self, term: Term) -> bool | None:
        """Return whether a literal is outside the range."""
        return _negated(self._part.contains(term))


def read_all(match: Match) -> dict[Term, Definition]:
    """Return the data ranges that a graph defines, by their nodes. Names of datatypes are not included."""
    nodes = {s: None for name in DEFINITIONS for s, _, _ in match(None, name, None)}
    found = {node: read_range(node, match) for node in nodes}
    return {node: definition for node, definition in found.items() if definition is not None}


def read_range(node: Term, match: Match) -> Definition | None:
    """Return a data range with the triples that define it; None for anything else, such as a class."""
    found: dict[Triple, None] = {}
    data_range = _read(node, match, found, frozenset())
    return None if data_range is None else (data_range, found)


def read_common(nodes: Iterable[Term], match: Match) -> DataRange | None:
    """Return the values that the ranges of a data property have in common; None if none of them is a range.

    A name without a declaration is taken as a datatype without a definition.
    """
    found: list[DataRange] = []
    for node in sorted(nodes):
        definition = read_range(node, match)
        if definition is not None:
            found.append(definition[0])
        elif is_named(node) and not is_reserved(node):
            found.append(Datatype(node))
    return found[0] if len(found) == 1 else Combination(found, is_union=False) if found else None


def _read(node: Term, match: Match, used: dict[Triple, None], above: frozenset[Term]) -> DataRange | None:
    if datatypes.is_datatype(node):
        return Datatype(node)
    if node in above or is_literal(node):
        return None
    above |= {node}
    for triple in (triple for name in DEFINITIONS for triple in match(node, name, None)):
        mine: dict[Triple, None] = {triple: None}
        if (found := _defined(triple, match, mine, above)) is not None:
            used |= mine
            return found
    if not is_named(node):
        return None
    same = iri("owl:equivalentClass")
    for triple in (*match(node, same, None), *match(None, same, node)):
        other = triple[2] if triple[0] == node else triple[0]
        mine = {triple: None}
        if other != node and (found := _read(other, match, mine, above)) is not None:
            used |= mine
            return found
    for triple in match(node, TYPE, iri("rdfs:Datatype")):
        used[triple] = None
        return Datatype(node)
    return Datatype(node) if node.startswith(_XSD) else None


def _defined(
    triple: Triple, match: Match, used: dict[Triple, None], above: frozenset[Term]
) -> DataRange | None:
    """Return the data range that a defining triple describes, or None."""
    node, p, o = triple
    if p == iri("owl:onDatatype"):
        base = _read(o, match, used, above)
        return None if base is None else _restricted(node, base, match, used)
    if p == iri("owl:datatypeComplementOf"):
        part = _read(o, match, used, above)
        return None if part is None else Complement(part)
    members = _members(o, match, used)
    if not members:
        return None
    if p == iri("owl:oneOf"):
        return Enumeration(members) if all(map(is_literal, members)) else None
    parts = [_read(member, match, used, above) for member in members]
    known = [part for part in parts if part is not None]
    return Combination(known, is_union=p == iri("owl:unionOf")) if len(known) == len(parts) else None


def _restricted(node: Term, base: DataRange, match: Match, used: dict[Triple, None]) -> DataRange | None:
    """Return a range with its facets; None if one of them is not described, which would widen the range."""
    facets: list[tuple[Term, Term]] = []
    for triple in match(node, _FACETS, None):
        used[triple] = None
        for member in _members(triple[2], match, used) or (None,):
            described = [t for t in match(member, None, None) if t[1] != TYPE] if member is not None else []
            if not described or not all(is_literal(o) for _, _, o in described):
                return None
            used |= dict.fromkeys(described)
            facets += [(facet, bound) for _, facet, bound in described]
    return Restricted(base, facets) if facets else None


def _members(head: Term, match: Match, used: dict[Triple, None]) -> list[Term] | None:
    """Return the members of a list; None if it is incomplete, branching or cyclic.

    A closure also has the other spellings of a value (dt-eq, eq-rep-o), of which the first one counts.
    """
    members: list[Term] = []
    seen: set[Term] = set()
    while head != NIL:
        first, rest = list(match(head, FIRST, None)), list(match(head, REST, None))
        if not _is_one_member([o for _, _, o in first]) or len(rest) != 1 or head in seen:
            return None
        seen.add(head)
        used |= {first[0]: None, rest[0]: None}
        members.append(first[0][2])
        head = rest[0][2]
    return members


def _is_one_member(terms: Sequence[Term]) -> bool:
    """Return whether there is one term, or only spellings of one value."""
    if len(terms) == 1:
        return True
    values = {datatypes.value(term) if is_literal(term) else None for term in terms}
    return len(values) == 1 and None not in values


def _all(found: Iterable[bool | None]) -> bool | None:
    """Return False if one is False, None if one is unknown, or else True."""
    known = list(found)
    return False if False in known else None if None in known else True


def _negated(found: bool | None) -> bool | None:
    return None if found is None else not found


# Facets

_XSD: Final = "<http://www.w3.org/2001/XMLSchema#"
_ORDERS: Final[dict[Term, Callable[[Any, Any], bool]]] = {
    iri("xsd:minInclusive"): lambda value, bound: value >= bound,
    iri("xsd:maxInclusive"): lambda value, bound: value <= bound,
    iri("xsd:minExclusive"): lambda value, bound: value > bound,
    iri("xsd:maxExclusive"): lambda value, bound: value < bound,
}
_LENGTHS: Final[dict[Term, Callable[[int, int], bool]]] = {
    iri("xsd:length"): lambda length, bound: length == bound,
    iri("xsd:minLength"): lambda length, bound: length >= bound,
    iri("xsd:maxLength"): lambda length, bound: length <= bound,
}
_STRINGS: Final = frozenset(iri(name)[1:-1] for name in ("xsd:string", "rdf:langString", "rdf:PlainLiteral"))
_PATTERN: Final = iri("xsd:pattern")
_LANGUAGE: Final = iri("rdf:langRange")
_WORDS: Final = {
    iri("xsd:minInclusive"): "of at least {}",
    iri("xsd:maxInclusive"): "of at most {}",
    iri("xsd:minExclusive"): "above {}",
    iri("xsd:maxExclusive"): "below {}",
    iri("xsd:length"): "of {} characters",
    iri("xsd:minLength"): "of at least {} characters",
    iri("xsd:maxLength"): "of at most {} characters",
    _PATTERN: "of the form '{}'",
    _LANGUAGE: "in language {}",
    iri("xsd:totalDigits"): "of at most {} digits",
    iri("xsd:fractionDigits"): "of at most {} decimal places",
}
FACETS: Final = frozenset(_WORDS)
"""The predicates of facets. Those about digits are not checked; OWL 2 does not have them."""
_PAIRS: Final = {
    (iri("xsd:minInclusive"), iri("xsd:maxInclusive")): "from {} to {}",
    (iri("xsd:minInclusive"), iri("xsd:maxExclusive")): "of at least {} and below {}",
    (iri("xsd:minExclusive"), iri("xsd:maxInclusive")): "above {} and at most {}",
    (iri("xsd:minExclusive"), iri("xsd:maxExclusive")): "above {} and below {}",
    (iri("xsd:minLength"), iri("xsd:maxLength")): "of {} to {} characters",
}
"""Facets that are described together."""
_ESCAPES: Final = {"i": "[_:A-Za-z]", "c": r"[\w.:-]", "I": "[^_:A-Za-z]", "C": r"[^\w.:-]"}
_TOKEN: Final = re.compile(r"\\(.)|(\[)|(\])|([\^$])", re.DOTALL)


def _quoted(term: Term) -> str:
    """Return the text of a literal, in quotation marks if it is a string."""
    text, datatype, _ = literal(term)
    return f'"{text}"' if datatype in _STRINGS else text


def _facet_words(facets: Sequence[tuple[Term, Term]]) -> Iterator[str]:
    bounds = {facet: literal(value).text for facet, value in facets}
    if len(bounds) == len(facets):
        for pair, words in _PAIRS.items():
            if bounds.keys() >= set(pair):
                yield words.format(*(bounds.pop(facet) for facet in pair))
        facets = [(facet, value) for facet, value in facets if facet in bounds]
    for facet, value in facets:
        yield _WORDS.get(facet, "with a facet {}").format(literal(value).text)


def _has_facet(term: Term, facet: Term, bound: Term) -> bool | None:
    """Return whether a literal has a facet; None if it is unknown."""
    if facet in _ORDERS:
        one, other = datatypes.order_key(term), datatypes.order_key(bound)
        if one is None or other is None or one[0] != other[0]:
            return None
        return _ORDERS[facet](one[1], other[1])
    if datatypes.value(term) is None:
        return None
    text, _, language = literal(term)
    if facet in _LENGTHS:
        limit = datatypes.value(bound)
        length = datatypes.length(term)
        return None if limit is None or length is None else _LENGTHS[facet](length, limit[1])  # type: ignore[arg-type]
    if facet == _PATTERN:
        try:
            return re.fullmatch(_translated(literal(bound).text), text) is not None
        except re.error:
            return None  # syntax of XML Schema that Python lacks
    if facet == _LANGUAGE:
        wanted = literal(bound).text.lower()
        mine = language.lower()
        return bool(mine) and (wanted == "*" or mine == wanted or mine.startswith(f"{wanted}-"))
    return None


def _translated(pattern: str) -> str:
    r"""Return a regular expression of XML Schema for Python. In it, `^` and `$` are ordinary characters."""
    depth = 0

    def replace(match: re.Match[str]) -> str:
        nonlocal depth
        escaped, opening, closing, anchor = match.groups()
        if escaped is not None:
            if escaped in "pP" or (escaped in _ESCAPES and depth):
                raise re.error("unsupported escape")
            return _ESCAPES.get(escaped, match[0])
        if opening:
            if depth:
                raise re.error("subtraction of character classes")
            depth += 1
        elif closing:
            depth = max(0, depth - 1)
        elif not depth:
            return f"\\{anchor}"
        return match[0]

    return _TOKEN.sub(replace, pattern)
