"""Values of properties: literals as written by people and in JSON, typed by the range."""

from __future__ import annotations

import math
import re
from collections.abc import Set

from semmap.nodes.kb_node.reasoner import datatypes
from semmap.ontology import vocabulary as v
from semmap.schemas import errors, polygons
from semmap.schemas.changes import value_in_words
from semmap.schemas.entities import Stated as Stated
from semmap.schemas.entities import Value
from semmap.schemas.explanations import Term

_TAGGED = re.compile(r"(.*)@([a-z]{2,3}(?:-[A-Za-z0-9]{1,8})*)", re.DOTALL)
_LITERAL = re.compile(r'".*"(?:@[A-Za-z0-9-]+|\^\^<[^<>\s]+>)?', re.DOTALL)
_BOOLEANS = {
    **dict.fromkeys(("true", "yes", "on", "1"), "true"),
    **dict.fromkeys(("false", "no", "off", "0"), "false"),
}
_FLOATS = frozenset((v.XSD_FLOAT, v.iri(f"{v.XSD}double")))
_INFINITE = frozenset(("INF", "-INF", "+INF", "NaN"))
"""The values that are not finite in XML Schema."""
_LARGEST_FLOAT = 3.4028234663852886e38
_DECIMAL = v.iri(f"{v.XSD}decimal")
_INTEGER = v.iri(f"{v.XSD}integer")
_TEXTS = frozenset((v.RDF_LANG_STRING, v.iri(f"{v.RDF}PlainLiteral"), datatypes.LITERAL))
_LARGEST = 1 << 63
_OF_INTEGERS = frozenset(
    v.iri(v.XSD + name)
    for name in (
        *("integer", "long", "int", "short", "byte", "nonNegativeInteger", "positiveInteger"),
        *("nonPositiveInteger", "negativeInteger"),
        *("unsignedLong", "unsignedInt", "unsignedShort", "unsignedByte"),
    )
)
_SAID = {
    v.XSD_BOOLEAN: "true or false",
    **dict.fromkeys(_FLOATS, "a number"),
    _DECIMAL: "a decimal number",
    _INTEGER: "a whole number",
}


def literal(name: str, ranges: Set[Term], text: str) -> Term:
    """Return the literal that `text` denotes for property `name` with these ranges.

    `text` is a literal in N-Triples syntax, or its lexical form; a text may end with @ and a language.
    Without a range, true and false are booleans, and numbers are numbers. Raises BadRequest.
    """
    if _LITERAL.fullmatch(text):
        return _checked(name, ranges, text, text)
    if v.WKT_LITERAL in ranges:
        return v.literal(polygons.wkt(polygons.read_wkt(text)), v.WKT_LITERAL)
    known = sorted(r for r in ranges if datatypes.is_datatype(r) and r not in _TEXTS)
    if not known:
        return _text(text) if ranges & _TEXTS or ranges == {v.XSD_STRING} else _guessed(text)
    (datatype, *_) = known
    if datatype == v.XSD_STRING:
        return v.literal(text)
    written = text.strip()
    if datatype == v.XSD_BOOLEAN:
        written = _BOOLEANS.get(written.casefold(), written)
    elif datatype in _FLOATS:
        written = _float(name, written, datatype)
    return _checked(name, ranges, text, v.literal(written, datatype))


def is_same_value(one: Term, other: Term) -> bool:
    """Return whether two terms denote the same value, or are the same individual."""
    if one == other:
        return True
    value = datatypes.value(one) if one.startswith('"') else None
    return value is not None and other.startswith('"') and value == datatypes.value(other)


def to_json_value(term: Term) -> Value:
    """Return a term as JSON: a boolean, a number, a text (with @ and language) or a name."""
    if not term.startswith('"'):
        return v.local_name(term)
    text, datatype, language = v.lexical(term), v.datatype_of(term), v.language_of(term)
    if language is not None:
        return f"{text}@{language}"
    if datatypes.is_ill_typed(term):
        return text
    if datatype == v.XSD_BOOLEAN:
        return text.strip() in ("true", "1")
    if datatype in _OF_INTEGERS:
        return int(text) if -_LARGEST <= int(text) < _LARGEST else text
    if datatype in _FLOATS or datatype == _DECIMAL:
        number = float(text)
        return number if math.isfinite(number) else text
    return text


def to_text(term: Term) -> str:
    """Return a term as people write it."""
    return value_in_words(to_json_value(term))


def _checked(name: str, ranges: Set[Term], text: str, term: Term) -> Term:
    """Return the literal. Raises BadRequest if it is not in the range."""
    if datatypes.is_ill_typed(term):
        raise _range_error(name, text, v.datatype_of(term))
    for datatype in sorted(r for r in ranges if datatypes.is_datatype(r)):
        if datatypes.excludes(datatype, term):
            raise _range_error(name, text, datatype)
    return term


def _range_error(name: str, text: str, datatype: Term) -> errors.BadRequest:
    kind = f"xsd:{v.local_name(datatype)}"
    if _LITERAL.fullmatch(text):
        return errors.BadRequest(f"{name} takes a literal of {kind}, not {text}")
    return errors.BadRequest(f"{name} takes {_SAID.get(datatype) or kind}, not '{text}'")


def _text(text: str) -> Term:
    tagged = _TAGGED.fullmatch(text)
    return v.literal(tagged[1], lang=tagged[2]) if tagged else v.literal(text)


def _guessed(text: str) -> Term:
    if text in ("true", "false"):
        return v.literal(text, v.XSD_BOOLEAN)
    for datatype in (_INTEGER, _DECIMAL):
        term = v.literal(text.strip(), datatype)
        if text.strip() and not datatypes.is_ill_typed(term):
            return term
    return _text(text)


def _float(name: str, text: str, datatype: Term) -> str:
    """Return the lexical form of a number. Raises BadRequest if it is too large."""
    try:
        number = float(text)
    except ValueError:
        return text
    largest = _LARGEST_FLOAT if datatype == v.XSD_FLOAT else math.inf
    if (math.isinf(number) or abs(number) > largest) and text not in _INFINITE and text[-1].isdigit():
        raise errors.BadRequest(f"{name} takes a number, and {text} is too large for one")
    return repr(number) if math.isfinite(number) else text
