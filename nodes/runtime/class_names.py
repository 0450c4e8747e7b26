"""Resolves class names as people write them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from semmap.ontology.name_index import Ambiguous, Named, NameIndex
from semmap.schemas.entities import ClassInfo
from semmap.schemas.errors import UnknownClass, enumerated


class AmbiguousClass(UnknownClass):
    """Several classes may be meant."""


class ClassNames:
    """The classes of the TBox by what people call them.

    A name or an IRI is taken literally. Else case, underscores and spaces do not matter, and labels count, in
    every language that the TBox has.
    """

    def __init__(self, classes: Iterable[ClassInfo] = ()) -> None:
        self.by_name = {c.name: c for c in classes}
        self._index = NameIndex(
            Named(c.name, c.iri, c.prefixed, (*c.labels.values(), *c.also)) for c in self.by_name.values()
        )
        self._has_spatial = any(c.spatial for c in self.by_name.values())

    def find(self, word: str) -> ClassInfo:
        """The class that `word` means. Raises AmbiguousClass, UnknownClass with the nearest names."""
        try:
            name = self._index.find(word)
        except Ambiguous as error:
            raise AmbiguousClass(
                f"'{word}' is ambiguous: {enumerated(error.names)}; say which class"
            ) from None
        if name is None:
            raise UnknownClass(f"unknown class '{word}'{self._index.did_you_mean(word)}")
        return self.by_name[name]

    def unknown(self, users: Mapping[str, Sequence[str]]) -> UnknownClass:
        """Return the error for the unknown classes of a file: each word with the names of its entities."""
        return UnknownClass(self._index.unknown_classes(users))

    def has(self, word: str) -> bool:
        """Whether a word means one class of things in space."""
        try:
            return self.find(word).spatial
        except UnknownClass:
            return False

    def spatial(self, word: str) -> ClassInfo:
        """The class of a thing in space that `word` means. Raises UnknownClass."""
        found = self.find(word)
        if not found.spatial and not self._has_spatial:
            raise UnknownClass(
                "nothing can be placed: the TBox does not say which of its classes are of things in space;"
                " load it again with --spatial-root CLASS"
            )
        if not found.spatial:
            raise UnknownClass(f"'{found.name}' is not a class of things in space; see: semmap classes")
        return found

    def note(self, word: str, found: ClassInfo) -> tuple[str, ...]:
        """How `word` was understood, where it was not taken literally."""
        if word in (found.name, found.prefixed, found.iri, f"<{found.iri}>"):
            return ()
        return (f"'{word}' is read as {found.name}",)
