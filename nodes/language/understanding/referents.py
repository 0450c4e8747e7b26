"""Resolves an argument to entities, by its noun phrase together with all modifiers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence, Set
from typing import Final

from semmap.nodes.language.understanding import grounding
from semmap.nodes.language.understanding.grounding import Thing, Things
from semmap.nodes.language.understanding.sentence import Sentence

Resolve = Callable[[str], tuple[str, ...]]
"""Returns the names of the entities that match a description, or none."""
Original = Callable[[int, int], str]
"""Returns the original words from one index to another."""

_NOT_DESCRIBED: Final = ("robot", "speaker", "direction", "measure")
_FROM: Final = ("from", "off", "out of", "off of")
_WHERE_IT_IS: Final = ("on", "in")
"""The relations of an object to the place that it is taken from."""
ANYTHING: Final = ("something", "anything")
_NOT_LOOKED_UP: Final = (*_NOT_DESCRIBED, "pronoun")
_NO_QUALITY: Final = ("det", "pron", "rel")


class Referents:
    """Resolves the phrases of one sentence."""

    def __init__(
        self,
        s: Sentence,
        things: Callable[[str], Thing | None],
        resolve: Resolve,
        original: Original,
        plural: Set[int],
    ) -> None:
        """`things` returns an entity by name; `resolve` is called with original and with English words.

        `plural` are the indices of English words whose originals are plural.
        """
        self._plural = plural
        self._s, self._thing, self._resolve, self._original = s, things, resolve, original

    def of(self, first: int, last: int, head: int, source: tuple[int, str] | None, like: str) -> Things:
        """Return the entities that the words from `first` to `last` denote; `head` is their head.

        `source` is the phrase (index and entity) that the object is taken from. `like` is the noun that an
        elliptical phrase takes from the previous one (*the blue cup and the red one*), or "".
        """
        s, k = self._s, self._s.phrase_of[head]
        phrase, meant = s.phrases[k], s.candidates[k]
        is_one = means_one(s, k) and self._plural.isdisjoint(range(phrase.first, phrase.last + 1))
        is_any = s.words[head].text in ANYTHING and last > phrase.last
        if not phrase.names or s.branches[k] in (_NOT_DESCRIBED if like or is_any else _NOT_LOOKED_UP):
            return meant
        if like:
            kept = [w.text for w in s.words[phrase.nominal : phrase.last + 1] if w.kind not in _NO_QUALITY]
            return self._fitting(" ".join(("the", *(w for w in kept if w not in ("one", "ones")), like)))
        for text in self._with_modifiers(phrase.nominal, last, k, source):
            found = self._fitting(text)
            if both := found if not meant else tuple(thing for thing in found if thing in meant):
                return both
        if is_any or (len(meant) == 1 and is_one):
            return meant
        for text in (self._original(phrase.nominal, phrase.last), self._english(phrase.nominal, phrase.last)):
            found = self._fitting(text)
            both = tuple(thing for thing in found if thing in meant)
            if found and (not meant or both):
                return found if not meant or not is_one else both
        return chosen(s, first, last, k)

    def _fitting(self, text: str) -> Things:
        return tuple(thing for name in self._resolve(text) if (thing := self._thing(name)) is not None)

    def _english(self, first: int, last: int) -> str:
        return " ".join(word.text for word in self._s.words[first : last + 1])

    def _with_modifiers(
        self, nominal: int, last: int, k: int, source: tuple[int, str] | None
    ) -> Iterator[str]:
        """Yield descriptions of the noun phrase with its modifiers, the most specific first."""
        s, end = self._s, self._s.phrases[k].last
        if source is not None and s.phrases[source[0]].preposition in _FROM:
            yield from (f"{self._english(nominal, end)} {where} {source[1]}" for where in _WHERE_IT_IS)
        for stop in dict.fromkeys((relative_end(s, last), last)):
            if stop > end and s.words[s.phrases[k].head].text not in ANYTHING:
                yield f"{self._english(nominal, end)} {self._by_name(end + 1, stop)}"
            if stop > end:
                yield self._original(nominal, stop)
                yield self._english(nominal, stop)

    def _by_name(self, first: int, last: int) -> str:
        """Return English words, with phrases that denote one entity replaced by its name."""
        s = self._s
        parts = []
        for k in range(s.phrase_of[first], s.phrase_of[last] + 1):
            phrase, meant = s.phrases[k], s.candidates[k]
            words = self._english(phrase.first, phrase.last)
            parts.append(f"{phrase.preposition} {meant[0].name}".strip() if len(meant) == 1 else words)
        return " ".join(parts)


def means_one(s: Sentence, k: int) -> bool:
    """Return whether a phrase denotes one definite thing."""
    phrase = s.phrases[k]
    inside = s.words[phrase.nominal : phrase.last + 1]
    any_or_several = any(s.lexicon.is_a(word.text, "any_or_several") or word.kind == "num" for word in inside)
    head = s.words[phrase.head]
    return not any_or_several and head.kind == "noun" and (head.text == head.lemma or " " in head.text)


def relative_end(s: Sentence, last: int) -> int:
    """Return the last word of the relative clause after a word, or the word itself if there is none."""
    if last + 1 >= len(s.words) or s.words[last + 1].kind != "rel":
        return last
    verb = next((i for i in range(last + 2, len(s.words)) if s.words[i].kind in ("aux", "verb")), None)
    if verb is None or s.words[verb].kind != "aux":
        return last
    behind = s.clause(verb)
    return s.phrases[behind[-1]].last if behind else last


def is_relative(s: Sentence, verb: int) -> bool:
    """Return whether a verb is in a relative clause: *the cup that is on the desk*."""
    before = [i for i in range(max(0, verb - 2), verb) if s.words[i].kind != "neg"]
    if s.words[verb].kind != "aux":
        return False
    return bool(before) and s.words[before[-1]].kind == "rel" and s.phrases[s.phrase_of[before[-1]] - 1].names


def chosen(s: Sentence, first: int, last: int, k: int) -> Things:
    """Return what phrase k may denote by its words alone; of several, the nearest to the other phrases."""
    things = s.candidates[k]
    beside: Sequence[Thing] = [
        s.candidates[other][0]
        for other in range(s.phrase_of[first], s.phrase_of[last] + 1)
        if other != k and len(s.candidates[other]) == 1
    ]
    if len(things) < 2 or not beside:
        return things
    nearest = min(grounding.distance(thing, beside[0]) for thing in things)
    return tuple(thing for thing in things if grounding.distance(thing, beside[0]) == nearest)
