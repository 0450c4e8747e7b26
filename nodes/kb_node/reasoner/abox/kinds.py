"""Kinds: the sets of classes of individuals. Each is computed once, however many individuals share it."""

from __future__ import annotations

import re
from array import array
from collections.abc import Iterable, Iterator

from semmap.nodes.kb_node.reasoner import datatypes
from semmap.nodes.kb_node.reasoner.explanations import Term
from semmap.nodes.kb_node.reasoner.tbox.schema import Schema
from semmap.nodes.kb_node.reasoner.terms import iri

_FLOATING = (iri("xsd:float"), iri("xsd:double"))
_NUMBER = re.compile(
    r'"-?[0-9]+(?:\.[0-9]+)?(?:e-?[0-9]+)?"\^\^(?:'
    + "|".join(f"({re.escape(datatype)})" for datatype in _FLOATING)
    + ")"
)
"""The usual spelling of a floating-point number. The group is its datatype."""
_TEXT = re.compile(r'"[ !#-\[\]-~]*"')
"""The simplest texts. Others are parsed."""


class Kind:
    """The classes of an individual or literal: the given classes, and a mask of all that follow.

    Kinds are interned: individuals of one kind share the object. `nodes` lists the individuals of the kind.
    """

    __slots__ = ("base", "clash", "excluded", "given", "mask", "names", "nodes", "value_terms", "values")

    base: Kind
    """The kind of the given classes alone; the same object if nothing was added."""

    def __init__(self, given: frozenset[int], mask: int, excluded: int | None) -> None:
        self.given = given
        self.mask = mask
        self.excluded = excluded
        """For a literal: the datatypes that do not contain its value. None for an individual."""
        self.clash: tuple[int, int] | None = None
        """Two disjoint classes. For a literal both may be the same datatype."""
        self.values: tuple[tuple[int, Term], ...] = ()
        """The properties and values implied by the classes (cls-hv1)."""
        self.value_terms: frozenset[Term] = frozenset()
        """The values in `values`."""
        self.names: frozenset[Term] = frozenset()
        """The named classes."""
        self.nodes = array("i")


