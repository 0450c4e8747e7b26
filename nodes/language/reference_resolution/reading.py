"""Lexical analysis: the words of a text with their possible senses, and spelling correction."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from rapidfuzz import process
from rapidfuzz.distance import OSA

from semmap.nodes.language.lexicon import describing
from semmap.nodes.language.lexicon.describing import LANGUAGES
from semmap.nodes.language.reference_resolution.map_index import MOST_WORDS, Nouns

_UNKNOWN: Final = 3.0
"""The cost of an unknown word; a corrected one costs less."""
_VOICED: Final = {
    "wh": "w",
    "ph": "f",
    "ck": "k",
    "ea": "e",
    "ee": "i",
    "kn": "n",
    "wr": "r",
    "gh": "g",
    "ch": "k",
}


@dataclass(frozen=True, slots=True)
class Reading:
    """The words of a text in one language; `senses` maps kinds of words to length and value per position."""

    nouns: Nouns
    words: tuple[str, ...]
    senses: tuple[Mapping[str, tuple[int, Any]], ...]
    corrections: tuple[tuple[str, str], ...]  # pairs of a word and its correction
    cost: float  # lower means that this language is more likely


def read(text: str, nouns: Nouns) -> Reading:
    """Read a text as words of one language, without corrections."""
    words = nouns.describing.split(text)
    senses = _senses(words, nouns)
    unknown = _unknown(words, senses)
    return Reading(nouns, tuple(words), senses, (), _UNKNOWN * len(unknown))


def correct_spelling(reading: Reading) -> Reading:
    """Return the reading with each unknown word replaced by a similar known one, if there is one."""
    words, taken_for, cost = list(reading.words), dict[str, str](), 0.0
    for i in _unknown(words, reading.senses):
        better = nearest(words[i], reading.nouns)
        cost += _UNKNOWN if better is None else 1.0
        if better is not None:
            taken_for[words[i]] = words[i] = better
    for i in _unknown(words, _senses(words, reading.nouns)) if taken_for else ():
        if taken_for.pop(reading.words[i], None) is not None:  # a part of a longer name only
            words[i] = reading.words[i]
            cost += _UNKNOWN - 1.0
    if not taken_for:
        return reading
    pairs = tuple(taken_for.items())
    return Reading(reading.nouns, tuple(words), _senses(words, reading.nouns), pairs, cost)


def _unknown(words: Sequence[str], senses: Sequence[Mapping[str, tuple[int, Any]]]) -> list[int]:
    """Return the indices of the words that are in no known expression."""
    known = [word.isdigit() for word in words]
    for i, here in enumerate(senses):
        for length, _ in here.values():
            known[i : i + length] = [True] * length
    return [i for i, is_known in enumerate(known) if not is_known]


def _senses(words: list[str], nouns: Nouns) -> tuple[Mapping[str, tuple[int, Any]], ...]:
    language, bases = nouns.describing, [nouns.describing.base(word) for word in words]
    found: list[dict[str, tuple[int, Any]]] = []
    for i in range(len(words)):
        senses: dict[str, tuple[int, Any]] = {}
        left = len(words) - i
        lengths = list(range(1, min(max(language.longest, MOST_WORDS), left) + 1))
        if left > MOST_WORDS and " ".join(bases[i:]) in nouns.exact:
            lengths.append(left)  # a reference may be longer than a noun
        for length in lengths:
            for kind, value in language.sense(tuple(words[i : i + length])).items():
                senses[kind] = (length, value)
            key = " ".join(bases[i : i + length])
            if key in nouns.qualities:
                senses["quality"] = (length, frozenset(nouns.qualities[key]))
            if length == 1 and _affords(found, i) and any(form in nouns.verbs for form in forms(words[i])):
                senses["action"] = (1, None)
            is_apart = length > 1 and not any(
                (words[j],) in language.senses or bases[j] in nouns.qualities for j in range(i, i + length)
            )
            for form in (key, "".join(bases[i : i + length])) if is_apart else (key,):
                if senses.get("anything", (0,))[0] == length:
                    break  # "thing" does not stand for a place
                if (length <= MOST_WORDS or length == left) and nouns.is_noun(form):
                    senses["noun"] = (length, form)
                    senses[f"noun{length}"] = (length, form)
                    break
        if words[i].isdecimal() and len(words[i]) < 4:
            senses["numbers"] = (1, int(words[i]))
        elif bases[i] in nouns.exact and not any(nouns.is_noun(key) for key in bases[i + 1 : i + 2]):
            senses.pop("numbers", None)  # Otto is a name, but eight in "otto tazze"
        found.append(senses)
    return tuple(found)


def nearest(word: str, nouns: Nouns) -> str | None:
    """Return the known word nearest to an unknown one: one or two letters off, or similar in sound.

    Words in the labels of entities take precedence over those of the TBox alone.
    """
    if len(word) < 3 or not word.isalpha() or any(describing.load(name).has(word) for name in LANGUAGES):
        return None
    base, sound = nouns.describing.base(word), _sound(word)
    most = 1 if len(word) < 7 else 2
    best: tuple[float, int, str] | None = None
    for known, off, _ in process.extract(
        base, nouns.words.keys(), scorer=OSA.distance, score_cutoff=most, limit=None
    ):
        if len(known) < 3 or (len(base) < 4 and _sound(known) != sound):
            continue
        if len(known) < 5 and off and known[0] != base[0] and _sound(known) != sound:
            continue
        found = (off - 0.5 * (_sound(known) == sound), -min(nouns.words[known], 1), known)
        best = found if best is None else min(best, found)
    return None if best is None else _as_many(word, nouns.forms[best[2]], nouns)


def _as_many(word: str, known: str, nouns: Nouns) -> str:
    """Return the known word, in the plural if the misspelt one is plural (bottels, bottles)."""
    is_plural = nouns.describing.head_is_last and word.endswith("s") and nouns.describing.base(word) != word
    return f"{known}s" if is_plural else known


def _affords(senses: Sequence[Mapping[str, tuple[int, Any]]], i: int) -> bool:
    """Return whether the words before `i` introduce an action: to, for, da."""
    return any("afford" in before and j + before["afford"][0] == i for j, before in enumerate(senses))


def forms(verb: str) -> Iterator[str]:
    """Yield the forms of a verb in the label of an affordance: itself, or with *-ing*."""
    yield verb
    yield f"{verb}ing"
    yield f"{verb[:-1]}ing"
    yield f"{verb}{verb[-1]}ing"


def _sound(word: str) -> str:
    for written, voiced in _VOICED.items():
        word = word.replace(written, voiced)
    return word
