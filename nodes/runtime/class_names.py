"""Class names as people write them."""

from __future__ import annotations

from collections.abc import Iterable

from schemas.entities import ClassInfo
from schemas.errors import UnknownClass, did_you_mean


class ClassNames:
    """The classes of the TBox by name: exact, or else without regard to case and underscores."""

    def __init__(self, classes: Iterable[ClassInfo] = ()) -> None:
        self.by_name = {c.name: c for c in classes}
        self._folded: dict[str, list[str]] = {}
        self._labelled: dict[str, list[str]] = {}
        for name, c in self.by_name.items():
            self._folded.setdefault(_fold(name), []).append(name)
            for label in c.labels.values():
                self._labelled.setdefault(label.casefold(), []).append(name)

    def find(self, word: str) -> ClassInfo:
        """The class that `word` means. Raises UnknownClass with the nearest names."""
        if word in self.by_name:
            return self.by_name[word]
        same = self._folded.get(_fold(word), [])
        if len(same) == 1:
            return self.by_name[same[0]]
        same = same or self._labelled.get(word.casefold(), [])
        hint = f"; did you mean {' or '.join(same)}?" if same else did_you_mean(word, self.by_name)
        raise UnknownClass(f"unknown class '{word}'{hint}")

    def spatial(self, word: str) -> ClassInfo:
        """The class of a thing in space that `word` means. Raises UnknownClass."""
        found = self.find(word)
        if not found.spatial:
            raise UnknownClass(f"'{found.name}' is no class of things in space; see: semmap classes")
        return found

    def note(self, word: str, found: ClassInfo) -> tuple[str, ...]:
        """How `word` was read, where it was not taken literally."""
        return () if word == found.name else (f"'{word}' is read as {found.name}",)


def _fold(name: str) -> str:
    return name.replace("_", "").casefold()
