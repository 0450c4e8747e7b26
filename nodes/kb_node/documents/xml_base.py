"""Resolves relative `xml:base` attributes, which Oxigraph rejects."""

from __future__ import annotations

import re
from typing import Final
from urllib.parse import urljoin
from xml.parsers import expat
from xml.sax.saxutils import quoteattr

_RELATIVE: Final = re.compile(rb"""\bxml:base\s*=\s*["'](?![A-Za-z][A-Za-z0-9+.-]*:)""")
_START_TAG: Final = re.compile(rb"""<[^\s/>]+(?:\s+[^\s=>]+\s*=\s*(?:"[^"]*"|'[^']*'))*""")
_BASE: Final = re.compile(rb"""(\sxml:base\s*=\s*)("[^"]*"|'[^']*')""")


def resolve_bases(content: bytes, document_iri: str) -> bytes:
    """Return well-formed XML in UTF-8 in which each `xml:base` is absolute.

    A base is relative to that of the enclosing element, and the outermost to the IRI of the document.
    """
    if not _RELATIVE.search(content):
        return content
    parser, bases = expat.ParserCreate(), [document_iri]
    parts: list[bytes] = []
    done = 0

    def begin(_name: str, attributes: dict[str, str]) -> None:
        nonlocal done
        base = attributes.get("xml:base")
        bases.append(bases[-1] if base is None else urljoin(bases[-1], base))
        at = parser.CurrentByteIndex
        if base is None or at < done or (tag := _START_TAG.match(content, at)) is None:
            return  # an element of an entity is not at this place
        absolute = quoteattr(bases[-1]).encode()
        parts.extend((content[done:at], _BASE.sub(lambda found: found[1] + absolute, tag[0])))
        done = tag.end()

    parser.StartElementHandler = begin
    parser.EndElementHandler = lambda _name: bases.pop()
    parser.Parse(content, True)
    return b"".join((*parts, content[done:]))
