"""The class hierarchy, with labels and typical sizes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from semmap.schemas.entities import ClassInfo, Size

ANYTHING = "Object"
"""The class of a thing of no known class."""


@dataclass(frozen=True)
class ClassHierarchy:
    """Superclasses and labels of the TBox, and the typical sizes `usual_m` that perception learned."""

    ancestors: Mapping[str, frozenset[str]] = field(default_factory=dict)
    labels: Mapping[str, str] = field(default_factory=dict)
    usual_m: Mapping[str, Size] = field(default_factory=dict)

    def label(self, class_name: str) -> str:
        """Return the label of a class."""
        return self.labels.get(class_name) or class_name.replace("_", " ").lower()

    def is_a(self, special: str, general: str) -> bool:
        """Return whether class `special` is a subclass of `general`. Everything is an Object."""
        return (
            special == general or general == ANYTHING or general in self.ancestors.get(special, frozenset())
        )

    def related(self, one: str, other: str) -> bool:
        """Return whether one class is a subclass of the other."""
        return self.is_a(one, other) or self.is_a(other, one)

    def depth(self, class_name: str) -> int:
        """Return the number of superclasses."""
        return len(self.ancestors.get(class_name, ()))


def hierarchy_of(classes: Iterable[ClassInfo], usual_m: Mapping[str, Size]) -> ClassHierarchy:
    """Return the hierarchy of the TBox's classes, with their typical sizes."""
    rows = list(classes)
    labels = {row.name: row.labels.get("en") or row.labels.get("") or "" for row in rows}
    return ClassHierarchy({row.name: frozenset(row.ancestors) for row in rows}, labels, usual_m)
