"""Writes language tags as RFC 5646 recommends: `en-GB`, `zh-Hant`.

The map has them in lower case, which Oxigraph makes of them, because tags that differ in case are equal.
"""

from __future__ import annotations

import re
from typing import Final

_ANY: Final = re.compile(rb"""(@|xml:lang=["']|"@language": ")[a-z]{1,8}-""")
_TAG: Final = r"[a-z]{1,8}(?:-[a-z0-9]{1,8})+"
_TEXT: Final = re.compile(rf'("(?:[^"\\]|\\.)*")(?:@({_TAG}))?|<[^<>\s]*>', re.DOTALL)
_XML: Final = re.compile(rf'(<[^<>]*\sxml:lang=)"({_TAG})"')
_JSON: Final = re.compile(rf'("@language": )"({_TAG})"')


def restore_case(document: bytes, syntax: str) -> bytes:
    """Return a document in a syntax that semmap writes with the usual case of its language tags."""
    if not _ANY.search(document):
        return document
    text = document.decode()
    if syntax in ("rdfxml", "jsonld"):
        pattern = _XML if syntax == "rdfxml" else _JSON
        return pattern.sub(lambda found: f'{found[1]}"{format_tag(found[2])}"', text).encode()
    return _TEXT.sub(lambda found: _format_literal(found) if found[2] else found[0], text).encode()


def _format_literal(found: re.Match[str]) -> str:
    return f"{found[1]}@{format_tag(found[2])}"


def format_tag(tag: str) -> str:
    """Return a language tag in its usual case: regions in capitals, and scripts with one.

    Subtags after a single letter, such as those of private use, stay in lower case.
    """
    first, *others = tag.lower().split("-")
    parts, in_extension = [first], len(first) == 1
    for part in others:
        in_extension = in_extension or len(part) == 1
        if not in_extension and len(part) == 2:
            part = part.upper()
        elif not in_extension and len(part) == 4 and part.isalpha():
            part = part.capitalize()
        parts.append(part)
    return "-".join(parts)
