"""Table 8 of OWL 2 RL: the values of literals, and the datatypes that contain them.

Beyond the table, the datatypes of XML Schema for times and durations, `owl:real`, `owl:rational`, `rdf:HTML`
and `rdf:JSON` are supported.

A value is a hashable key. Equal keys are the same value (dt-eq), different keys different values (dt-diff).
Floats are compared by their IEEE 754 representation, as OWL 2 requires: `0.0` and `-0.0` are two values.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Collection
from fractions import Fraction
from functools import lru_cache
from typing import Any, Final

from semmap.nodes.kb_node.reasoner.canonical_forms import is_decimal, spell
from semmap.nodes.kb_node.reasoner.explanations import Term
from semmap.nodes.kb_node.reasoner.lexical_forms import (
    ERRORS,
    MONTHS_AND_DAYS,
    READERS,
    YEARS,
    Value,
    read_integer,
)
from semmap.nodes.kb_node.reasoner.terms import PREFIXES, iri, is_literal, literal

_XSD, _RDF, _OWL = PREFIXES["xsd"], PREFIXES["rdf"], PREFIXES["owl"]
LITERAL: Final = iri("rdfs:Literal")

_INTEGERS: Final[dict[str, tuple[int | None, int | None]]] = {
    "integer": (None, None),
    "nonNegativeInteger": (0, None),
    "positiveInteger": (1, None),
    "nonPositiveInteger": (None, 0),
    "negativeInteger": (None, -1),
    "long": (-(2**63), 2**63 - 1),
    "int": (-(2**31), 2**31 - 1),
    "short": (-(2**15), 2**15 - 1),
    "byte": (-(2**7), 2**7 - 1),
    "unsignedLong": (0, 2**64 - 1),
    "unsignedInt": (0, 2**32 - 1),
    "unsignedShort": (0, 2**16 - 1),
    "unsignedByte": (0, 2**8 - 1),
}
"""Minimum and maximum of the integer types."""

_NAME_START = r":A-Z_a-z\u00C0-\u00D6\u00D8-\u00F6\u00F8-\u02FF\u0370-\u037D\u037F-\u1FFF\u200C-\u200D" + (
    r"\u2070-\u218F\u2C00-\u2FEF\u3001-\uD7FF\uF900-\uFDCF\uFDF0-\uFFFD\U00010000-\U000EFFFF"
)
_NAME_CHAR = _NAME_START + r"\-.0-9\u00B7\u0300-\u036F\u203F-\u2040"
_STRINGS: Final = {
    "string": re.compile(r"[\s\S]*"),
    "normalizedString": re.compile(r"[^\t\n\r]*"),
    "token": re.compile(r"(?:[^\t\n\r ]+(?: [^\t\n\r ]+)*)?"),
    "language": re.compile(r"[A-Za-z]{1,8}(?:-[A-Za-z0-9]{1,8})*"),
    "NMTOKEN": re.compile(f"[{_NAME_CHAR}]+"),
    "Name": re.compile(f"[{_NAME_START}][{_NAME_CHAR}]*"),
    "NCName": re.compile(f"[{_NAME_START.replace(':', '', 1)}][{_NAME_CHAR.replace(':', '', 1)}]*"),
}
"""The values of the string types."""
_WIDER: Final = {
    "normalizedString": ("string",),
    "token": ("string", "normalizedString"),
    **dict.fromkeys(("language", "NMTOKEN", "Name"), ("string", "normalizedString", "token")),
    "NCName": ("string", "normalizedString", "token", "NMTOKEN", "Name"),
}
"""The string types that contain all values of another."""


def is_datatype(term: Term) -> bool:
    """Return whether a term names a supported datatype."""
    return term in _KNOWN


@lru_cache(maxsize=4096)
def value(term: Term) -> Value | None:
    """Return the value of a literal; None if it is ill-typed or if its datatype is not supported.

    `is_ill_typed` distinguishes the two cases.
    """
    text, datatype, language = literal(term)
    if language:
        return ("text", (text, language.lower()))
    if not is_datatype(f"<{datatype}>"):
        return None
    name = datatype.removeprefix(_XSD)
    try:
        if name in _INTEGERS:
            number = read_integer(text)
            return ("decimal", number) if number is not None and _in_range(number, name) else None
        if name in _STRINGS:
            collapsed = text if name in ("string", "normalizedString") else " ".join(text.split())
            return ("text", (collapsed, "")) if _STRINGS[name].fullmatch(collapsed) else None
        read = READERS.get(name)
        return read(text) if read else None
    except ERRORS:
        return None


def canonical(term: Term) -> Term:
    """Return the canonical literal of a value, which is the same for all its spellings.

    Integers and decimals become the shortest `xsd:integer` or `xsd:decimal`. Texts are plain or have their
    language in lower case. Floats have the fewest digits that identify them. Other terms, and literals
    without a known value, are returned unchanged.
    """
    found = value(term) if is_literal(term) else None
    return term if found is None else spell(found)


def is_ill_typed(term: Term) -> bool:
    """Return whether a literal is outside the lexical space of its datatype."""
    return value(term) is None and is_datatype(f"<{literal(term).datatype}>")


def contains(datatype: Term, term: Term) -> bool:
    """Return whether the value of a literal is in the value space of a datatype."""
    found = value(term)
    if found is None:
        return False
    if datatype == LITERAL:
        return True
    kind: str
    key: Any
    kind, key = found
    name = datatype[1:-1].removeprefix(_XSD)
    if kind == "decimal":
        if name in _INTEGERS:
            return isinstance(key, Fraction) and _in_range(key, name)
        return name in _REALS or (name == "decimal" and is_decimal(key))
    if kind == "text":
        text, language = key
        if language:
            return datatype in (iri("rdf:langString"), iri("rdf:PlainLiteral"))
        return datatype == iri("rdf:PlainLiteral") or (
            name in _STRINGS and _STRINGS[name].fullmatch(text) is not None
        )
    if kind == "dateTime":
        return name == "dateTime" or (name == "dateTimeStamp" and key[0] == "zoned")
    if kind == "duration":
        months, seconds = key
        zero = {"dayTimeDuration": months, "yearMonthDuration": seconds, "duration": 0}.get(name)
        return zero == 0
    return kind == name


def order_key(term: Term) -> tuple[str, Any] | None:
    """Return what orders the value of a literal among others of the same kind; None without an order.

    Numbers of all datatypes are one kind. Points in time with and without a time zone are two.
    """
    found = value(term)
    if found is None:
        return None
    kind: str
    key: Any
    kind, key = found
    if kind == "decimal":
        return ("number", key)
    if kind in ("float", "double"):
        (number,) = struct.unpack("<f" if kind == "float" else "<d", key)
        return ("number", number)
    if kind == "duration":
        months, seconds = key
        if months and seconds:
            return None
        return ("months", months) if months else ("seconds", seconds)
    if kind in ("dateTime", "time"):
        return (f"{kind} {key[0]}", key[1:])
    if kind == "date" or kind in YEARS or kind in MONTHS_AND_DAYS:
        return (f"{kind} {key[1]}", key[0])
    return None


def length(term: Term) -> int | None:
    """Return the length of a text in characters, or of binary data in octets; None for other values."""
    found = value(term)
    if found is None or found[0] not in ("text", "anyURI", "hexBinary", "base64Binary"):
        return None
    key: Any = found[1]
    return len(key[0] if found[0] == "text" else key)


def distinguishes_strings(datatype: Term) -> bool:
    """Return whether a datatype contains only some plain texts, as `xsd:token` does."""
    name = datatype[1:-1].removeprefix(_XSD)
    return name in _STRINGS and name != "string"


def known() -> frozenset[Term]:
    """Return the supported datatypes."""
    return _KNOWN


def includes(wide: Term, narrow: Term) -> bool:
    """Return whether all values of a datatype are in another; False if unknown."""
    if wide in (narrow, LITERAL):
        return True
    one, other = (term[1:-1].removeprefix(_XSD) for term in (wide, narrow))
    if one in _REALS:
        return other == "decimal" or other in _INTEGERS or other in _REALS
    if one == "decimal":
        return other in _INTEGERS
    if one in _INTEGERS and other in _INTEGERS:
        (low, high), (lowest, highest) = _INTEGERS[one], _INTEGERS[other]
        return _is_within(lowest, highest, low, high)
    if one == _RDF + "PlainLiteral":
        return other in _STRINGS or narrow == iri("rdf:langString")
    if one == "duration":
        return other in ("dayTimeDuration", "yearMonthDuration")
    return one in _WIDER.get(other, ()) or (one, other) == ("dateTime", "dateTimeStamp")


def includes_common(wide: Term, narrow: Collection[Term]) -> bool:
    """Return whether all common values of some datatypes are in another."""
    if any(includes(wide, datatype) for datatype in narrow):
        return True
    names = [datatype[1:-1].removeprefix(_XSD) for datatype in (wide, *narrow)]
    bounds = [_INTEGERS[name] for name in names[1:] if name in _INTEGERS]
    if names[0] not in _INTEGERS or not bounds:
        return False
    low, high = _INTEGERS[names[0]]
    lowest = max((least for least, _ in bounds if least is not None), default=None)
    highest = min((most for _, most in bounds if most is not None), default=None)
    return _is_within(lowest, highest, low, high)


def _is_within(lowest: int | None, highest: int | None, low: int | None, high: int | None) -> bool:
    """Return whether the range `lowest` to `highest` is within `low` to `high`. None means unbounded."""
    return (low is None or (lowest is not None and lowest >= low)) and (
        high is None or (highest is not None and highest <= high)
    )


def excludes(datatype: Term, term: Term) -> bool:
    """Return whether a literal is known not to be in a datatype. Literals of unknown datatypes may be."""
    return (value(term) is not None or is_ill_typed(term)) and not contains(datatype, term)


def datatypes(term: Term) -> list[Term]:
    """Return all supported datatypes that contain the value of a literal (dt-type2)."""
    return [datatype for datatype in sorted(_KNOWN) if contains(datatype, term)] if is_literal(term) else []


def _in_range(number: Fraction, name: str) -> bool:
    low, high = _INTEGERS[name]
    if number.denominator != 1:
        return False
    return (low is None or number >= low) and (high is None or number <= high)


_REALS: Final = (_OWL + "real", _OWL + "rational")
_KNOWN: Final = frozenset(
    {f"<{_XSD}{name}>" for name in (*_INTEGERS, *_STRINGS)}
    | {f"<{name if ':' in name else _XSD + name}>" for name in READERS}
    | {iri("rdf:langString"), LITERAL}
)
