"""Look-up of classes and properties by name, IRI or label."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple

from semmap.ontology.vocabulary import local_name
from semmap.schemas.entities import composed
from semmap.schemas.errors import enumerated, nearest

_SEPARATORS = re.compile(r"[\s_-]+")


class Named(NamedTuple):
    """A named term of the TBox."""

    name: str
    """A unique name: `Chair`, or `soma:Color` if there is another `Color`."""
    iri: str
    """Without brackets."""
    prefixed: str = ""
    """Its name with the prefix: `dm:Chair`."""
    labels: tuple[str, ...] = ()
    """Its labels in all languages."""


class Ambiguous(Exception):
    """An ambiguous word; `names` are the candidates."""

    def __init__(self, names: list[str]) -> None:
        super().__init__(enumerated(names))
        self.names = names


class NameIndex:
    """Resolves a word: by exact name or IRI, then ignoring case and separators, then by label."""

    def __init__(self, known: Iterable[Named]) -> None:
        self._exact: dict[str, str] = {}
        self._folded: dict[str, list[str]] = {}
        self._labelled: dict[str, list[str]] = {}
        self._hints: dict[str, str] = {}
        """Each name and label, with its text in suggestions."""
        for item in known:
            name = item.name
            for word in (name, item.iri, f"<{item.iri}>"):
                self._exact[word] = name
            if item.prefixed:
                self._exact.setdefault(item.prefixed, name)
            for word in {fold(name), fold(item.prefixed), fold(local_name(f"<{item.iri}>"))} - {""}:
                self._folded.setdefault(word, []).append(name)
            for label in {fold(label) for label in item.labels} - {""}:
                self._labelled.setdefault(label, []).append(name)
            for label in item.labels:
                self._hints.setdefault(label, f"{name} ('{label}')" if fold(label) != fold(name) else name)
            self._hints[name] = name

    def find(self, word: str) -> str | None:
        """Return the name of the term that `word` denotes, or None. Raises Ambiguous."""
        if word in self._exact:
            return self._exact[word]
        key = fold(word)
        for found in (self._folded.get(key, ()), self._labelled.get(key, ())):
            if len(found) > 1:
                raise Ambiguous(sorted(found))
            if found:
                return found[0]
        return None

    def did_you_mean(self, word: str) -> str:
        """Return `; did you mean A or B ('its label')?` with similar names and labels, or an empty text."""
        found = dict.fromkeys(self._hints[near] for near in nearest(word, self._hints))
        names = {hint.partition(" ('")[0] for hint in found if " ('" not in hint}
        named = [hint for hint in found if hint in names or hint.partition(" ('")[0] not in names]
        return f"; did you mean {enumerated(named)}?" if named else ""


def fold(word: str) -> str:
    """Return a word without case and separators, for comparison."""
    return _SEPARATORS.sub("", composed(word).casefold())
