"""Writes values as canonical literals: the canonical mappings of XML Schema, OWL and RDF."""

from __future__ import annotations

import base64
import struct
from collections.abc import Callable
from fractions import Fraction
from functools import lru_cache
from itertools import count
from math import inf
from typing import Any, Final

from semmap.nodes.kb_node.reasoner.explanations import Term
from semmap.nodes.kb_node.reasoner.lexical_forms import MONTHS_AND_DAYS, YEARS, Value, pack
from semmap.nodes.kb_node.reasoner.terms import PREFIXES, quoted


@lru_cache(maxsize=4096)
def spell(found: Value) -> Term:
    """Return the canonical literal of a value."""
    kind: str
    key: Any
    kind, key = found
    if kind == "text":
        return quoted(key[0], language=key[1])
    if kind == "decimal" and key.denominator == 1:
        return quoted(str(key.numerator), datatype=PREFIXES["xsd"] + "integer")
    if kind == "decimal" and not is_decimal(key):
        return quoted(f"{key.numerator}/{key.denominator}", datatype=PREFIXES["owl"] + "rational")
    write = _WRITERS.get(kind)
    return quoted(write(key) if write else key, datatype=kind if ":" in kind else PREFIXES["xsd"] + kind)


def is_decimal(number: Fraction) -> bool:
    """Return whether a number has finitely many decimal places."""
    rest = number.denominator
    for factor in (2, 5):
        while rest % factor == 0:
            rest //= factor
    return rest == 1


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
        return repr(float(next(text for text in texts if pack(code, text) == bits)))

    return write


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


_WRITERS: Final[dict[str, Callable[[Any], str]]] = {
    "decimal": _write_decimal,
    "float": _write_float("<f"),
    "double": _write_float("<d"),
    "boolean": lambda truth: "true" if truth else "false",
    "hexBinary": lambda octets: octets.hex().upper(),
    "base64Binary": lambda octets: base64.b64encode(octets).decode(),
    "dateTime": _write_date_time,
    **dict.fromkeys(("date", *YEARS), lambda key: _write_days(key[0]) + key[1]),
    "time": lambda key: _write_time(*key),
    "duration": lambda key: _write_duration(*key),
    **dict.fromkeys(MONTHS_AND_DAYS, "".join),
}
"""Functions that write values. Values of other types are their own spelling."""