class Kinds:
    """All kinds that occurred, and the operations on them."""

    def __init__(self, schema: Schema) -> None:
        self._schema = schema
        self._kinds: dict[tuple[frozenset[int], int, int | None], Kind] = {}
        self._closed: dict[int, int] = {}
        self._given_more: dict[tuple[Kind, int], Kind] = {}
        self._nominals = frozenset(schema.nominals.values())
        self.nothing = self.of(frozenset())
        self.ill_typed = Kind(frozenset(), 0, 0)
        self.ill_typed.base, self.ill_typed.clash = self.ill_typed, (ILL_TYPED, ILL_TYPED)

        self._ranges = {number: data_range for number, (data_range, _) in schema.data_ranges.items()}
        is_by_value = bool(schema.literals or self._ranges)
        self._numbers = [] if is_by_value else [self._literal(f'"1"^^{name}') for name in _FLOATING]
        """The kinds of all numbers, unless the schema distinguishes single literals."""
        has_one_text_kind = not is_by_value and not any(
            map(datatypes.distinguishes_strings, schema.datatypes)
        )
        self._text = self._literal('""') if has_one_text_kind else None
        """The kind of all plain texts, unless the schema distinguishes them."""

    def __iter__(self) -> Iterator[Kind]:
        return iter(self._kinds.values())

    def of(self, given: frozenset[int]) -> Kind:
        """Return the kind of an individual from its given classes only."""
        return self._kind(given, self.close(mask_of(given)), None)

    def individual(self, term: Term) -> Kind:
        """Return the kind of a new individual: empty, or its nominal if the schema mentions it."""
        nominal = self._schema.nominals.get(term)
        return self.nothing if nominal is None else self.of(frozenset((nominal,)))

    def literal(self, term: Term) -> Kind:
        """Return the kind of a literal: the datatypes that contain its value, and its nominal."""
        if term[-1] == '"' and self._text is not None and _TEXT.fullmatch(term):
            return self._text
        number = _NUMBER.fullmatch(term) if self._numbers else None
        return self._literal(term) if number is None else self._numbers[(number.lastindex or 0) - 1]

    def _literal(self, term: Term) -> Kind:
        if datatypes.is_ill_typed(term):
            return self.ill_typed
        value, known = datatypes.value(term), self._schema.datatypes.items()
        given = {number for name, number in known if datatypes.contains(name, term)}
        excluded = {number for name, number in known if datatypes.excludes(name, term)}
        for number, data_range in self._ranges.items():
            if (is_in := data_range.contains(term)) is not None:
                (given if is_in else excluded).add(number)
        nominal = self._schema.literals.get(value) if value else self._schema.nominals.get(term)
        if nominal is not None:
            given.add(nominal)
        return self._kind(frozenset(given), self.close(mask_of(given)), mask_of(excluded))

    def widen(self, kind: Kind, mask: int) -> Kind:
        """Return the kind with more classes."""
        if mask | kind.mask == kind.mask or kind is self.ill_typed:
            return kind
        return self._kind(kind.given, self.close(kind.mask | mask), kind.excluded)

    def add_given(self, kind: Kind, cls: int) -> Kind:
        """Return the kind with one more given class, and all that follows."""
        found = self._given_more.get((kind, cls))
        if found is None:
            given = kind.given | {cls}
            mask = self.close(kind.mask | 1 << cls)
            found = self._given_more[kind, cls] = self._kind(given, mask, kind.excluded)
        return found

    def find_or_create(self, given: frozenset[int], mask: int, excluded: int | None) -> Kind:
        """Return the kind with these classes, creating it if necessary."""
        return self._kind(given, mask, excluded)

    def without(self, kind: Kind, cls: int) -> Kind:
        """Return the kind without one given class. The classes that followed from it are kept."""
        return self._kind(kind.given - {cls}, kind.mask, kind.excluded)

    def close(self, mask: int) -> int:
        """Return all classes that follow from a mask (cax-*, cls-int1, cls-uni, cls-oo)."""
        closed = self._closed.get(mask)
        if closed is None:
            closed = mask
            for number in bits(mask):
                closed |= self._schema.supers[number]
            for members, whole in self._schema.intersections:
                if closed & members == members:
                    closed |= self._schema.supers[whole]
            if closed != mask:
                closed = self.close(closed)
            self._closed[mask] = closed
        return closed

    def given(self, kind: Kind) -> Iterator[int]:
        """Return the asserted classes, without nominals and the datatypes of literals."""
        return iter(()) if kind.excluded is not None else (n for n in kind.given if n not in self._nominals)

    def _kind(self, given: frozenset[int], mask: int, excluded: int | None) -> Kind:
        kind = self._kinds.get((given, mask, excluded))
        if kind is None:
            kind = self._kinds[given, mask, excluded] = Kind(given, mask, excluded)
            base = self.close(mask_of(given))
            kind.base = kind if base == mask else self._kind(given, base, excluded)
            self._compute(kind)
        return kind

    def _compute(self, kind: Kind) -> None:
        schema = self._schema
        numbers = list(bits(kind.mask))
        for number in numbers:
            if clashing := schema.disjoint[number] & kind.mask:
                kind.clash = (number, next(bits(clashing)))
                break
        if wrong := kind.mask & (kind.excluded or 0):
            number = next(bits(wrong))
            kind.clash = (number, number)
        kind.values = tuple(dict.fromkeys(schema.values[n] for n in numbers if n in schema.values))
        kind.value_terms = frozenset(term for _, term in kind.values)
        kind.names = frozenset(
            schema.classes[number] for number in numbers if schema.classes[number][0] == "<"
        )


ILL_TYPED = -2
"""The pseudo class of a literal without a value."""


def bits(mask: int) -> Iterator[int]:
    """Yield the numbers of the bits that are set, lowest first."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


def mask_of(numbers: Iterable[int]) -> int:
    """Return the mask of a set of classes."""
    return sum(1 << number for number in numbers)
