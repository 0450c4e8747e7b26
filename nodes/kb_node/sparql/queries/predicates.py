"""Whether a query may use certain properties, decided from its text, which takes almost no time."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import lru_cache
from typing import Final

_TOKEN: Final = re.compile(
    r"""
    (?P<blank>\s+ | \#[^\n]*)
    | (?P<datatype>\^\^)
    | (?P<term>
        <[^\x00-\x20<>"{}|^`\\]*>
        | \"\"\"(?:\"{0,2}(?:[^"\\]|\\.))*\"\"\" | '''(?:'{0,2}(?:[^'\\]|\\.))*'''
        | "(?:[^"\\\n]|\\.)*" | '(?:[^'\\\n]|\\.)*'
        | _:[\w.-]*\w | (?:[^\W\d_](?:[\w.-]*\w)?)?:(?:(?:[\w:%-]|\\.|\.(?=[\w:%.\\-]))*)
        | [+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?
      )
    | (?P<variable>[?$]\w+)
    | (?P<language>@[\w-]+)
    | (?P<word>[^\W\d_]\w*)
    | (?P<sign>.)
    """,
    re.VERBOSE | re.DOTALL,
)
_TERMS: Final = frozenset({"A", "TRUE", "FALSE"})
_WITHOUT_PATTERNS: Final = frozenset({"SELECT", "GROUP", "ORDER", "HAVING"})
_PARENTHESES: Final = re.compile(r"w?\([^(){}\[\]]*\)")
_PREDICATE: Final = re.compile(r"[tv\];\[]v[tv\[(]")


@lru_cache(maxsize=1000)
def may_use_properties(query: str, names: frozenset[str]) -> bool:
    """Return whether one of these local names, or a variable, may be a predicate in a query."""
    return any(name in query for name in names) or "\\" in query or has_variable_predicate(query)


def has_variable_predicate(query: str) -> bool:
    """Return whether a predicate may be a variable, or a resource is described.

    False positives are possible.
    """
    shape = "".join(_shape(query))
    if "d" in shape:
        return True
    shape = re.sub(r"s[^{}]*", ".", shape)
    shape = re.sub(r"\^t", "", shape)
    while (simpler := _PARENTHESES.sub(_as_one, shape)) != shape:
        shape = simpler
    return _PREDICATE.search(shape) is not None


def terms_of(query: str) -> Iterator[str]:
    """Yield the terms and bare words of a query as written, without variables."""
    return (match[0] for match in _TOKEN.finditer(query) if match.lastgroup in ("term", "word"))


def _as_one(match: re.Match[str]) -> str:
    return "." if match[0][0] == "w" else "t"


def _shape(query: str) -> Iterable[str]:
    """Yield a letter per token: `t`erm, `v`ariable, `w`ord, `s`election, `d`escription; signs as they are."""
    for match in _TOKEN.finditer(query):
        kind, text = match.lastgroup, match[0]
        if kind == "term":
            yield "t"
        elif kind == "variable":
            yield "v"
        elif kind == "word":
            word = text.upper()
            yield (
                "t"
                if word in _TERMS
                else "s"
                if word in _WITHOUT_PATTERNS
                else "d"
                if word == "DESCRIBE"
                else "w"
            )
        elif kind == "datatype":
            yield "^"
        elif kind == "sign":
            yield text if text != "^" else "/"
