"""Checks of the query text: only queries that read this map are allowed. Also explains syntax errors."""

from __future__ import annotations

import re
from collections.abc import Iterator
from types import MappingProxyType
from typing import Final

from semmap.ontology.prefixes import WELL_KNOWN, Prefixes, other_scheme
from semmap.schemas import errors

PREFIXES: Final = dict(WELL_KNOWN)
"""The prefixes that a query need not declare with any TBox. The prefixes of the TBox are added to them."""

_FORMS = frozenset({"SELECT", "ASK", "CONSTRUCT", "DESCRIBE"})
_UPDATES = frozenset({"INSERT", "DELETE", "LOAD", "CLEAR", "CREATE", "DROP", "COPY", "MOVE", "ADD", "WITH"})
_ELSEWHERE = frozenset({"SERVICE", "FROM", "LOAD"})
_TOKEN = re.compile(
    r"""
    \#[^\n]*                                            # a comment
    | <[^\x00-\x20<>"{}|^`\\]*>                         # an IRI
    | \"\"\"(?:\"{0,2}(?:[^"\\]|\\.))*\"\"\" | '''(?:'{0,2}(?:[^'\\]|\\.))*'''
    | "(?:[^"\\\n]|\\.)*" | '(?:[^'\\\n]|\\.)*'
    | [?$]\w+ | @[\w-]+                                 # a variable, a language
    | (?:[^\W\d_][\w.-]*)?:(?:[\w:.%-]|\\.)*| _:[\w.-]+ # a prefixed name, a blank node
    | (?P<word>[^\W\d_]\w*)
    """,
    re.VERBOSE | re.DOTALL,
)
_FAULT = re.compile(r"error at (\d+):(\d+): expected (.*)", re.DOTALL)
_REASONS = (
    ("Duplicated variable name", "a variable is selected twice"),
    ("a variable that is unbound", "it selects a variable that it neither binds nor groups by"),
    ("IRI parsing failed", "an IRI is malformed"),
)


def query_prefixes(of_tbox: Prefixes) -> dict[str, str]:
    """Return the prefixes that a query need not declare with a TBox that has these prefixes."""
    well_known = {
        prefix: namespace
        for prefix, namespace in PREFIXES.items()
        if of_tbox.get(prefix) != other_scheme(namespace)
    }
    return {**of_tbox, **well_known}


def require_reading(query: str) -> str:
    """Return the form of a query: SELECT, ASK, CONSTRUCT or DESCRIBE.

    Raises Refused for an update and for access beyond the map, BadRequest if it is not a query.
    """
    words = list(_words(query))
    form = next((word for word in words if word in _FORMS or word in _UPDATES), None)
    if form in _UPDATES:
        raise errors.Refused(
            f"{form} is an update, and SPARQL is read-only here; to change the map use add, update or remove"
        )
    if form is None:
        raise errors.BadRequest("not a valid SPARQL query: it needs SELECT, ASK, CONSTRUCT or DESCRIBE")
    if beyond := next((word for word in words if word in _ELSEWHERE), None):
        raise errors.Refused(f"{beyond} is not allowed: a query can access only this map, not the network")
    return form


def require_select(query: str) -> None:
    """Raise BadRequest for a query without rows to watch, Refused as `require_reading` does."""
    if (form := require_reading(query)) != "SELECT":
        raise errors.BadRequest(f"only a SELECT query can be watched, and this is a query of form {form}")


def syntax_error(
    query: str, error: SyntaxError, prefixes: Prefixes = MappingProxyType(PREFIXES)
) -> errors.BadRequest:
    """Return the error of Oxigraph's parser without its grammar: the position and, if known, the reason."""
    match = _FAULT.match(str(error))
    if match is None:
        return errors.BadRequest(f"not a valid SPARQL query: {' '.join(str(error).split())}")
    line, column, expected = int(match[1]), int(match[2]), match[3]
    reason = _reason(query, line, column, expected, prefixes)
    return errors.BadRequest(f"not a valid SPARQL query: line {line}, column {column}: {reason}")


def _reason(query: str, line: int, column: int, expected: str, prefixes: Prefixes) -> str:
    text = query.splitlines()[line - 1] if line <= len(query.splitlines()) else ""
    before, after = text[: column - 1], text[column - 1 :].strip()
    if "Prefix not found" in expected and (prefix := re.search(r"([\w.-]*):[^\s:]*$", before)):
        known = ", ".join(f"{name}:" for name in prefixes)
        return f"unknown prefix '{prefix[1]}:'; known are {known}; declare others with PREFIX"
    for sign, reason in _REASONS:
        if sign in expected:
            return reason
    return f"'{after[:30]}' is not expected there" if after else "unexpected end, or an error before it"


def _words(query: str) -> Iterator[str]:
    """Yield the bare words of a query in capitals: keywords and names of functions."""
    return (match["word"].upper() for match in _TOKEN.finditer(query) if match["word"])
