"""The class hierarchy, and what is known of each class."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from semmap.schemas.entities import ClassInfo, Size

ANYTHING = "Object"
"""The class of what is like nothing known."""


@dataclass(frozen=True)
class ClassHierarchy:
    """What is known of classes: all that each is a kind of, and what people call it, both from the TBox.

    `usual_m`: what things of a class measure, as far as perception learnt that.
    """

    ancestors: Mapping[str, frozenset[str]] = field(default_factory=dict)
    labels: Mapping[str, str] = field(default_factory=dict)
    usual_m: Mapping[str, Size] = field(default_factory=dict)

    def label(self, class_name: str) -> str:
        """What people call a thing of this class."""
        return self.labels.get(class_name) or class_name.replace("_", " ").lower()

    def is_a(self, special: str, general: str) -> bool:
        """Whether everything of class `special` is of class `general`. Everything is an Object."""
        return (
            special == general or general == ANYTHING or general in self.ancestors.get(special, frozenset())
        )

    def related(self, one: str, other: str) -> bool:
        """Whether a thing that is said to be of both classes is no contradiction."""
        return self.is_a(one, other) or self.is_a(other, one)

    def depth(self, class_name: str) -> int:
        """How special a class is."""
        return len(self.ancestors.get(class_name, ()))


def hierarchy_of(classes: Iterable[ClassInfo], usual_m: Mapping[str, Size]) -> ClassHierarchy:
    """The hierarchy and the labels of the TBox's classes, with what is known of their sizes."""
    rows = list(classes)
    labels = {row.name: row.labels.get("en") or row.labels.get("") or "" for row in rows}
    return ClassHierarchy({row.name: frozenset(row.ancestors) for row in rows}, labels, usual_m)
