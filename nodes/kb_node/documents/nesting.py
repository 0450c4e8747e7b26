"""Limits the nesting of a document before a native parser reads it.

The parsers of the OWL syntaxes and of JSON-LD are recursive: a document that is nested some thousand levels
deep ends the process by a stack overflow, which no handler catches. Oxigraph reads nested Turtle without
recursion.
"""

from __future__ import annotations

import re
from typing import Final
from xml.parsers import expat

LIMIT: Final = 200
"""Levels of brackets, or of XML elements."""

_ATOMS: Final = {
    "functional": re.compile(rb'"(?:[^"\\]|\\.)*"|<[^<>\s]*>|#[^\n]*', re.DOTALL),
    "manchester": re.compile(rb'"(?:[^"\\]|\\.)*"|<[^<>\s]*>|#[^\n]*', re.DOTALL),
    "jsonld": re.compile(rb'"(?:[^"\\]|\\.)*"', re.DOTALL),
}
"""Texts, IRIs and comments, in which brackets have no meaning."""
_NO_BRACKETS: Final = re.compile(rb"[^()\[\]{}\n]+")
_OPENING: Final = b"([{"


def require_shallow(content: bytes, syntax: str) -> None:
    """Raise ValueError for a document in such a syntax that is nested deeper than `LIMIT` levels."""
    if syntax == "owlxml":
        _require_shallow_xml(content)
    elif (atoms := _ATOMS.get(syntax)) is not None and sum(map(content.count, (b"(", b"[", b"{"))) > LIMIT:
        _require_shallow_brackets(atoms.sub(lambda found: b"\n" * found[0].count(b"\n"), content))


def _require_shallow_brackets(content: bytes) -> None:
    depth, line = 0, 1
    for character in _NO_BRACKETS.sub(b"", content):
        if character == 0x0A:
            line += 1
        elif character in _OPENING:
            depth += 1
            if depth > LIMIT:
                raise _TooDeep(line)
        elif depth:
            depth -= 1


def _require_shallow_xml(content: bytes) -> None:
    parser, depth = expat.ParserCreate(), 0

    def begin(_name: str, _attributes: object) -> None:
        nonlocal depth
        depth += 1
        if depth > LIMIT:
            raise _TooDeep(parser.CurrentLineNumber)

    def end(_name: str) -> None:
        nonlocal depth
        depth -= 1

    parser.StartElementHandler, parser.EndElementHandler = begin, end
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        raise ValueError(str(error)) from None


class _TooDeep(ValueError):
    """The document is nested too deeply, from this line on."""

    def __init__(self, line: int) -> None:
        super().__init__(f"nested deeper than {LIMIT} levels (line {line})")
