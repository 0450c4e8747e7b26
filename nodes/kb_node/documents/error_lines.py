"""Line numbers of syntax errors for parsers that do not report them."""

from __future__ import annotations

import io
from typing import IO, cast

import pyoxigraph


def find_error_line(content: bytes, syntax: pyoxigraph.RdfFormat, base_iri: str) -> int:
    """Return the line that the parser had read when it failed. The parser is fed line by line."""
    lines = _Lines(content)
    try:
        for _ in pyoxigraph.parse(
            cast("IO[bytes]", lines), syntax, base_iri=base_iri, without_named_graphs=True
        ):
            pass
    except (SyntaxError, ValueError):
        pass
    return lines.number


class _Lines(io.RawIOBase):
    """A file that returns at most one line per read."""

    def __init__(self, content: bytes) -> None:
        super().__init__()
        self._content = content
        self._at = 0
        self.number = 0
        """Number of the line returned last, from 1."""

    def readable(self) -> bool:
        return True

    def read(self, size: int = -1) -> bytes:
        if self._at == 0 or self._content[self._at - 1 : self._at] == b"\n":
            self.number += self._at < len(self._content)
        end = self._content.find(b"\n", self._at) + 1 or len(self._content)
        given = self._content[self._at : end if size < 0 else min(end, self._at + size)]
        self._at += len(given)
        return given
