"""Reads the lexical forms of literals: the lexical mappings of XML Schema, OWL and RDF.

A value is a hashable key, and equal keys are the same value. The functions return None, or raise one of
`ERRORS`, for a text outside the lexical space. Strings and ranges of integers are in `datatypes.py`.
"""

from __future__ import annotations

import base64
import binascii
import json
import re
import struct
from collections.abc import Callable, Hashable
from datetime import UTC, date, datetime, time, timedelta, timezone
from decimal import Decimal
from fractions import Fraction
from math import inf
from typing import Final
from xml.parsers import expat

from semmap.nodes.kb_node.reasoner.terms import PREFIXES

Value = tuple[str, Hashable]
"""The name of a primitive datatype, and the key of a value in it."""
ERRORS: Final = (ValueError, OverflowError, RecursionError, binascii.Error, expat.ExpatError)

_RDF, _OWL = PREFIXES["rdf"], PREFIXES["owl"]
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
YEARS: Final = {
    "gYear": re.compile(rf"{_YEAR}{_ZONE}", re.ASCII),
    "gYearMonth": re.compile(rf"{_YEAR}-(0[1-9]|1[0-2]){_ZONE}", re.ASCII),
}
MONTHS_AND_DAYS: Final = {
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


def read_integer(text: str) -> Fraction | None:
    """Return the integer that a text denotes, or None."""
    text = text.strip(" \t\n\r")
    return Fraction(int(text)) if _INTEGER.fullmatch(text) else None


def _decimal(text: str) -> Value | None:
    text = text.strip(" \t\n\r")
    return ("decimal", Fraction(Decimal(text))) if _DECIMAL.fullmatch(text) else None


def _binary_float(name: str, code: str) -> Callable[[str], Value | None]:
    def read(text: str) -> Value | None:
        text = text.strip(" \t\n\r")
        if not _FLOAT.fullmatch(text):
            return None
        return (name, pack(code, text))

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
        match = YEARS[name].fullmatch(text.strip(" \t\n\r"))
        if match is None:
            return None
        *numbers, zone = match.groups()
        return (name, (tuple(map(int, numbers)), _zone_key(zone)))

    return read


def _month_or_day(name: str) -> Callable[[str], Value | None]:
    def read(text: str) -> Value | None:
        match = MONTHS_AND_DAYS[name].fullmatch(text.strip(" \t\n\r"))
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


def pack(code: str, text: str) -> bytes:
    """Return the IEEE 754 representation of a number, of the `struct` format `code`."""
    try:
        return struct.pack(code, float(text))
    except OverflowError:  # above the largest single: rounds to infinity
        return struct.pack(code, -inf if text[0] == "-" else inf)


READERS: Final[dict[str, Callable[[str], Value | None]]] = {
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
    **{name: _year(name) for name in YEARS},
    **{name: _month_or_day(name) for name in MONTHS_AND_DAYS},
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
"""The functions that read the texts of a datatype, by its name. Names of XML Schema have no prefix."""
