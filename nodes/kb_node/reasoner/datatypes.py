"""Table 8 of OWL 2 RL: the values of literals, and the datatypes that contain them.

Beyond the table, the datatypes of XML Schema for times and durations, `owl:real`, `owl:rational`, `rdf:HTML`
and `rdf:JSON` are supported.

A value is a hashable key. Equal keys are the same value (dt-eq), different keys different values (dt-diff).
Floats are compared by their IEEE 754 representation, as OWL 2 requires: `0.0` and `-0.0` are two values.
"""

from __future__ import annotations

import base64
import binascii
import json
import re
import struct
from collections.abc import Callable, Collection, Hashable
from datetime import UTC, date, datetime, time, timedelta, timezone
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from itertools import count
from math import inf
from typing import Any, Final
from xml.parsers import expat

from semmap.nodes.kb_node.reasoner.explanations import Term
from semmap.nodes.kb_node.reasoner.terms import PREFIXES, iri, is_literal, literal, quoted

Value = tuple[str, Hashable]
"""The name of a primitive datatype, and the key of a value in it."""

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

_FLOAT = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?|[+-]?INF|NaN", re.ASCII)
_DECIMAL = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)", re.ASCII)
_INTEGER = re.compile(r"[+-]?\d+", re.ASCII)
_BOOLEAN = {"true": True, "1": True, "false": False, "0": False}
_ZONE = r"(Z|[+-](?:0\d|1[0-3]):[0-5]\d|[+-]14:00)?"
_YEAR = r"(-?(?:[1-9]\d{3,}|0\d{3}))"
_CLOCK = r"(\d\d):(\d\d):(\d\d)(\.\d+)?"
_DATE_TIME = re.compile(rf"{_YEAR}-(\d\d)-(\d\d)T{_CLOCK}{_ZONE}", re.ASCII)
_DATE = re.compile(rf"{_YEAR}-(\d\d)-(\d\d){_ZONE}", re.ASCII)
_TIME = re.compile(rf"{_CLOCK}{_ZONE}", re.ASCII)
_YEARS: Final = {
    "gYear": re.compile(rf"{_YEAR}{_ZONE}", re.ASCII),
    "gYearMonth": re.compile(rf"{_YEAR}-(0[1-9]|1[0-2]){_ZONE}", re.ASCII),
}
_MONTHS_AND_DAYS: Final = {
    "gMonth": re.compile(rf"(--(?:0[1-9]|1[0-2])){_ZONE}", re.ASCII),
    "gMonthDay": re.compile(
        rf"(--(?:(?:0[1-9]|1[0-2])-(?:[01]\d|2[0-9])|(?:0[13-9]|1[0-2])-30|(?:0[13578]|1[02])-31)){_ZONE}",
        re.ASCII,
    ),
    "gDay": re.compile(rf"(---(?:0[1-9]|[12]\d|3[01])){_ZONE}", re.ASCII),
}
_CYCLE: Final = 400
"""Years after which the calendar is the same. Python's dates have the years 1 to 9999 only."""
_DURATION = re.compile(
    r"(-)?P(?=[\dT])(?:(\d+)Y)?(?:(\d+)M)?(?:(\d+)D)?(?:T(?=\d)(?:(\d+)H)?(?:(\d+)M)?(?:(\d+(?:\.\d+)?)S)?)?",
    re.ASCII,
)
_RATIONAL = re.compile(r"([+-]?\d+)\s*/\s*(\d+)", re.ASCII)
_BASE64 = re.compile(r"(?:[\w+/]{4})*(?:[\w+/]{2}==|[\w+/]{3}=)?", re.ASCII)
_IRI = re.compile(
    r"(?:[A-Za-z][A-Za-z0-9+.-]*:|(?![^/?#]*:))"  # a scheme, or a relative reference without a leading colon
    r"(?:[^\s<>\"{}|\\^`%#]|%[0-9A-Fa-f]{2})*(?:\#(?:[^\s<>\"{}|\\^`%#]|%[0-9A-Fa-f]{2})*)?"
)
_PLAIN = re.compile(r"([\s\S]*)@([A-Za-z]{1,8}(?:-[A-Za-z0-9]{1,8})*|)")


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
            return _integer(text, name)
        if name in _STRINGS:
            collapsed = text if name in ("string", "normalizedString") else " ".join(text.split())
            return ("text", (collapsed, "")) if _STRINGS[name].fullmatch(collapsed) else None
        read = _READERS.get(name)
        return read(text) if read else None
    except (ValueError, OverflowError, RecursionError, binascii.Error, expat.ExpatError):
        return None


