"""An index of the map's entities and the TBox's classes by their labels, updated entity by entity."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import islice
from typing import Final

from semmap.nodes.language.lexicon import describing
from semmap.nodes.language.lexicon.describing import LANGUAGES, TAGS, Describing, Language
from semmap.nodes.language.reference_resolution.part_index import PartIndex
from semmap.nodes.language.vocabulary import to_words

_PURPOSE: Final = ("da", "of", "di")
"""The head of a compound precedes these words (Italian *da*, and *of* or *di* in both languages)."""
_ARTICLES: Final = ("definite", "indefinite", "mine", "he")
_PLAIN: Final = re.compile(r"[^\W\d_]+(?:[ -][^\W\d_]+){0,3}")
MOST_WORDS: Final = 5
"""The maximum length of a noun."""


@dataclass(frozen=True, slots=True)
class Item:
    """An entity with its labels; `values` are its properties' values: individuals' names or literals."""

    name: str
    class_name: str
    types: frozenset[str]
    references: tuple[str, ...]
    values: Mapping[str, frozenset[object]]
    is_place: bool = False

    @property
    def all_values(self) -> frozenset[object]:
        """The values of all properties."""
        return frozenset[object]().union(*self.values.values())

    def number(self, property_name: str) -> float | None:
        """Return the number among the values of a property, or None."""
        for value in self.values.get(property_name, ()):
            if isinstance(value, int | float | str) and not isinstance(value, bool):
                with suppress(ValueError):
                    return float(value)
        return None


@dataclass(frozen=True, slots=True)
class Terms:
    """The labels of a TBox as (language tag, name, text); the tag `""` stands for no language.

    They are the labels of `classes`, of `qualities` (individuals such as colours and materials) and of
    `affordances`. `affords` maps a class to the affordances of its instances.
    """

    classes: tuple[tuple[str, str, str], ...]
    qualities: tuple[tuple[str, str, str], ...] = ()
    affordances: tuple[tuple[str, str, str], ...] = ()
    affords: Mapping[str, frozenset[str]] = field(default_factory=dict)


class Nouns:
    """The nouns of one language: classes and entities by their labels."""

    def __init__(self, language: Language, terms: Terms) -> None:
        self.describing: Final[Describing] = describing.load(language)
        self.classes: Final[dict[str, set[str]]] = {}
        self.entities: Final[dict[str, dict[str, None]]] = {}
        self.whole: Final[dict[str, set[str]]] = {}
        """Classes by the whole label, not only by its head."""
        self.exact: Final[dict[str, dict[str, None]]] = {}
        """Entities by a whole label, or by name."""
        self.heads: Final[set[str]] = set()
        """The last words of class labels."""
        self.qualities: Final[dict[str, set[str]]] = {}
        self.actions: Final[dict[str, set[str]]] = {}
        self.words: Final[dict[str, int]] = {}
        """Words in base form, with the number of entities whose labels contain them."""
        self.forms: Final[dict[str, str]] = {}
        """Words in base form to their written form."""
        tag, known = TAGS[language], {name for _, name, _ in terms.classes}
        # Labels in languages without a lexicon are used as nouns of the first language.
        others = {*TAGS.values()} - {tag} if language == LANGUAGES[0] else None
        labels = [(name, text) for own, name, text in terms.classes if _serves(own, tag, others)]
        synonyms = [(name, word) for name, words in self.describing.synonyms.items() for word in words]
        named = [(name, tuple(self.keys(text))) for name, text in (*labels, *synonyms) if name in known]
        for name, keys in named:
            for key in keys[:1]:
                self.classes.setdefault(key, set()).add(name)
                self.whole.setdefault(key, set()).add(name)
            self.heads.update(key.rpartition(" ")[2] for key in keys)
        whole = frozenset(self.classes)
        for name, keys in named:
            for key in keys[1:]:
                if key not in whole:  # otherwise the taxonomy decides
                    self.classes.setdefault(key, set()).add(name)
        for own, name, text in terms.qualities:
            if _serves(own, tag, others):
                for word in (text, *self.describing.qualities.get(to_words(text), ())):
                    for key in self.keys(word):
                        self.qualities.setdefault(key, set()).add(name)
        for own, name, text in terms.affordances:
            if _serves(own, tag, others):
                self.actions.setdefault(_action(text), set()).add(name)
        self.verbs: Final = frozenset(action.partition(" ")[0] for action in self.actions)
        for key in (*self.classes, *self.qualities):
            for word in key.split():
                self.words.setdefault(word, 0)

    def keys(self, text: str) -> Iterator[str]:
        """Yield the keys for a label: the whole label, then its head alone."""
        words = self.describing.split(to_words(text))
        while len(words) > 1 and any(kind in self.describing.sense((words[0],)) for kind in _ARTICLES):
            words = words[1:]
        if not words:
            return
        for word in words:
            self.forms.setdefault(self.describing.base(word), word)
        yield self.describing.key(words)
        head = next((words[:i] for i, word in enumerate(words) if i and word in _PURPOSE), None)
        if head is None and self.describing.head_is_last:
            head = words[-1:]
        if head is not None and head != words:
            yield self.describing.key(head)

    def add(self, item: Item) -> None:
        """Add an entity's labels to the index."""
        for is_exact, key in self._keys_of(item):
            self.entities.setdefault(key, {})[item.name] = None
            if is_exact:
                self.exact.setdefault(key, {})[item.name] = None
            for word in key.split():
                self.words[word] = self.words.get(word, 0) + 1

    def remove(self, item: Item) -> None:
        """Remove an entity's labels from the index."""
        for _, key in self._keys_of(item):
            for index in (self.entities, self.exact):
                if (there := index.get(key)) is not None:
                    there.pop(item.name, None)
                    if not there:
                        del index[key]

    def _keys_of(self, item: Item) -> Iterator[tuple[bool, str]]:
        """Yield the keys of an entity, each with whether it stands for a whole label or the name.

        The head of a name alone is not a key: coffee_table1 is not table1.
        """
        for text in set(item.references):
            for i, key in enumerate(self.keys(text)):
                yield i == 0, key
        yield from ((True, key) for key in islice(self.keys(item.name), 1))

    def is_plain(self, reference: str) -> bool:
        """Return whether a label looks like a noun phrase, so that a sentence can contain it."""
        if not _PLAIN.fullmatch(reference):
            return False
        words = self.describing.split(reference)
        first = self.describing.sense((words[0],))
        return not any(kind in first for kind in _ARTICLES) and (
            len(words) == 1 or self.describing.base(words[-1]) in self.heads
        )

    def is_noun(self, key: str) -> bool:
        """Return whether a class or an entity has this key."""
        return key in self.classes or key in self.entities


