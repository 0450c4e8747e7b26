"""Values of properties: literals as written by people and in JSON, typed by the range."""

from __future__ import annotations

import math
import re

from semmap.nodes.kb_node.reasoner import datatypes
from semmap.nodes.kb_node.reasoner.data_ranges import DataRange, Datatype
from semmap.nodes.kb_node.reasoner.explain.words import article
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
_XSD = f"<{v.XSD}"
_DECIMAL = v.iri(f"{v.XSD}decimal")
_INTEGER = v.iri(f"{v.XSD}integer")
_TEXTS = frozenset((v.RDF_LANG_STRING, v.iri(f"{v.RDF}PlainLiteral"), datatypes.LITERAL))
"""Datatypes in which a text may have a language."""
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
    v.RDF_LANG_STRING: "a text with its language, such as Tasse@de",
    v.XSD_BOOLEAN: "true or false",
    **dict.fromkeys(_FLOATS, "a number"),
    _DECIMAL: "a decimal number",
    _INTEGER: "a whole number",
}


def literal(name: str, data_range: DataRange | None, text: str) -> Term:
    """Return the literal that `text` denotes for property `name` with this range.

    `text` is a literal in N-Triples syntax, or its lexical form. Where the range allows it, a text may end
    with @ and a language. The datatype is the first one of the range in which the text is a value of the
    range. Without a range, true and false are booleans, and numbers are numbers. Raises BadRequest.
    """
    if _LITERAL.fullmatch(text):
        if datatypes.is_ill_typed(text) or (data_range and data_range.contains(text) is False):
            raise _range_error(name, text, data_range)
        return text
    if data_range is None:
        return _guessed(text)
    if v.WKT_LITERAL in data_range.datatypes:
        return v.literal(polygons.wkt(polygons.read_wkt(text)), v.WKT_LITERAL)
    written = (_written(name, datatype, text) for datatype in data_range.datatypes)
    for term in written if data_range.datatypes else (_guessed(text),):
        if not datatypes.is_ill_typed(term) and data_range.contains(term) is not False:
            return term
    raise _range_error(name, text, data_range)


def retype(data_range: DataRange, term: Term) -> Term:
    """Return a literal outside a range with a datatype of the range, if its text is a value of that.

    Other literals are returned as they are.
    """
    if data_range.contains(term) is not False or v.language_of(term) is not None:
        return term
    for datatype in data_range.datatypes:
        other = v.literal(v.lexical(term), None if datatype == v.XSD_STRING else datatype)
        if datatype not in _TEXTS and not datatypes.is_ill_typed(other) and data_range.contains(other):
            return other
    return term


def is_same_value(one: Term, other: Term) -> bool:
    """Return whether two terms denote the same value, or are the same individual."""
    if one == other:
        return True
    value = datatypes.value(one) if one.startswith('"') else None
    return value is not None and other.startswith('"') and value == datatypes.value(other)


def to_json_value(term: Term) -> Value:
    """Return a term as JSON: a boolean, a number, a text (with @ and language) or a name."""
    if not term.startswith('"'):
        return v.entity_name(term)
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


def _written(name: str, datatype: Term, text: str) -> Term:
    """Return the literal of a datatype that people write as `text`. Raises BadRequest if it is too large."""
    if datatype in _TEXTS:
        return _text(text)
    if datatype == v.XSD_STRING:
        return v.literal(text)
    written = text.strip()
    if datatype == v.XSD_BOOLEAN:
        written = _BOOLEANS.get(written.casefold(), written)
    elif datatype in _FLOATS:
        written = _float(name, written, datatype)
    return v.literal(written, datatype)


def _range_error(name: str, text: str, data_range: DataRange | None) -> errors.BadRequest:
    if data_range is None:
        kind = Datatype(v.datatype_of(text)).text
        return errors.BadRequest(f"{name}: {text} is not a literal of xsd:{kind}")
    is_literal = _LITERAL.fullmatch(text)
    takes = article(data_range.text)
    if isinstance(data_range, Datatype):
        kind = f"xsd:{data_range.text}" if data_range.term.startswith(_XSD) else data_range.text
        takes = f"a literal of {kind}" if is_literal else _SAID.get(data_range.term) or kind
    elif not is_literal and len(data_range.datatypes) == 1:  # "a number from 0 to 1" for a float
        takes = _in_words(data_range.datatypes[0], data_range.text) or takes
    given = text if is_literal else f"'{text}'"
    return errors.BadRequest(f"{name} takes {takes}, not {given}")


def _in_words(datatype: Term, text: str) -> str:
    """Return the text of a restricted datatype with its name in words, or "" if it does not begin with it."""
    said, name = _SAID.get(datatype), Datatype(datatype).text
    return f"{said}{text.removeprefix(name)}" if said and text.startswith(f"{name} ") else ""


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
