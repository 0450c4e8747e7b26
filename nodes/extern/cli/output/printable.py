"""Texts that come from elsewhere, for a terminal: what would command it is shown by its escape."""

from __future__ import annotations

import re
import sys
from typing import TextIO

_CONTROLS_IN_JSON = re.compile("[\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]")
"""JSON itself escapes those below the space only."""


def escaped(text: str) -> str:
    """Text as it is, with line ends and the like as escapes: they would break the row, or the terminal."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def quoted(text: str) -> str:
    """Text in double quotes on one line: nothing in it ends the quotation, the line or the row."""
    return '"' + escaped(text.replace("\\", "\\\\").replace('"', '\\"')) + '"'


def escaped_json(text: str) -> str:
    """The same JSON, without control characters that a terminal might heed."""
    return _CONTROLS_IN_JSON.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def write(document: str) -> None:
    """Write a document as it is, or to a terminal without what would command that."""
    if sys.stdout.isatty():
        document = "".join(c if c in "\r\n\t" else escaped(c) for c in document)
    sys.stdout.write(document)


def print_escaped(text: str, *, file: TextIO | None = None) -> None:
    """Print lines of text, at once."""
    print("\n".join(map(escaped, text.split("\n"))), file=file or sys.stdout, flush=True)