class MapIndex:
    """The entities of a map and the terms of its TBox."""

    def __init__(self, terms: Terms) -> None:
        self.terms: Final = terms
        labels = (*terms.classes, *terms.qualities)
        self._labels: Final = {(tag, name): text for tag, name, text in reversed(labels)}
        self.items: Final[dict[str, Item]] = {}
        self.members: Final[dict[str, dict[str, None]]] = {}
        self.nouns: Final[dict[Language, Nouns]] = {name: Nouns(name, terms) for name in LANGUAGES}
        self.parts: Final = PartIndex()

    def update(self, changed: Iterable[Item], removed: Iterable[str] = ()) -> None:
        """Add or replace the `changed` entities and remove those named in `removed`."""
        for name in removed:
            self._remove(name)
        for item in changed:
            self._remove(item.name)
            self.items[item.name] = item
            for name in item.types:
                self.members.setdefault(name, {})[item.name] = None
            self.parts.add(item.name, item.values)
            for nouns in self.nouns.values():
                nouns.add(item)

    def _remove(self, name: str) -> None:
        if (item := self.items.pop(name, None)) is None:
            return
        for class_name in item.types:
            self.members[class_name].pop(name, None)
        self.parts.remove(name)
        for nouns in self.nouns.values():
            nouns.remove(item)

    def find_by_noun(self, key: str, language: Language) -> dict[str, None]:
        """Return the entities that a noun in base form may denote, in arbitrary order."""
        nouns = self.nouns[language]
        found = dict(nouns.entities.get(key, {}))
        for class_name in nouns.classes.get(key, ()):
            found.update(self.members.get(class_name, {}))
        return found

    def several_of(self, key: str, language: Language, least: int = 1) -> str:
        """Return the singular of a noun (glasses) if it denotes `least` entities and the plural none."""
        one = self.nouns[language].describing.singular_of(key)
        is_one = not self.find_by_noun(key, language) and len(self.find_by_noun(one, language)) >= least
        return one if is_one else key

    def is_exact_match(self, name: str, key: str, language: Language) -> bool:
        """Return whether the key is the entity's name, a whole label or its own class (not a superclass)."""
        nouns = self.nouns[language]
        return name in nouns.exact.get(key, ()) or self.items[name].class_name in nouns.whole.get(key, ())

    def noun_for(self, item: Item, language: Language) -> str:
        """Return a noun for an entity in a language: one of its labels, or its class's label.

        Labels are assumed to be English unless the TBox has them in another language. Labels that do not
        look like a noun are not used.
        """
        nouns = self.nouns[language]
        for reference in filter(nouns.is_plain, item.references):
            key = nouns.describing.key(nouns.describing.split(reference))
            if language == "english" or reference[:1].isupper() or key in nouns.classes:
                return reference
        return self.label(item.class_name, language)

    def label(self, class_name: str, language: Language) -> str:
        """Return the label of a class in a language."""
        return self._labels.get((TAGS[language], class_name), to_words(class_name))

    def affords(self, item: Item) -> frozenset[object]:
        """Return the affordances of an entity: asserted ones and those of its classes."""
        own = item.values.get("hasAffordance", frozenset())
        return own.union(*(self.terms.affords.get(name, frozenset()) for name in item.types))


def _serves(own: str, tag: str, others: set[str] | None) -> bool:
    """Return whether labels with the tag `own` are nouns of the language `tag`."""
    return own in (tag, "") or (others is not None and own not in others)


def _action(label: str) -> str:
    """Return an affordance's label without *it*: `drinking from it` becomes `drinking from`."""
    return " ".join(word for word in to_words(label).split() if word != "it")