def canonical(term: Term) -> Term:
    """Return the canonical literal of a value, which is the same for all its spellings.

    Integers and decimals become the shortest `xsd:integer` or `xsd:decimal`. Texts are plain or have their
    language in lower case. Floats have the fewest digits that identify them. Other terms, and literals
    without a known value, are returned unchanged.
    """
    found = value(term) if is_literal(term) else None
    return term if found is None else _spelled(found)


@lru_cache(maxsize=4096)
def _spelled(found: Value) -> Term:
    kind: str
    key: Any
    kind, key = found
    if kind == "text":
        return quoted(key[0], language=key[1])
    if kind == "decimal" and key.denominator == 1:
        return quoted(str(key.numerator), datatype=_XSD + "integer")
    if kind == "decimal" and not _is_decimal(key):
        return quoted(f"{key.numerator}/{key.denominator}", datatype=_OWL + "rational")
    write = _WRITERS.get(kind)
    return quoted(write(key) if write else key, datatype=kind if ":" in kind else _XSD + kind)


def _write_decimal(number: Fraction) -> str:
    places = next(n for n in count(1) if 10**n % number.denominator == 0)
    digits = str(abs(number.numerator) * 10**places // number.denominator).rjust(places + 1, "0")
    return f"{'-' if number < 0 else ''}{digits[:-places]}.{digits[-places:]}"


def _write_float(code: str) -> Callable[[bytes], str]:
    def write(bits: bytes) -> str:
        (number,) = struct.unpack(code, bits)
        if number != number:
            return "NaN"
        if number in (inf, -inf):
            return "INF" if number > 0 else "-INF"
        texts = (f"{number:.{digits}g}" for digits in range(1, 18))
        return repr(float(next(text for text in texts if _packed(code, text) == bits)))

    return write


def _packed(code: str, text: str) -> bytes:
    try:
        return struct.pack(code, float(text))
    except OverflowError:  # above the largest single: rounds to infinity
        return struct.pack(code, -inf if text[0] == "-" else inf)


def _write_date_time(key: tuple[str, tuple[int, ...], Fraction]) -> str:
    zone, moment, fraction = key
    decimals = _write_decimal(fraction)[1:] if fraction else ""
    clock = ":".join(f"{number:02}" for number in moment[3:])
    return f"{_write_days(moment[:3])}T{clock}{decimals}{'Z' if zone == 'zoned' else ''}"


def _write_days(numbers: tuple[int, ...]) -> str:
    """Return a year, or a year with its month and perhaps the day, as `-0044-03-15`."""
    year, *others = numbers
    return "-".join((f"{'-' if year < 0 else ''}{abs(year):04}", *(f"{number:02}" for number in others)))


def _write_time(zone: str, seconds: Fraction) -> str:
    whole = int(seconds)
    text = f"{whole // 3600:02}:{whole // 60 % 60:02}:{whole % 60:02}"
    decimals = _write_decimal(seconds - whole)[1:] if seconds != whole else ""
    return f"{text}{decimals}{'Z' if zone == 'zoned' else ''}"


def _write_duration(months: int, seconds: Fraction) -> str:
    sign = "-" if months < 0 or seconds < 0 else ""
    date_part = f"{abs(months)}M" if months else ""
    number = abs(seconds)
    shown = str(number.numerator) if number.denominator == 1 else _write_decimal(number)
    return f"{sign}P{date_part}" + (f"T{shown}S" if number or not months else "")


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
        return name in _REALS or (name == "decimal" and _is_decimal(key))
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
    if kind == "date" or kind in _YEARS or kind in _MONTHS_AND_DAYS:
        return (f"{kind} {key[1]}", key[0])
    return None


def length(term: Term) -> int | None:
    """Return the length of a text in characters, or of binary data in octets; None for other values."""
    found = value(term)
    if found is None or found[0] not in ("text", "anyURI", "hexBinary", "base64Binary"):
        return None
    key: Any = found[1]
    return len(key[0] if found[0] == "text" else key)


def _is_decimal(number: Fraction) -> bool:
    """Return whether a number has finitely many decimal places."""
    rest = number.denominator
    for factor in (2, 5):
        while rest % factor == 0:
            rest //= factor
    return rest == 1


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


def _integer(text: str, name: str) -> Value | None:
    text = text.strip(" \t\n\r")
    if not _INTEGER.fullmatch(text) or not _in_range(number := Fraction(int(text)), name):
        return None
    return ("decimal", number)


def _in_range(number: Fraction, name: str) -> bool:
    low, high = _INTEGERS[name]
    if number.denominator != 1:
        return False
    return (low is None or number >= low) and (high is None or number <= high)


def _decimal(text: str) -> Value | None:
    text = text.strip(" \t\n\r")
    return ("decimal", Fraction(Decimal(text))) if _DECIMAL.fullmatch(text) else None


def _binary_float(name: str, code: str) -> Callable[[str], Value | None]:
    def read(text: str) -> Value | None:
        text = text.strip(" \t\n\r")
        if not _FLOAT.fullmatch(text):
            return None
        return (name, _packed(code, text))

    return read


def _boolean(text: str) -> Value | None:
    found = _BOOLEAN.get(text.strip(" \t\n\r"))
    return None if found is None else ("boolean", found)


def _hex(text: str) -> Value | None:
    text = text.strip(" \t\n\r")
    return ("hexBinary", bytes.fromhex(text)) if re.fullmatch(r"(?:[0-9A-Fa-f]{2})*", text) else None


def _base64(text: str) -> Value | None:
    text = "".join(text.split())
    if "_" in text or not _BASE64.fullmatch(text):
        return None
    return ("base64Binary", base64.b64decode(text))


def _any_uri(text: str) -> Value | None:
    text = text.strip(" \t\n\r")
    return ("anyURI", text) if _IRI.fullmatch(text) else None


def _zone(text: str | None) -> timezone | None:
    if text is None:
        return None
    if text == "Z":
        return UTC
    sign = -1 if text[0] == "-" else 1
    return timezone(sign * timedelta(hours=int(text[1:3]), minutes=int(text[4:6])))


def _date_time(text: str) -> Value | None:
    match = _DATE_TIME.fullmatch(text.strip(" \t\n\r"))
    if match is None:
        return None
    year, month, day, hour, minute, second = map(int, match.groups()[:6])
    fraction = Fraction(match[7] or "0")
    if hour == 24 and (minute or second or fraction):
        return None
    zone = _zone(match[8])
    cycles, alike = _in_cycle(year)
    moment = datetime.combine(date(alike, month, day), time(hour % 24, minute, second))
    moment += timedelta(days=hour // 24) - (zone.utcoffset(None) if zone else timedelta())
    numbers = (cycles * _CYCLE + moment.year, *moment.timetuple()[1:6])
    return ("dateTime", ("zoned" if zone else "local", numbers, fraction))


def _in_cycle(year: int) -> tuple[int, int]:
    """Return a number of cycles, and the year from 2000 to 2399 with the same calendar."""
    cycles, rest = divmod(year - 2000, _CYCLE)
    return cycles, 2000 + rest


def _stamp(text: str) -> Value | None:
    found = _date_time(text)
    return found if found and found[1][0] == "zoned" else None  # type: ignore[index]


def _date(text: str) -> Value | None:
    match = _DATE.fullmatch(text.strip(" \t\n\r"))
    if match is None:
        return None
    year, month, day = map(int, match.groups()[:3])
    date(_in_cycle(year)[1], month, day)  # raises ValueError for a day that does not exist
    return ("date", ((year, month, day), _zone_key(match[4])))


def _time(text: str) -> Value | None:
    match = _TIME.fullmatch(text.strip(" \t\n\r"))
    if match is None:
        return None
    hour, minute, second = map(int, match.groups()[:3])
    fraction = Fraction(match[4] or "0")
    if hour > 24 or minute > 59 or second > 59 or (hour == 24 and (minute or second or fraction)):
        return None
    zone = _zone(match[5])
    shift = zone.utcoffset(None) if zone else timedelta()
    seconds = hour * 3600 + minute * 60 + second - int(shift.total_seconds())
    return ("time", ("zoned" if zone else "local", seconds % 86400 + fraction))


def _year(name: str) -> Callable[[str], Value | None]:
    def read(text: str) -> Value | None:
        match = _YEARS[name].fullmatch(text.strip(" \t\n\r"))
        if match is None:
            return None
        *numbers, zone = match.groups()
        return (name, (tuple(map(int, numbers)), _zone_key(zone)))

    return read


def _month_or_day(name: str) -> Callable[[str], Value | None]:
    def read(text: str) -> Value | None:
        match = _MONTHS_AND_DAYS[name].fullmatch(text.strip(" \t\n\r"))
        return (name, (match[1], _zone_key(match[2]))) if match else None

    return read


def _zone_key(text: str | None) -> str:
    """Return a time zone so that the spellings of UTC are equal; "" for none."""
    return "Z" if text in ("+00:00", "-00:00") else text or ""


def _duration(text: str) -> Value | None:
    match = _DURATION.fullmatch(text.strip(" \t\n\r"))
    if match is None:
        return None
    sign = -1 if match[1] else 1
    years, months, days, hours, minutes = (int(part or 0) for part in match.groups()[1:6])
    seconds = Fraction(match[7] or 0) + minutes * 60 + hours * 3600 + days * 86400
    return ("duration", (sign * (years * 12 + months), sign * seconds))


def _day_time_duration(text: str) -> Value | None:
    return _duration(text) if not re.search("Y|M", text.partition("T")[0]) else None


def _year_month_duration(text: str) -> Value | None:
    return _duration(text) if not re.search("D|T", text) else None


def _rational(text: str) -> Value | None:
    match = _RATIONAL.fullmatch(text.strip(" \t\n\r"))
    if match is None:
        return _decimal(text)
    return ("decimal", Fraction(int(match[1]), int(match[2]))) if int(match[2]) else None


def _json(text: str) -> Value | None:
    return (_RDF + "JSON", json.dumps(json.loads(text), sort_keys=True, separators=(",", ":")))


def _plain(text: str) -> Value | None:
    match = _PLAIN.fullmatch(text)
    return ("text", (match[1], match[2].lower())) if match else None


def _xml(text: str) -> Value | None:
    parser = expat.ParserCreate()
    parser.EntityDeclHandler = _reject_entity  # a literal must not declare a document type
    parser.Parse(f"<_>{text}</_>", True)
    return (_RDF + "XMLLiteral", text)


def _reject_entity(*_: object) -> None:
    raise ValueError("an XML literal declares entities")


_READERS: Final[dict[str, Callable[[str], Value | None]]] = {
    "decimal": _decimal,
    "float": _binary_float("float", "<f"),
    "double": _binary_float("double", "<d"),
    "boolean": _boolean,
    "hexBinary": _hex,
    "base64Binary": _base64,
    "anyURI": _any_uri,
    "dateTime": _date_time,
    "dateTimeStamp": _stamp,
    "date": _date,
    "time": _time,
    **{name: _year(name) for name in _YEARS},
    **{name: _month_or_day(name) for name in _MONTHS_AND_DAYS},
    "duration": _duration,
    "dayTimeDuration": _day_time_duration,
    "yearMonthDuration": _year_month_duration,
    _OWL + "real": _rational,
    _OWL + "rational": _rational,
    _RDF + "PlainLiteral": _plain,
    _RDF + "XMLLiteral": _xml,
    _RDF + "HTML": lambda text: (_RDF + "HTML", text),
    _RDF + "JSON": _json,
}
_WRITERS: Final[dict[str, Callable[[Any], str]]] = {
    "decimal": _write_decimal,
    "float": _write_float("<f"),
    "double": _write_float("<d"),
    "boolean": lambda truth: "true" if truth else "false",
    "hexBinary": lambda octets: octets.hex().upper(),
    "base64Binary": lambda octets: base64.b64encode(octets).decode(),
    "dateTime": _write_date_time,
    **dict.fromkeys(("date", *_YEARS), lambda key: _write_days(key[0]) + key[1]),
    "time": lambda key: _write_time(*key),
    "duration": lambda key: _write_duration(*key),
    **dict.fromkeys(_MONTHS_AND_DAYS, "".join),
}
"""Functions that write values. Values of other types are their own spelling."""
_REALS: Final = (_OWL + "real", _OWL + "rational")
_KNOWN: Final = frozenset(
    {f"<{_XSD}{name}>" for name in (*_INTEGERS, *_STRINGS)}
    | {f"<{name if ':' in name else _XSD + name}>" for name in _READERS}
    | {iri("rdf:langString"), LITERAL}
)
