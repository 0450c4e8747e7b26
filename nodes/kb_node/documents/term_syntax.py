"""Validation of RDF terms that are received over the wire."""

from __future__ import annotations

import re
from collections.abc import Iterable

from semmap.schemas import errors
from semmap.schemas.explanations import Triple

_IRI = r"<(?!javascript:|data:)[A-Za-z][A-Za-z0-9+.-]*:[^\x00-\x20<>\"{}|^`\\]*>"
_BLANK = r"_:[A-Za-z0-9_](?:[A-Za-z0-9_.-]*[A-Za-z0-9_-])?"
_LITERAL = rf'"(?:[^"\\\n\r]|\\[tbnrf"\\]|\\u[0-9A-F]{{4}})*"(?:@[a-z]+(?:-[a-z0-9]+)*|\^\^{_IRI})?'
_TRIPLE = re.compile(rf"(?:{_IRI}|{_BLANK}) {_IRI} (?:{_IRI}|{_BLANK}|{_LITERAL})", re.IGNORECASE)


def require_triples(triples: Iterable[Triple]) -> None:
    """Raise BadRequest for a triple that is not valid N-Triples."""
    for triple in triples:
        line = " ".join(triple)
        if not _TRIPLE.fullmatch(line):
            raise errors.BadRequest(f"not a valid N-Triples statement: {line}")
