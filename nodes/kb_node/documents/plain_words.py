"""What many words of Turtle stand for at once, where that can be told at sight: names and typed literals.

Words of one kind are joined, looked at and rewritten as one text, so that no line of Python runs for each of
them. A kind that is not plain throughout is left out, and looked at word by word elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from semmap.schemas.explanations import Term

_FEWEST = 100
"""Words of a kind; fewer are looked at as quickly one by one."""
_MOST_KINDS = 20


def plain_terms(
    words: Iterable[str], namespaces: Mapping[str, str], datatype: Callable[[str], Term | None]
) -> dict[str, Term]:
    """The terms of those of some words that are plain, and have many others of their kind beside them.

    `namespaces` are those of plain prefixes; `datatype(word)` is that of a literal whose text stays as it is,
    None for any other.
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
    """IRIs of words that begin with `prefix:`; none if some may need a closer look."""
    text = "\n".join(("", *words, ""))
    begin = f"\n{prefix}:"
    locals_ = text.replace(begin, "")
    if f"{begin}\n" in text or f"{begin}-" in text or not text.isascii():
        return []
    if not locals_.replace("_", "").replace("-", "").removesuffix("\n").isalnum():
        return []
    return text.replace("\n", ">\n").replace(begin, f"\n<{namespace}").split("\n")[1:-1]


def _literals(words: list[str], kind: str, datatype: Term) -> list[Term]:
    """Literals of words that begin with `"` and end with `^^kind`; none if some may need a closer look."""
    text = "\n".join(("", *words, ""))
    end = f'"^^{kind}\n'
    if text.count('"') != 2 * len(words) or text.count(end) != len(words) or f"\n{end}" in text:
        return []
    if "\\" in text or not (text.isascii() and text.replace("\n", "").isprintable()):
        return []
    return text.replace(end, f'"^^{datatype}\n').split("\n")[1:-1]
