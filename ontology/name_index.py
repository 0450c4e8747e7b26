"""Look-up of classes and properties by name, IRI or label."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from semmap.ontology.vocabulary import local_name
from semmap.schemas.entities import composed
from semmap.schemas.errors import enumerated, nearest, unknown_classes

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
        self._namesakes: dict[str, list[Named]] = {}
        """Local name to the terms that have it, in any namespace."""
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
            self._namesakes.setdefault(fold(local_name(f"<{item.iri}>")), []).append(item)

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
        """Return `; did you mean A or B ('its label')?` with similar names and labels, or an empty text.

        For an IRI these are the IRIs with the same local name in other namespaces, if there are any.
        """
        if namesakes := self.namesakes(word):
            return _suggested(namesakes)
        if _is_iri(word):
            word = local_name(_bracketed(word))
        found = dict.fromkeys(self._hints[near] for near in nearest(word, self._hints))
        names = {hint.partition(" ('")[0] for hint in found if " ('" not in hint}
        named = [hint for hint in found if hint in names or hint.partition(" ('")[0] not in names]
        return f"; did you mean {enumerated(named)}?" if named else ""

    def namesakes(self, word: str) -> list[Named]:
        """Return the items that have the local name of an IRI in another namespace; none for another word."""
        if not _is_iri(word):
            return []
        found = self._namesakes.get(fold(local_name(_bracketed(word))), ())
        return [item for item in found if _namespace(item.iri) != _namespace(word)]

    def unknown_classes(self, users: Mapping[str, Sequence[str]]) -> str:
        """One sentence on the unknown classes of a file, given by name or IRI, and on their individuals.

        Of several classes in one wrong namespace, the first is named.
        """
        groups: dict[tuple[str, ...], list[str]] = {}
        for word in users:
            iris = tuple(_namespace(item.iri) for item in self.namesakes(word))
            groups.setdefault((_namespace(word), *iris) if iris else (word,), []).append(word)
        shown = {words[0]: [user for word in words for user in users[word]] for words in groups.values()}
        hints = {
            words[0]: _suggested(found, len(words) - 1)
            for words in groups.values()
            if (found := self.namesakes(words[0]))
        }
        return unknown_classes(shown, dict.fromkeys(self._exact.values()), hints)


def _is_iri(word: str) -> bool:
    return "://" in word or word.startswith(("<", "urn:"))


def _bracketed(iri: str) -> str:
    return f"<{iri.strip('<>')}>"


def _namespace(iri: str) -> str:
    return _bracketed(iri)[:-1].removesuffix(local_name(_bracketed(iri)))


def _suggested(found: Sequence[Named], others: int = 0) -> str:
    """`; did you mean <IRI> (prefix dm:)?` with the number of `others` to which the same applies."""
    iris = [
        f"<{item.iri}>"
        + ("" if item.prefixed in ("", item.iri) else f" (prefix {item.prefixed.split(':')[0]}:)")
        for item in found[:3]
    ]
    more = "" if not others else f", and so for {others} more {'class' if others == 1 else 'classes'}"
    return f"; did you mean {enumerated(iris)}{more}?"


def fold(word: str) -> str:
    """Return a word without case and separators, for comparison."""
    return _SEPARATORS.sub("", composed(word).casefold())
