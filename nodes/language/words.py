"""Tokenisation, base forms and part-of-speech tagging by a lexicon and neighbouring words."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

from semmap.nodes.language.lexicon import Lexicon

PartOfSpeech = Literal[
    "noun",
    "verb",
    "aux",
    "modal",
    "det",
    "pron",
    "rel",
    "prep",
    "conj",
    "adj",
    "adv",
    "num",
    "neg",
    "particle",
]

_WORD: Final = re.compile(r"n't\b|'\w+|\d+(?:[.,]\d+)?|[^\W\d_]+(?:-[^\W_]+)*(?=n't\b)|[^\W_]+(?:-[^\W_]+)*")
_NOT_SAID: Final = re.compile(r"</?[a-zA-Z!][^<>]*>|\x1b\[[0-9;]*[A-Za-z]")
_ACTED_ON: Final = ("it", "them")
_OPENS_CLAUSE: Final = ("conj", "modal", "adv", "neg")


@dataclass(frozen=True, slots=True)
class Word:
    """A word of a sentence: its text, base form and part of speech."""

    text: str
    lemma: str
    kind: PartOfSpeech


def split(text: str) -> list[str]:
    """Return a text's words in lower case, without punctuation; `it's` and `don't` are two words each."""
    return _WORD.findall(plain(text))


def plain(text: str) -> str:
    """Return a text in lower case, without markup and control sequences, with uniform apostrophes."""
    return without_markup(text).lower().replace("’", "'")


def without_markup(text: str) -> str:
    """Return a text with spaces instead of markup and control sequences."""
    return _NOT_SAID.sub(" ", text)


def lemma(word: str, lexicon: Lexicon) -> str:
    """Return the base form: irregular words by the lexicon, plurals by their ending."""
    if word in lexicon.irregular:
        return lexicon.irregular[word]
    if len(word) > 3 and word.endswith("ies"):
        return word[:-3] + "y"
    if len(word) > 4 and word.endswith(("ches", "shes", "sses", "xes", "zes", "oes")):
        return word[:-2]
    if len(word) > 3 and word.endswith("s") and not word.endswith(("ss", "us", "is")):
        return word[:-1]
    return word


def to_base_forms(text: str, lexicon: Lexicon) -> str:
    """Return a text with each word in its base form."""
    return " ".join(lemma(word, lexicon) for word in text.split())


def tag(texts: Sequence[str], lexicon: Lexicon, kinds: Sequence[PartOfSpeech | None] = ()) -> list[Word]:
    """Return the words with their base forms and parts of speech.

    `texts` are lower-case words in order. `kinds` are the known parts of speech, None for unknown ones.
    """
    tagged: list[Word] = []
    for i, text in enumerate(texts):
        kind = (kinds[i] if kinds else None) or _kind(texts, i, tagged, lexicon)
        base = _verb(text, lexicon) if kind == "verb" else lemma(text, lexicon)
        tagged.append(Word(text, base or text, kind))
    return tagged


def is_verb(text: str, lexicon: Lexicon) -> bool:
    """Return whether a word can be a form of a verb of the lexicon."""
    return bool(_verb(text, lexicon))


def _verb(text: str, lexicon: Lexicon) -> str:
    """Return the base form of a verb of the lexicon, or "" for any other word."""
    forms = [text, lexicon.irregular.get(text, "")]
    for ending in ("ing", "ed"):
        if text.endswith(ending) and len(text) > len(ending) + 2:
            stem = text[: -len(ending)]
            forms += [stem, stem + "e", stem[:-1] if stem[-1] == stem[-2] else stem]
    return next((form for form in forms if form in lexicon.frames), "")


def _kind(texts: Sequence[str], i: int, before: Sequence[Word], lexicon: Lexicon) -> PartOfSpeech:
    """Return the part of speech of the word at i, given the tagged words before it."""
    text, is_a = texts[i], lexicon.is_a
    previous = before[-1] if before else None
    following = texts[i + 1] if i + 1 < len(texts) else ""
    in_nominal = previous is not None and previous.kind in ("det", "adj", "num")
    if is_a(text, "auxiliary"):
        return "aux"
    if is_a(text, "negation"):
        return "neg"
    if is_a(text, "relative") and (
        not is_a(text, "determiner")
        or not following
        or is_a(following, "auxiliary")
        or is_a(following, "modal")
    ):
        return "rel"
    if is_a(text, "determiner"):
        return "det"
    if not in_nominal:
        if is_a(text, "pronoun"):
            return "pron"
        if is_a(text, "modal"):
            return "modal"
    if is_a(text, "conjunction"):
        return "conj"
    if is_a(text, "number") or text[:1].isdigit():
        return "num"
    if not in_nominal and _begins_as_verb(text, previous, following, lexicon):
        return "verb"
    if _is_particle(text, following, before, lexicon):
        return "particle"
    if is_a(text, "preposition"):
        return "prep"
    if in_nominal and is_a(text, "adjective"):
        ends = not following or any(
            is_a(following, name) for name in ("preposition", "conjunction", "auxiliary")
        )
        return "noun" if ends else "adj"
    if is_a(text, "adverb"):
        return "adv"
    if is_a(text, "adjective") or lexicon.is_manner(text):
        return "adj"
    return "noun"


def _begins_as_verb(text: str, previous: Word | None, following: str, lexicon: Lexicon) -> bool:
    """Return whether the word is in the position of a verb: at the start of a clause, or not after a noun."""
    opens = previous is None or previous.kind in _OPENS_CLAUSE or lexicon.is_a(previous.text, "clause_opener")
    base = _verb(text, lexicon)
    if not base:  # an unknown verb
        if opens and lexicon.is_a(text, "untaught"):
            return True
        known = any(lexicon.is_a(text, name) for name in ("preposition", "adverb", "adjective", "robot"))
        return opens and not known and (lexicon.is_a(following, "determiner") or following in _ACTED_ON)
    if previous is not None and previous.kind == "verb":
        return lexicon.is_a(base, "always_verb")
    nominal = previous is not None and previous.kind in ("noun", "prep")
    if lexicon.is_a(text, "adjective") and lexicon.is_a(following, "determiner"):
        return True  # "go to the kitchen, open the fridge"
    return opens or not nominal or lexicon.is_a(base, "always_verb")


def _is_particle(text: str, following: str, before: Sequence[Word], lexicon: Lexicon) -> bool:
    """Return whether the word belongs to the verb (turn on the light, turn it off) and opens no phrase."""
    if not lexicon.is_a(text, "particle"):
        return False
    verb = next((word for word in reversed(before) if word.kind == "verb"), None)
    if verb is not None and f"{verb.lemma} {text}" in lexicon.frames and before[-1].kind in ("verb", "pron"):
        return True
    ends = not following or lexicon.is_a(following, "conjunction") or following in ("please", "robot")
    return lexicon.is_a(text, "state") and ends
