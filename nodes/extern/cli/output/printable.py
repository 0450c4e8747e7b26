"""Printing of texts from other programs: control characters are printed as escape sequences."""

from __future__ import annotations

import re
import sys
from typing import TextIO

_CONTROLS_IN_JSON = re.compile("[\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]")
"""The control characters that a JSON encoder does not escape."""


def escaped(text: str) -> str:
    """Return a text with its line ends and control characters escaped."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def quoted(text: str) -> str:
    """Return a text in double quotes on one line, with quotes and control characters escaped."""
    return '"' + escaped(text.replace("\\", "\\\\").replace('"', '\\"')) + '"'


def escaped_json(text: str) -> str:
    """Return the same JSON with all control characters escaped."""
    return _CONTROLS_IN_JSON.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def write(document: str) -> None:
    """Write a document to stdout. Control characters are escaped if stdout is a terminal."""
    if sys.stdout.isatty():
        document = "".join(c if c in "\r\n\t" else escaped(c) for c in document)
    sys.stdout.write(document)


def print_escaped(text: str, *, file: TextIO | None = None) -> None:
    """Print lines of text with control characters escaped, and flush."""
    print("\n".join(map(escaped, text.split("\n"))), file=file or sys.stdout, flush=True)
