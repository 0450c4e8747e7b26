"""What people call classes and properties, and which one they mean."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple

from semmap.ontology.vocabulary import local_name
from semmap.schemas.entities import composed
from semmap.schemas.errors import enumerated, nearest

_SEPARATORS = re.compile(r"[\s_-]+")


class Named(NamedTuple):
    """Something of the TBox with a name of its own."""

    name: str
    """Unique among its kind: `Chair`, or `soma:Color` where there is another `Color`."""
    iri: str
    """Without brackets."""
    prefixed: str = ""
    """Its name with a prefix, which need not be said: `dm:Chair`."""
    labels: tuple[str, ...] = ()
    """What people call it, in every language."""


class Ambiguous(Exception):
    """A word that may mean several; `names` are those."""

    def __init__(self, names: list[str]) -> None:
        super().__init__(enumerated(names))
        self.names = names


class NameIndex:
    """Finds what a word means: a name or an IRI; else without regard to case and separators; else a label."""

    def __init__(self, known: Iterable[Named]) -> None:
        self._exact: dict[str, str] = {}
        self._folded: dict[str, list[str]] = {}
        self._labelled: dict[str, list[str]] = {}
        self._hints: dict[str, str] = {}
        """Each name and label, and how it is suggested."""
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
        """The name of what `word` means, or None. Raises Ambiguous."""
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
        """`; did you mean A or B ('its label')?` with the nearest names and labels, or nothing."""
        found = dict.fromkeys(self._hints[near] for near in nearest(word, self._hints))
        names = {hint.partition(" ('")[0] for hint in found if " ('" not in hint}
        named = [hint for hint in found if hint in names or hint.partition(" ('")[0] not in names]
        return f"; did you mean {enumerated(named)}?" if named else ""


def fold(word: str) -> str:
    """What of a word counts when it is not taken literally: neither its case nor its separators."""
    return _SEPARATORS.sub("", composed(word).casefold())
