"""The class of a world's body, found in the words of its name: `akita_black_bowl_1_main` is a bowl."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from importlib import resources
from typing import Any, Final, Literal, NamedTuple

from semmap.nodes.language import lexicon
from semmap.nodes.language.lexicon import describing
from semmap.nodes.language.words import lemma
from semmap.ontology.name_index import fold
from semmap.schemas.entities import ClassInfo

UNSURE: Final = "Object"
"""The class of a body whose name does not determine a class, if the TBox has this class."""

ROBOT: Final = "Robot"
"""The class of bodies whose joints do not open anything."""

_LONGEST: Final = 4
"""The largest number of words of one label."""
_CHUNK: Final = re.compile(r"[^\W_]+")
_WORD: Final = re.compile(r"[A-Z]+(?![^\W\d_A-Z])|[A-Z]?[^\W\d_A-Z]+|\d+")
_HASH: Final = re.compile(r"(?=.*\d)[0-9a-f]{4,}")
_OF_BUILDINGS: Final = frozenset(("Location", "Connecting_Architecture"))
"""The classes whose doors and windows are entities."""


class Found(NamedTuple):
    """The meaning of the name of a body."""

    class_: str | None
    """The class; None if it is unknown and the TBox has no class for unknown objects."""
    is_sure: bool
    label: str = ""
    """The words of the name, unless they are a label of the class: `red mug`."""
    is_stated: bool = False
    """Whether the class map or the world file states the class, so that a nested body is an entity."""


class _Item(NamedTuple):
    """One expression of a name, of one or several words."""

    text: str
    kind: Literal["class", "room", "quality", "unknown", "after head", "joining"]
    class_: str = ""
    is_italian: bool = False


class BodyClasses:
    """The classes of a TBox by the words of their names, labels and synonyms in all languages.

    In an English name, the last word is the kind of object (`wine_bottle` is a bottle). In an Italian one it
    is the first one (`bicchiere_vino` is a glass): its words of classes are Italian, and the first is not
    also English (`telecomando_tv`). Without classes, a name without its number is its own class.
    """

    def __init__(self, classes: Iterable[ClassInfo] = (), class_map: Mapping[str, str] | None = None) -> None:
        """Index the classes. `class_map` maps names of bodies, with or without their numbers, to classes."""
        self._classes = {c.name: c for c in classes}
        self._map = {_without_separators(name): class_ for name, class_ in (class_map or {}).items()}
        self._labels: dict[str, str] = {}
        self._synonyms: dict[str, str] = {}
        self._italian: set[str] = set()
        """The expressions that are only Italian."""
        self._shared: set[str] = set()
        """The English expressions that are also Italian, such as `tv`."""
        table = tomllib.loads((resources.files(__package__) / "body_words.toml").read_text("utf-8"))
        self._words = {kind: frozenset(words) for kind, words in table.items() if kind != "synonyms"}
        if not self._classes:
            return
        self._other_meanings = frozenset(map(fold, table["other_meanings"]))
        self._lexicon = lexicon.load("english")
        self._index(table["synonyms"])

    def _index(self, synonyms: Mapping[str, Any]) -> None:
        """Index the labels and synonyms: labels before synonyms, and English before Italian."""
        spatial = [c for c in self._classes.values() if c.spatial]
        for c in spatial:
            for text in (c.name, *(text for tag, text in c.labels.items() if tag != "it"), *c.also):
                self._labels.setdefault(fold(text), c.name)
        english = dict(self._lexicon.synonyms)
        for name, words in (*synonyms.items(), *describing.load("english").synonyms.items()):
            english.update(dict.fromkeys(words, name))
        for word, name in english.items():
            if name in self._classes and word not in self._words["ignored"]:
                self._synonyms.setdefault(fold(word), name)
        known = {*self._labels, *self._synonyms}
        italian = describing.load("italian").synonyms
        for c in spatial:
            label = c.labels.get("it", "")
            for word in (label, *italian.get(c.name, ())):
                if (key := fold(word)) in known:
                    self._shared.add(key)
                elif key and word not in self._words["ignored"]:
                    (self._labels if word == label else self._synonyms).setdefault(key, c.name)
                    self._italian.add(key)

    def find(self, name: str) -> Found:
        """Return the class of the body `name`, whether it is certain, and the words of the name."""
        stated = self._stated_class(name)
        if not self._classes:
            return Found(stated or class_from_name(name), is_sure=True, is_stated=stated is not None)
        items = self._items(self._split(name))
        head = self._head(items)
        if stated is not None:
            text = " ".join(item.text for item in items)
            label = "" if self._labels.get(fold(text)) == stated else text
            return Found(stated, is_sure=True, label=label, is_stated=True)
        if head is None:
            words = [item.text for item in items if item.kind != "joining"]
            label = " ".join(words) if any(len(word) > 2 for word in words) else ""
            return Found(UNSURE if UNSURE in self._classes else None, is_sure=False, label=label)
        class_ = "Toy" if any(item.class_ == "Toy" for item in items[:head]) else items[head].class_
        label = " ".join(item.text for item in self._order_for_label(items, head))
        return Found(class_, is_sure=True, label="" if self._labels.get(fold(label)) == class_ else label)

    def _order_for_label(self, items: Sequence[_Item], head: int) -> Sequence[_Item]:
        """Return the expressions of a label up to the head; colours and sizes after it come first."""
        if items[head].is_italian:
            return items
        after = [item for item in items[head + 1 :] if item.text in self._words["qualities"]]
        return [*after, *items[: head + 1]]

    def _stated_class(self, name: str) -> str | None:
        """Return the class of a body in the class map."""
        keys = (_without_separators(name), _without_separators(class_from_name(name) or ""))
        return next((self._map[key] for key in keys if key and key in self._map), None)

    def is_separate(self, name: str, found: Found, whole_name: str, whole: Found, *, moves: bool) -> bool:
        """Return whether a nested body is an entity, and not only a part of the body `whole` around it.

        It is one if its class is stated, or certain and not that of a part, as a door is of a cupboard but
        not of a house. A link of a robot is a part. So is a body with a name that begins with that of the
        whole, if it `moves` on its frame or has the same class. A door or drawer that moves on the frame of
        something unknown is also a part.
        """
        if found.is_stated:
            return True
        class_ = self._classes.get(found.class_ or "")
        if class_ is None or not found.is_sure or class_.place:
            return False
        if not {"robot", "link"}.isdisjoint(word.lower() for word in _WORD.findall(name)):
            return False
        around = self._classes.get(whole.class_ or "") if whole.is_sure else None
        if around is not None and not _OF_BUILDINGS.isdisjoint((around.name, *around.ancestors)):
            return True
        if (moves or found.class_ == whole.class_) and self._begins_with(name, whole_name):
            return False
        is_part = not self._words["parts"].isdisjoint((class_.name, *class_.ancestors))
        if around is None:
            return not (moves and is_part)
        return around.name != ROBOT and not is_part

    def is_variant(self, name: str, whole_name: str) -> bool:
        """Return whether a name is another one and a number, letter, colour or size: `cup_2`, `cup_red`."""
        rest = name.removeprefix(whole_name)
        words = [word.lower() for word in _WORD.findall(rest)]
        if rest == name or not words or rest[0].islower():
            return False
        return all(
            word.isdigit() or (word not in self._words["sides"] and self._is_quality(word)) for word in words
        )

    def _is_quality(self, word: str) -> bool:
        return len(word) == 1 or word in self._words["qualities"] or word in self._words["sides"]

    def is_place(self, found: Found) -> bool:
        """Return whether a body is a place, such as a kitchen with its furniture."""
        class_ = self._classes.get(found.class_ or "")
        return class_ is not None and class_.place

    def is_group(self, whole: Found, parts: Iterable[Found]) -> bool:
        """Return whether all nested entities have the class of the body around them, or a more special one.

        A place and a body with a stated class are never only a group.
        """
        if whole.is_stated or self.is_place(whole):
            return False
        return all(
            part.class_ == whole.class_
            or (whole.class_ is not None and whole.class_ in self._ancestors_of(part.class_))
            for part in parts
        )

    def _ancestors_of(self, class_: str | None) -> Collection[str]:
        known = self._classes.get(class_ or "")
        return known.ancestors if known else ()

    def _begins_with(self, name: str, whole: str) -> bool:
        """Return whether a name has the words of a whole first: `cabinet_1_tray`, `cabinet_1_main`."""
        words, its = ([word.lower() for word in _CHUNK.findall(text)] for text in (name, whole))
        while its and its[-1] in self._words["technical"]:
            del its[-1]
        return bool(its) and words[: len(its)] == its

    def _meaning(self, text: str) -> _Item | None:
        """Return the class that an expression names, or None if it names no class."""
        key = fold(text)
        class_ = self._labels.get(key) or self._synonyms.get(key)
        if class_ is None:
            return None
        return _Item(text, "room" if self._classes[class_].place else "class", class_, key in self._italian)

    def _split(self, name: str) -> list[str]:
        """Return the words of a name in lower case, without numbers and the endings of converters."""
        words = list(self._all_words(name))
        while words and words[-1] in self._words["technical"]:
            del words[-1]
        return words

    def _all_words(self, name: str) -> Iterator[str]:
        for number, chunk in enumerate(_CHUNK.findall(name)):
            parts = [part.lower() for part in _WORD.findall(chunk)]
            if number > 0 and _HASH.fullmatch(chunk) and not any(map(self._meaning, parts)):
                continue
            if any(len(part) == 1 for part in parts) and self._meaning(chunk):  # iPhone
                yield chunk.lower()
            else:
                yield from (part for part in parts if not part.isdigit())

    def _items(self, words: Sequence[str]) -> list[_Item]:
        """Return the expressions of a name in order, the longest that are known."""
        items: list[_Item] = []
        first = 0
        while first < len(words):
            for last in range(min(first + _LONGEST, len(words)), first, -1):
                if (item := self._item(words[first:last])) is not None:
                    break
            else:
                item, last = _Item(words[first], "unknown"), first + 1
            items.append(item)
            first = last
        return items

    def _item(self, words: Sequence[str]) -> _Item | None:
        """Return the meaning of an expression, or None if it is not known."""
        text, is_word = " ".join(words), len(words) == 1
        if fold(text) in self._other_meanings:
            return _Item(text, "unknown")
        singular = " ".join((*words[:-1], lemma(words[-1], self._lexicon)))
        found = self._meaning(text) or self._meaning(singular) or (self._compound(text) if is_word else None)
        is_quality = is_word and self._is_quality(text)
        if found is not None and not (is_quality and found.is_italian):
            return found._replace(text=text)
        if is_word and text in self._words["after_head"]:
            return _Item(text, "after head")
        if is_word and text in self._words["joining"]:
            return _Item(text, "joining")
        return _Item(text, "quality") if is_quality else None

    def _compound(self, word: str) -> _Item | None:
        """Return the meaning of a word made of two words of classes: `wineglass` is a glass."""
        halves = ((word[:at], word[at:]) for at in range(3, len(word) - 2))
        return next(
            (self._meaning(end) for start, end in halves if self._meaning(start) and self._meaning(end)), None
        )

    def _names_place(self, before: Iterable[_Item], head: _Item) -> bool:
        """Return whether a head is only where the things before it are: `outlet_counter`, `clock_wall`."""
        surfaces, mounted = self._words["surfaces"], self._words["mounted"]
        return any(
            item.text in mounted
            or (item.kind == "class" and head.class_ in surfaces and item.class_ not in surfaces)
            for item in before
            if not self._is_quality(item.text)
        )

    def _head(self, items: Sequence[_Item]) -> int | None:
        """Return the index of the expression that determines the class, or None if none does for certain."""
        kinds = [item.kind for item in items]
        if "joining" in kinds:
            return None
        if kinds == ["room"]:
            return 0
        end = kinds.index("after head") if "after head" in kinds else len(items)
        classes = [row for row in range(end) if kinds[row] == "class"]
        if not classes:
            return None
        is_first = items[classes[0]].is_italian and all(
            items[row].is_italian or fold(items[row].text) in self._shared for row in classes
        )
        head = classes[0] if is_first else classes[-1]
        if "unknown" in (kinds[:head] if is_first else kinds[head + 1 : end]):
            return None
        if not is_first and self._names_place(items[:head], items[head]):
            return None
        is_ambiguous = lemma(items[head].text, self._lexicon) in self._words["ambiguous"]
        others = {kind for row, kind in enumerate(kinds) if row != head}
        return None if is_ambiguous and others - {"quality", "room"} else head


def class_from_name(name: str) -> str | None:
    """Return a name without its number: `chair` for `chair_3`; None for digits only."""
    return re.sub(r"[\W_]*\d*$", "", name) or None


def _without_separators(name: str) -> str:
    return "".join(_CHUNK.findall(name)).casefold()
