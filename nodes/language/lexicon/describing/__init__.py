"""The lexicon for descriptions: closed word classes, orders, states, relations, synonyms and wording."""

from __future__ import annotations

import functools
import re
import tomllib
import unicodedata
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from importlib import resources
from typing import Any, Final, Literal

from semmap.nodes.language import lexicon
from semmap.nodes.language.words import lemma
from semmap.schemas.relations import RELATIONS

Language = Literal["english", "italian"]
LANGUAGES: Final[tuple[Language, ...]] = ("english", "italian")
TAGS: Final[dict[Language, str]] = {"english": "en", "italian": "it"}
"""The languages' tags in the labels of a TBox."""

_TOKENS: Final[dict[Language, re.Pattern[str]]] = {
    "english": re.compile(r"n't\b|'s?\b|'|[^\W_]+?(?=n't\b)|[^\W_]+"),
    "italian": re.compile(r"[^\W_]+'|[^\W_]+"),
}
_QUOTED: Final = re.compile(r"(?<!\w)'([^']*)'(?!\w)")
_TYPED: Final = re.compile(r"e'(?!\w)")
"""An apostrophe typed instead of an accent: c'e', cos'e'."""
_INFLECTED: Final = ("states", "sizes", "sides", "ordinals")
_Words = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Describing:
    """The words of a language that describe objects."""

    language: Language
    head_is_last: bool
    senses: Mapping[_Words, Mapping[str, Any]]  # words as written -> kind of word -> value
    stems: Mapping[_Words, Mapping[str, Any]]  # the same for inflected words, in base form
    longest: int  # the number of words of the longest entry
    qualities: Mapping[str, tuple[str, ...]]  # label -> other words
    synonyms: Mapping[str, tuple[str, ...]]  # class -> other words
    pluralia: frozenset[str]
    collectives: frozenset[str]
    content: frozenset[str]
    wording: Mapping[str, str]
    lemmas: Mapping[str, str]
    articles: Mapping[str, str]  # regular expression for nouns -> definite article
    those: Mapping[str, str]  # regular expression for nouns -> pronoun: the one, quello, quella
    feminine: str  # regular expression for feminine nouns
    contractions: Mapping[str, str]  # preposition and article -> contracted form
    never_corrected: frozenset[str]  # words that the spelling correction leaves unchanged

    def split(self, text: str) -> list[str]:
        """Return a text's words in lower case, without punctuation; hyphens and elisions separate words."""
        text = _QUOTED.sub(r"\1", _plain(text))
        if self.language == "italian":
            text = _TYPED.sub("è", text)
        return _TOKENS[self.language].findall(text)

    def base(self, word: str) -> str:
        """Return a word without the ending for number and gender."""
        if word in self.pluralia:
            return word
        word = self.lemmas.get(word, word)
        return _stem(word) if self.language == "italian" else lemma(word, lexicon.load())

    def singular_of(self, key: str) -> str:
        """Return the singular of an English plurale tantum that also is a plural: glasses, a glass."""
        return lemma(key, lexicon.load()) if key in self.pluralia and self.language == "english" else key

    def key(self, words: Iterator[str] | list[str] | _Words) -> str:
        """Return the key for looking up a noun: its words in base form."""
        return " ".join([self.base(word) for word in words])

    def with_article(self, noun: str) -> str:
        """Return a noun with its definite article; proper names have none."""
        if noun[:1].isupper():
            return noun
        return next(article for form, article in self.articles.items() if re.search(form, noun)) + noun

    def pronoun_for(self, noun: str) -> str:
        """Return the pronoun for a noun: the one, quello, quella."""
        return next(pronoun for form, pronoun in self.those.items() if re.search(form, noun))

    def inflect(self, adjective: str, noun: str) -> str:
        """Return an adjective in agreement with a noun."""
        is_feminine = adjective.endswith("o") and re.search(self.feminine, noun) is not None
        return adjective[:-1] + "a" if is_feminine else adjective

    def contract(self, text: str) -> str:
        """Return a text with contractions: sul tavolo for su il tavolo."""
        for apart, together in self.contractions.items():
            text = text.replace(apart, together)
        return text

    def contract_last(self, phrase: str) -> Iterator[str]:
        """Yield a phrase with each contraction of its last word and an article: accanto al, accanto alla."""
        for apart, together in self.contractions.items():
            preposition = apart[: apart.index(" ", 1)]
            if f" {phrase}".endswith(preposition):
                yield f" {phrase}".removesuffix(preposition).lstrip() + together.rstrip()

    def has(self, word: str) -> bool:
        """Return whether a word form is in the lexicon."""
        return (word,) in self.senses or word in self.never_corrected

    def sense(self, words: _Words) -> Mapping[str, Any]:
        """Return the senses of an expression: kind of word to value."""
        exact = self.senses.get(words, {})
        return {**self.stems.get(tuple(map(self.base, words)), {}), **exact}


_APOSTROPHES: Final = str.maketrans({"’": "'", "‘": "'", "`": "'"})


def _plain(text: str) -> str:
    return unicodedata.normalize("NFC", text).lower().translate(_APOSTROPHES)


def _stem(word: str) -> str:
    """Return an Italian word without its last vowel: tazza and tazze, bianco and bianche."""
    if len(word) <= 3 or word[-1] not in "aeio":
        return word
    stem = word[:-1]
    return stem[:-1] if stem[-1] in "ih" and len(stem) > 3 else stem


@functools.cache
def load(language: Language) -> Describing:
    """Return the lexicon of a language."""
    table = tomllib.loads((resources.files(__package__) / f"{language}.toml").read_text("utf-8"))
    made = Describing(
        language=language,
        head_is_last=table["reading_order"] == "modifiers first",
        senses={},
        stems={},
        longest=0,
        qualities={label: tuple(words) for label, words in table["qualities"].items()},
        synonyms={name: tuple(words) for name, words in table["synonyms"].items()},
        pluralia=frozenset(table["pluralia"]["words"]),
        collectives=frozenset(table["collectives"]["words"]),
        content=frozenset(),
        wording=table["wording"],
        lemmas=table["lemmas"],
        articles=table["articles"],
        those=table["that"],
        feminine=table["feminine"]["nouns"],
        contractions=table["contractions"],
        never_corrected=frozenset(table["words"]["unmended"]),
    )
    senses: dict[_Words, dict[str, Any]] = {}
    stems: dict[_Words, dict[str, Any]] = {}
    relations = {row.name: _list_phrases(made, getattr(row, language)) for row in RELATIONS}
    for text, kind, value in _entries(table | {"relations": relations | table["relations"]}):
        words = tuple(made.split(text))
        senses.setdefault(words, {})[kind] = value
        if kind in _INFLECTED:
            stems.setdefault(tuple(map(made.base, words)), {}).setdefault(kind, value)
    return replace(
        made,
        senses=senses,
        stems=stems,
        longest=max(map(len, senses)),
        content=frozenset(map(made.base, table["words"]["content"])),
    )


def _list_phrases(words: Describing, phrases: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(text for phrase in phrases for text in (phrase, *words.contract_last(phrase)))


def _entries(table: Mapping[str, Any]) -> Iterator[tuple[str, str, Any]]:
    for kind, words in table["words"].items():
        if kind not in ("content", "unmended"):
            yield from ((text, kind, True) for text in words)
    for kind in ("ordinals", "numbers", "bounds", "places", "sides", "sizes", "states"):
        yield from ((text, kind, value) for text, value in table[kind].items())
    for relation, phrases in table["relations"].items():
        yield from ((text, "relations", relation) for text in phrases)
