"""What nouns name: the classes of a TBox by their labels, and what kind of thing each is."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Final

from semmap.nodes.language.lexicon import Lexicon
from semmap.nodes.language.words import based

BRANCHES: Final = (
    "Robot", "Person", "Location", "Door", "Window", "Connecting_Architecture", "Vessel", "Container",
    "Light", "Television", "Appliance", "Device", "Fixture", "Bed", "Table", "Couch", "Furniture", "Food",
    "Cloth", "Clothes", "Tableware",
)  # fmt: skip
"""The branches of the household taxonomy that decide how one speaks of a thing, most special first."""

_GENERAL: Final = {
    *BRANCHES, "Object", "Physical_Thing", "Living_Thing", "Building_Subparts", "Covering", "Accessories",
    "Dishware",
}  # fmt: skip


def spoken(name: str) -> str:
    """A label or a class's name as it is said: `Dining_Room` and `DiningRoom` are `dining room`."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).replace("_", " ").lower().strip()


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """The classes of a TBox by what they are called."""

    classes: Mapping[str, str]  # what is said, in base forms too -> class
    above: Mapping[str, frozenset[str]]  # class -> its superclasses, itself among them
    _branches: dict[str, str] = field(default_factory=dict, compare=False)

    def class_of(self, text: str) -> str | None:
        """The class that is called so."""
        return self.classes.get(text)

    def branch(self, class_name: str | None) -> str:
        """What kind of thing a class is of, `other` for none of the branches and `unknown` for no class."""
        if class_name is None:
            return "unknown"
        if class_name not in self._branches:
            above = self.above.get(class_name, frozenset())
            self._branches[class_name] = next((name for name in BRANCHES if name in above), "other")
        return self._branches[class_name]

    def nameable_above(self, class_name: str | None) -> list[str]:
        """The superclasses that one would name a thing by, not branches of the taxonomy."""
        return sorted(self.above.get(class_name or "", frozenset()) - _GENERAL)


def vocabulary(
    labels: Iterable[tuple[str, str]], subclasses: Iterable[tuple[str, str]], lexicon: Lexicon
) -> Vocabulary:
    """What there is to be named. labels: class and label; subclasses: class and superclass."""
    direct: dict[str, set[str]] = {}
    for below, superclass in subclasses:
        direct.setdefault(below, set()).add(superclass)
    classes: dict[str, str] = {}
    for name, label in labels:
        direct.setdefault(name, set())
        for text in (spoken(label), spoken(name)):
            classes.setdefault(text, name)
            classes.setdefault(based(text, lexicon), name)
    for text, name in lexicon.synonyms.items():
        if name in direct:
            classes.setdefault(text, name)
            classes.setdefault(based(text, lexicon), name)
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
