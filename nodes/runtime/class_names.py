"""Resolves class names as users write them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from semmap.ontology.name_index import Ambiguous, Named, NameIndex
from semmap.schemas.entities import ClassInfo
from semmap.schemas.errors import UnknownClass, enumerated


class AmbiguousClass(UnknownClass):
    """The name matches several classes."""


class ClassNames:
    """The classes of the TBox by their names and labels.

    A class name or an IRI is matched exactly. Otherwise case, underscores and spaces are ignored, and labels
    in all languages of the TBox are matched too.
    """

    def __init__(self, classes: Iterable[ClassInfo] = ()) -> None:
        self.by_name = {c.name: c for c in classes}
        self._index = NameIndex(
            Named(c.name, c.iri, c.prefixed, (*c.labels.values(), *c.also)) for c in self.by_name.values()
        )
        self._has_spatial = any(c.spatial for c in self.by_name.values())

    def find(self, word: str) -> ClassInfo:
        """Return the class that `word` names. Raises AmbiguousClass, or UnknownClass with similar names."""
        try:
            name = self._index.find(word)
        except Ambiguous as error:
            raise AmbiguousClass(
                f"'{word}' is ambiguous: {enumerated(error.names)}; use one of these names"
            ) from None
        if name is None:
            hint = self._index.did_you_mean(word) or "; see: semmap classes"
            raise UnknownClass(f"unknown class '{word}'{hint}")
        return self.by_name[name]

    def unknown(self, users: Mapping[str, Sequence[str]]) -> UnknownClass:
        """Return the error for the unknown classes of a file: each word with the names of its entities."""
        return UnknownClass(self._index.unknown_classes(users))

    def has(self, word: str) -> bool:
        """Return whether a word names one class of objects in space."""
        try:
            return self.find(word).spatial
        except UnknownClass:
            return False

    def spatial(self, word: str) -> ClassInfo:
        """Return the class of objects in space that `word` names. Raises UnknownClass."""
        found = self.find(word)
        if not found.spatial and not self._has_spatial:
            raise UnknownClass(
                "the TBox does not define which of its classes are spatial;"
                " load it again with --spatial-root CLASS"
            )
        if not found.spatial:
            raise UnknownClass(f"'{found.name}' is not a spatial class; see: semmap classes")
        return found

    def note(self, word: str, found: ClassInfo) -> tuple[str, ...]:
        """Return a note on how `word` was resolved, unless it was matched exactly."""
        if word in (found.name, found.prefixed, found.iri, f"<{found.iri}>"):
            return ()
        return (f"'{word}' is read as {found.name}",)
