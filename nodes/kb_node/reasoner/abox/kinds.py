"""What individuals can be: each set of classes is worked out once, however many individuals share it."""

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
"""How programs write a floating-point number; the group says of which datatype."""
_TEXT = re.compile(r'"[ !#-\[\]-~]*"')
"""The plainest texts; any other is looked at more closely."""


class Kind:
    """The classes of an individual or literal: those it was given, and with all that follow a mask.

    Kinds are interned: two individuals of one kind share the object. `nodes` lists who is of the kind.
    """

    __slots__ = ("base", "clash", "excluded", "given", "mask", "names", "nodes", "value_terms", "values")

    base: Kind
    """The kind that the given classes alone would make; itself when nothing was added."""

    def __init__(self, given: frozenset[int], mask: int, excluded: int | None) -> None:
        self.given = given
        self.mask = mask
        self.excluded = excluded
        """For a literal the datatypes that do not hold its value; None for an individual."""
        self.clash: tuple[int, int] | None = None
        """Two classes that exclude each other; for a literal the second may be the first, a datatype."""
        self.values: tuple[tuple[int, Term], ...] = ()
        """Properties and values that come with the classes (cls-hv1)."""
        self.value_terms: frozenset[Term] = frozenset()
        """These values."""
        self.names: frozenset[Term] = frozenset()
        """The named classes."""
        self.nodes = array("i")


class Kinds:
    """The kinds met so far, and how they follow from one another."""

    def __init__(self, schema: Schema) -> None:
        self._schema = schema
        self._kinds: dict[tuple[frozenset[int], int, int | None], Kind] = {}
        self._closed: dict[int, int] = {}
        self._given_more: dict[tuple[Kind, int], Kind] = {}
        self._nominals = frozenset(schema.nominals.values())
        self.nothing = self.of(frozenset())
        self.ill_typed = Kind(frozenset(), 0, 0)
        self.ill_typed.base, self.ill_typed.clash = self.ill_typed, (ILL_TYPED, ILL_TYPED)

        self._numbers = [] if schema.literals else [self._literal(f'"1"^^{name}') for name in _FLOATING]
        """The kinds of all numbers, unless the schema speaks of single ones."""
        is_text_one = not schema.literals and not any(map(datatypes.distinguishes_strings, schema.datatypes))
        self._text = self._literal('""') if is_text_one else None
        """The kind of all plain texts, unless the schema tells some from others."""

    def __iter__(self) -> Iterator[Kind]:
        return iter(self._kinds.values())

    def of(self, given: frozenset[int]) -> Kind:
        """The kind of an individual that was given some classes, before anything else is known."""
        return self._kind(given, self.close(mask_of(given)), None)

    def individual(self, term: Term) -> Kind:
        """The kind of a new individual: nothing, or its nominal when the schema speaks of it."""
        nominal = self._schema.nominals.get(term)
        return self.nothing if nominal is None else self.of(frozenset((nominal,)))

    def literal(self, term: Term) -> Kind:
        """The kind of a literal: the datatypes that hold its value, and its nominal."""
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
        nominal = self._schema.literals.get(value) if value else self._schema.nominals.get(term)
        if nominal is not None:
            given.add(nominal)
        return self._kind(frozenset(given), self.close(mask_of(given)), mask_of(excluded))

    def widen(self, kind: Kind, mask: int) -> Kind:
        """The kind with more classes."""
        if mask | kind.mask == kind.mask or kind is self.ill_typed:
            return kind
        return self._kind(kind.given, self.close(kind.mask | mask), kind.excluded)

    def add_given(self, kind: Kind, cls: int) -> Kind:
        """The kind with one given class more, and all that follows."""
        found = self._given_more.get((kind, cls))
        if found is None:
            given = kind.given | {cls}
            mask = self.close(kind.mask | 1 << cls)
            found = self._given_more[kind, cls] = self._kind(given, mask, kind.excluded)
        return found

    def find_or_create(self, given: frozenset[int], mask: int, excluded: int | None) -> Kind:
        """The kind that has these."""
        return self._kind(given, mask, excluded)

    def without(self, kind: Kind, cls: int) -> Kind:
        """The kind with one given class less and all that followed still there."""
        return self._kind(kind.given - {cls}, kind.mask, kind.excluded)

    def close(self, mask: int) -> int:
        """All classes that follow from some (cax-*, cls-int1, cls-uni, cls-oo)."""
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
        """The classes that were asserted, nominals and datatypes of literals left out."""
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
"""In the place of a class: what a literal is that has no value."""


def bits(mask: int) -> Iterator[int]:
    """The numbers of the bits that are set, lowest first."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


def mask_of(numbers: Iterable[int]) -> int:
    """A set of classes as a mask."""
    return sum(1 << number for number in numbers)
