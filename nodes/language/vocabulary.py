"""The classes of a TBox by their labels, and the branch of the taxonomy of each."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Final

from semmap.nodes.language.lexicon import Lexicon
from semmap.nodes.language.words import to_base_forms

BRANCHES: Final = (
    "Robot", "Person", "Location", "Door", "Window", "Connecting_Architecture", "Vessel", "Container",
    "Light", "Television", "Appliance", "Device", "Fixture", "Bed", "Table", "Couch", "Furniture", "Food",
    "Cloth", "Clothes", "Tableware",
)  # fmt: skip
"""The branches of the household taxonomy that commands distinguish, the most specific first."""

_GENERAL: Final = {
    *BRANCHES, "Object", "Physical_Thing", "Living_Thing", "Building_Subparts", "Covering", "Accessories",
    "Dishware",
}  # fmt: skip


def to_words(name: str) -> str:
    """Return a label or class name as words: `Dining_Room` and `DiningRoom` become `dining room`."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).replace("_", " ").lower().strip()


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """The classes of a TBox by their labels."""

    classes: Mapping[str, str]  # label, as written and in base form -> class
    above: Mapping[str, frozenset[str]]  # class -> its superclasses, itself among them
    _branches: dict[str, str] = field(default_factory=dict, compare=False)

    def class_of(self, text: str) -> str | None:
        """Return the class with this label."""
        return self.classes.get(text)

    def branch(self, class_name: str | None) -> str:
        """Return the branch of a class, `other` for a class outside the branches, `unknown` for no class."""
        if class_name is None:
            return "unknown"
        if class_name not in self._branches:
            above = self.above.get(class_name, frozenset())
            self._branches[class_name] = next((name for name in BRANCHES if name in above), "other")
        return self._branches[class_name]

    def nameable_above(self, class_name: str | None) -> list[str]:
        """Return the superclasses that are specific enough to name an object."""
        return sorted(self.above.get(class_name or "", frozenset()) - _GENERAL)


def vocabulary(
    labels: Iterable[tuple[str, str]], subclasses: Iterable[tuple[str, str]], lexicon: Lexicon
) -> Vocabulary:
    """Return the vocabulary for pairs of class and label, and of class and superclass."""
    direct: dict[str, set[str]] = {}
    for below, superclass in subclasses:
        direct.setdefault(below, set()).add(superclass)
    classes: dict[str, str] = {}
    for name, label in labels:
        direct.setdefault(name, set())
        for text in (to_words(label), to_words(name)):
            classes.setdefault(text, name)
            classes.setdefault(to_base_forms(text, lexicon), name)
    for text, name in lexicon.synonyms.items():
        if name in direct:
            classes.setdefault(text, name)
            classes.setdefault(to_base_forms(text, lexicon), name)
    return Vocabulary(classes, {name: frozenset(_closure(name, direct)) for name in direct})


def _closure(name: str, direct: Mapping[str, set[str]]) -> set[str]:
    seen: set[str] = set()
    waiting = [name]
    while waiting:
        current = waiting.pop()
        if current not in seen:
            seen.add(current)
            waiting += direct.get(current, ())
    return seen
