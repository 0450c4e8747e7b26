"""Limits the nesting of a file before a parser reads it.

Native parsers are recursive, and so are the destructors of nested data: a file that is nested some ten
thousand levels deep ends the process by a stack overflow, which no handler catches. The scan needs no
recursion, and its time is proportional to the size of the file.
"""

from __future__ import annotations

import re
from typing import Final
from xml.parsers import expat

LIMIT: Final = 200
"""Levels of brackets or XML elements, and XML entities that refer to other entities."""

_IRI: Final = rb"<[^<>\s]*+>"
_COMMENT: Final = rb"#[^\n]*+"
_TEXT: Final = rb'"[^"\\]*+(?:\\.[^"\\]*+)*+"?'
_TURTLE_TEXTS: Final = rb"|".join(
    pattern
    for quote in (b'"', b"'")
    for pattern in (
        rb"%b(?:[^%b\\]++|\\.|%b(?!%b))*+(?:%b)?" % (quote * 3, quote, quote, quote * 2, quote * 3),
        rb"%b(?:[^%b\\\r\n]++|\\.)*+%b?" % (quote, quote, quote),
    )
)
_ATOMS: Final = {
    syntax: re.compile(rb"|".join((rb"[^\"'#<>()\[\]{}\\\n]++", *patterns, rb"\\.")), re.DOTALL)
    for syntax, patterns in {
        "turtle": (_TURTLE_TEXTS, _IRI, _COMMENT),
        "functional": (_TEXT, _IRI, _COMMENT),
        "manchester": (_TEXT, _IRI, _COMMENT),
        "json": (_TEXT,),
    }.items()
}
"""Everything but brackets and line ends: words, texts, IRIs, comments and escaped characters.

A text without an end extends to the end of the line or file, so that no byte is matched twice.
"""
_BRACKETS: Final = (b"(", b"[", b"{", b"<<")
_OPENING: Final = b"([{"
_CLOSING: Final = b")]}"


class TooDeep(ValueError):
    """The file is nested too deeply, from this line on."""

    def __init__(self, line: int) -> None:
        super().__init__(f"nested deeper than {LIMIT} levels (line {line})")


class NotWellFormed(ValueError):
    """The file is not XML."""


def require_shallow(content: bytes, syntax: str) -> None:
    """Raise TooDeep if the brackets of a file are nested deeper than `LIMIT` levels.

    `syntax` is turtle (which includes N-Triples), functional, manchester or json.
    """
    if sum(map(content.count, _BRACKETS)) <= LIMIT:
        return
    if _find_line(_ATOMS[syntax].sub(b"", content), syntax) is not None:
        # the line ends within texts are needed only for the error, and take most of the time
        lines = _ATOMS[syntax].sub(lambda found: b"\n" * found[0].count(b"\n"), content)
        raise TooDeep(_find_line(lines, syntax) or 1)


def _find_line(brackets: bytes, syntax: str) -> int | None:
    """Return the line from which brackets are nested too deeply, or None."""
    if syntax == "turtle":  # triples as terms
        brackets = brackets.replace(b"<<", b"(").replace(b">>", b")")
    depth, line = 0, 1
    for character in brackets:
        if character == 0x0A:
            line += 1
        elif character in _OPENING:
            depth += 1
            if depth > LIMIT:
                return line
        elif depth and character in _CLOSING:
            depth -= 1
    return None


def require_shallow_xml(content: bytes) -> None:
    """Check XML with Expat, which limits the expansion of entities.

    Raises NotWellFormed, TooDeep if its elements or entities are nested deeper than `LIMIT` levels, and
    ValueError for external entities.
    """
    parser, depth = expat.ParserCreate(), 0
    limit_entities(parser)

    def begin(_name: str, _attributes: object) -> None:
        nonlocal depth
        depth += 1
        if depth > LIMIT:
            raise TooDeep(parser.CurrentLineNumber)

    def end(_name: str) -> None:
        nonlocal depth
        depth -= 1

    parser.StartElementHandler, parser.EndElementHandler = begin, end
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        raise NotWellFormed(str(error)) from None


def limit_entities(parser: expat.XMLParserType) -> None:
    """Let a parser raise ValueError for an external entity, and TooDeep for too many nested entities.

    Expat expands an entity within another by recursion, and limits only the size of the result.
    """
    nested = 0

    def declare(name: str, _is_parameter: bool, text: str | None, *where: str | None) -> None:
        nonlocal nested
        if text is None:
            raise ValueError(f"the external entity '{name}' ({where[1]}) is not allowed")
        nested += "&" in text
        if nested > LIMIT:
            raise TooDeep(parser.CurrentLineNumber)

    parser.EntityDeclHandler = declare
