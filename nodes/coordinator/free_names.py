"""Generates names for entities that are added without one, without searching from 1 each time."""

from __future__ import annotations

from collections.abc import Container, Iterable

from semmap.schemas.entities import name_stem


class FreeNames:
    """The first free number of each class, by the rule of `semmap.schemas.entities.free_name`."""

    def __init__(self) -> None:
        self._first: dict[str, int] = {}
        """Maps a stem to a number below which all are taken."""

    def name(self, class_name: str, taken: Container[str]) -> str:
        """Return the first free name for an entity of a class; `taken` may have grown since the last call."""
        stem = name_stem(class_name)
        number = self._first.get(stem, 1)
        while f"{stem}{number}" in taken:
            number += 1
        self._first[stem] = number
        return f"{stem}{number}"

    def release(self, name: str) -> None:
        """Make a name available again."""
        for stem, number in _readings(name):
            if number < self._first.get(stem, 0):
                self._first[stem] = number


def _readings(name: str) -> Iterable[tuple[str, int]]:
    """Yield the stems and numbers that a name may have: `cup12` is number 12 of `cup` or 2 of `cup1`."""
    at = len(name)
    while at > 1 and "0" <= name[at - 1] <= "9":
        at -= 1
        if name[at] != "0":
            yield name[:at], int(name[at:])
