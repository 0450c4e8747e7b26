"""What there is to be described, by what it is called: kept up to date entity by entity."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import islice
from typing import Final

from semmap.nodes.language.lexicon import describing
from semmap.nodes.language.lexicon.describing import LANGUAGES, TAGS, Describing, Language
from semmap.nodes.language.vocabulary import spoken

_PURPOSE: Final = ("da", "of", "di")
"""An Italian noun keeps its name before it says what it is for; before *of* comes what it is in both."""
_ARTICLES: Final = ("definite", "indefinite", "mine", "he")
_PLAIN: Final = re.compile(r"[^\W\d_]+(?:[ -][^\W\d_]+){0,3}")
MOST_WORDS: Final = 5
"""Of a noun."""


@dataclass(frozen=True, slots=True)
class Item:
    """An entity as one speaks of it. values: what its properties say, names of individuals, or booleans."""

    name: str
    class_name: str
    types: frozenset[str]
    references: tuple[str, ...]
    values: Mapping[str, frozenset[object]]
    is_place: bool = False

    @property
    def all_values(self) -> frozenset[object]:
        """Those of all of its properties."""
        return frozenset[object]().union(*self.values.values())


@dataclass(frozen=True, slots=True)
class Terms:
    """What a TBox has words for. Labels are of language tag, name and text; `""` is no language's.

    classes: of its classes; qualities: of the individuals that describe things (colours, materials);
    affordances: of those; affords: class to what its instances afford.
    """

    classes: tuple[tuple[str, str, str], ...]
    qualities: tuple[tuple[str, str, str], ...] = ()
    affordances: tuple[tuple[str, str, str], ...] = ()
    affords: Mapping[str, frozenset[str]] = field(default_factory=dict)


class Nouns:
    """The nouns of one language: classes and entities by what they are called."""

    def __init__(self, language: Language, terms: Terms) -> None:
        self.describing: Final[Describing] = describing.load(language)
        self.classes: Final[dict[str, set[str]]] = {}
        self.entities: Final[dict[str, dict[str, None]]] = {}
        self.whole: Final[dict[str, set[str]]] = {}
        """Classes by all of a label, not by its head alone."""
        self.exact: Final[dict[str, dict[str, None]]] = {}
        """Entities by all of a reference, or by name."""
        self.heads: Final[set[str]] = set()
        """Last words of what classes are called."""
        self.qualities: Final[dict[str, set[str]]] = {}
        self.actions: Final[dict[str, set[str]]] = {}
        self.words: Final[dict[str, int]] = {}
        """In base form; how many things of the map have it in what they are called."""
        self.forms: Final[dict[str, str]] = {}
        """Words in base form, as they are written."""
        tag, known = TAGS[language], {name for _, name, _ in terms.classes}
        # A noun of a language that nothing else is known of stands in the grammar of the first.
        others = {*TAGS.values()} - {tag} if language == LANGUAGES[0] else None
        labels = [(name, text) for said, name, text in terms.classes if _serves(said, tag, others)]
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
                if key not in whole:  # else the taxonomy says what is a table
                    self.classes.setdefault(key, set()).add(name)
        for said, name, text in terms.qualities:
            if _serves(said, tag, others):
                for word in (text, *self.describing.qualities.get(spoken(text), ())):
                    for key in self.keys(word):
                        self.qualities.setdefault(key, set()).add(name)
        for said, name, text in terms.affordances:
            if _serves(said, tag, others):
                self.actions.setdefault(_action(text), set()).add(name)
        self.verbs: Final = frozenset(action.partition(" ")[0] for action in self.actions)
        for key in (*self.classes, *self.qualities):
            for word in key.split():
                self.words.setdefault(word, 0)

    def keys(self, text: str) -> Iterator[str]:
        """What a thing of that label may be called: by the whole, or by its head alone."""
        words = self.describing.split(spoken(text))
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

    def put(self, item: Item) -> None:
        """Index what an entity is called."""
        for is_exact, key in self._said(item):
            self.entities.setdefault(key, {})[item.name] = None
            if is_exact:
                self.exact.setdefault(key, {})[item.name] = None
            for word in key.split():
                self.words[word] = self.words.get(word, 0) + 1

    def take(self, item: Item) -> None:
        """The entity is gone, or is called something else."""
        for _, key in self._said(item):
            for index in (self.entities, self.exact):
                if (there := index.get(key)) is not None:
                    there.pop(item.name, None)
                    if not there:
                        del index[key]

    def _said(self, item: Item) -> Iterator[tuple[bool, str]]:
        """What an entity is called: whether by all of a reference or its name, and the key.

        The head alone of a name is nothing that it is called by: coffee_table1 is no table1.
        """
        for text in set(item.references):
            for i, key in enumerate(self.keys(text)):
                yield i == 0, key
        yield from ((True, key) for key in islice(self.keys(item.name), 1))

    def is_plain(self, reference: str) -> bool:
        """Whether a reference looks like a noun phrase, so that it may be repeated in a sentence."""
        if not _PLAIN.fullmatch(reference):
            return False
        words = self.describing.split(reference)
        first = self.describing.sense((words[0],))
        return not any(kind in first for kind in _ARTICLES) and (
            len(words) == 1 or self.describing.base(words[-1]) in self.heads
        )

    def is_noun(self, key: str) -> bool:
        """Whether anything may be called so."""
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

    def update(self, changed: Iterable[Item], removed: Iterable[str] = ()) -> None:
        """Some entities came or are otherwise now, others went."""
        for name in removed:
            self._take(name)
        for item in changed:
            self._take(item.name)
            self.items[item.name] = item
            for name in item.types:
                self.members.setdefault(name, {})[item.name] = None
            for nouns in self.nouns.values():
                nouns.put(item)

    def _take(self, name: str) -> None:
        if (item := self.items.pop(name, None)) is None:
            return
        for class_name in item.types:
            self.members[class_name].pop(name, None)
        for nouns in self.nouns.values():
            nouns.take(item)

    def called(self, key: str, language: Language) -> dict[str, None]:
        """The entities that a noun, in base form, may mean; in no order that means anything."""
        nouns = self.nouns[language]
        found = dict(nouns.entities.get(key, {}))
        for class_name in nouns.classes.get(key, ()):
            found.update(self.members.get(class_name, {}))
        return found

    def is_called(self, name: str, key: str, language: Language) -> bool:
        """Whether it is its name, all of a reference, or its own class: a desk is called no table."""
        nouns = self.nouns[language]
        return name in nouns.exact.get(key, ()) or self.items[name].class_name in nouns.whole.get(key, ())

    def spoken(self, item: Item, language: Language) -> str:
        """What an entity is called in a language: by a reference, or by its class's label.

        References are taken for English; of those that are not, the label says in which language. What
        does not look like a noun is never repeated.
        """
        nouns = self.nouns[language]
        for reference in filter(nouns.is_plain, item.references):
            key = nouns.describing.key(nouns.describing.split(reference))
            if language == "english" or reference[:1].isupper() or key in nouns.classes:
                return reference
        return self.label(item.class_name, language)

    def label(self, class_name: str, language: Language) -> str:
        """What a class is called."""
        return self._labels.get((TAGS[language], class_name), spoken(class_name))

    def affords(self, item: Item) -> frozenset[object]:
        """What can be done with an entity, by its classes and by what is said of it."""
        own = item.values.get("hasAffordance", frozenset())
        return own.union(*(self.terms.affords.get(name, frozenset()) for name in item.types))


def _serves(said: str, tag: str, others: set[str] | None) -> bool:
    """Whether a label of that language tag is read in a grammar: its own, or any but those of others."""
    return said in (tag, "") or (others is not None and said not in others)


def _action(label: str) -> str:
    """What is done, without *it*: `drinking it` is `drinking`, `drinking from it` is `drinking from`."""
    return " ".join(word for word in spoken(label).split() if word != "it")
