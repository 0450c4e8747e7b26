"""Converts many common words of Turtle to terms at once: prefixed names and typed literals.

Words of one kind are joined and rewritten as one text, so that no Python code runs for each word. If some
words of a kind are unusual, all of them are left out and converted one by one elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from semmap.schemas.explanations import Term

_FEWEST = 100
"""Words of a kind below which converting them one by one is as fast."""
_MOST_KINDS = 20


def plain_terms(
    words: Iterable[str], namespaces: Mapping[str, str], datatype: Callable[[str], Term | None]
) -> dict[str, Term]:
    """Return the terms of those words that are common and have many others of their kind.

    `namespaces` are those of common prefixes. `datatype(word)` returns the datatype if its literals keep
    their text, or None.
    """
    names: dict[str, list[str]] = {}
    literals: dict[str, list[str]] = {}
    for word in words:
        if word[0] == '"':
            kind = word.rpartition("^^")[2]
            groups = literals
        else:
            kind = word.partition(":")[0]
            groups = names
        if kind in groups:
            groups[kind].append(word)
        elif len(groups) < _MOST_KINDS:
            groups[kind] = [word]
    found: dict[str, Term] = {}
    for prefix, alike in names.items():
        if len(alike) >= _FEWEST and prefix in namespaces:
            found.update(zip(alike, _names(alike, prefix, namespaces[prefix]), strict=False))
    for kind, alike in literals.items():
        if len(alike) >= _FEWEST and (full := datatype(kind)) is not None:
            found.update(zip(alike, _literals(alike, kind, full), strict=False))
    return found


def _names(words: list[str], prefix: str, namespace: str) -> list[Term]:
    """Return the IRIs of words that begin with `prefix:`, or none if some are unusual."""
    text = "\n".join(("", *words, ""))
    begin = f"\n{prefix}:"
    locals_ = text.replace(begin, "")
    if f"{begin}\n" in text or f"{begin}-" in text or not text.isascii():
        return []
    if not locals_.replace("_", "").replace("-", "").removesuffix("\n").isalnum():
        return []
    return text.replace("\n", ">\n").replace(begin, f"\n<{namespace}").split("\n")[1:-1]


def _literals(words: list[str], kind: str, datatype: Term) -> list[Term]:
    """Return the literals of words that end with `^^kind`, or none if some are unusual."""
    text = "\n".join(("", *words, ""))
    end = f'"^^{kind}\n'
    if text.count('"') != 2 * len(words) or text.count(end) != len(words) or f"\n{end}" in text:
        return []
    if "\\" in text or not (text.isascii() and text.replace("\n", "").isprintable()):
        return []
    return text.replace(end, f'"^^{datatype}\n').split("\n")[1:-1]
