"""The words of a question as elements: what is asked, events, relations, noun phrases, times."""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass, field
from typing import Final, Literal

from semmap.nodes.language.lexicon.past import PastLexicon
from semmap.nodes.language.past.times import Period, TimeReader
from semmap.nodes.language.reference_resolution.map_index import Nouns

Kind = Literal["ask", "event", "state", "relation", "mark", "filler", "thing", "time", "unknown"]
_ORDER: Final[tuple[Kind, ...]] = ("ask", "event", "state", "relation", "mark", "filler")
_MOST_WORDS: Final = 8
TENSES: Final = ("past", "present", "perfect")
"""The marks of the tense: was, is, has."""
_DETERMINERS: Final = ("definite", "indefinite", "mine", "plural_determiner")


@dataclass(slots=True)
class Element:
    """An expression of a question with its meanings: the class of each table of the lexicon."""

    kind: Kind
    value: str
    text: str
    senses: Mapping[str, str] = field(default_factory=dict)
    period: Period | None = None
    is_known: bool = True
    is_used: bool = False

    def is_a(self, kind: Kind, *values: str) -> bool:
        """Return whether it is of a kind and, if any are given, has one of these values."""
        return self.kind == kind and (not values or self.value in values)


class Elements:
    """Splits questions of one language into elements."""

    def __init__(self, lexicon: PastLexicon, nouns: Nouns, times: TimeReader, names: Set[str]) -> None:
        """`names` are further names in lower case: of authors, and of entities that no longer exist."""
        self._lexicon, self._nouns, self._times, self._names = lexicon, nouns, times, names
        self._articles = frozenset(
            word
            for words, senses in nouns.describing.senses.items()
            if len(words) == 1 and any(kind in senses for kind in _DETERMINERS)
            for word in words
            if "ask" not in lexicon.senses.get(words, {})
        )

    def read(self, words: list[str]) -> list[Element]:
        """Return the elements of the words of one question, in order."""
        found: list[Element] = []
        i = 0
        while i < len(words):
            length, element = self._element(words, i)
            found.append(element)
            i += length
        return _with_unknown_things(found)

    def _element(self, words: list[str], i: int) -> tuple[int, Element]:
        time_length, period = self._times.read(words, i)
        length, senses = self._lexicon.match(words, i)
        thing = self._thing(words, i)
        most = max(time_length, length, thing)
        if time_length and time_length == most:
            text = " ".join(words[i : i + time_length])
            return time_length, Element("time", "", text, period=period)
        if thing and (thing > length or not senses):
            text = " ".join(words[i : i + thing])
            return thing, Element("thing", text, text)
        if length:
            return length, _of_senses(senses, " ".join(words[i : i + length]))
        return 1, Element("unknown", words[i], words[i])

    def _thing(self, words: list[str], i: int) -> int:
        """Return the number of words of the noun phrase that begins at `i`, or 0."""
        j = i
        while j < len(words) and words[j] in self._articles and words[j] not in self._names:
            j += 1
        length = self._noun(words, j)
        if not length:
            return 0
        is_name = " ".join(words[j : j + length]) in self._names
        if is_name and "filler" in self._lexicon.match(words, i)[1]:
            return 0  # the cup that Anna moved
        end = j + length
        of, of_senses = self._lexicon.match(words, end)
        if of_senses.get("relation") == "of" and (more := self._thing(words, end + of)):
            return end + of + more - i
        if words[end : end + 1] == ["'s"] and (more := self._noun(words, end + 1)):
            return end + 1 + more - i
        return end - i

    def _noun(self, words: list[str], i: int) -> int:
        """Return the number of words of the noun at `i` with its adjectives, or 0."""
        for length in range(min(_MOST_WORDS, len(words) - i), 0, -1):
            part = words[i : i + length]
            if any(word in ("?", ";") for word in part):
                continue
            if " ".join(part) in self._names or self._is_noun(part):
                return length
        return 0

    def _is_noun(self, part: list[str]) -> bool:
        describing = self._nouns.describing
        key = describing.key(describing.split(" ".join(part)))
        if self._nouns.is_noun(key):
            return True
        if len(part) == 2 and part[1].isdigit():  # cup 1
            return "".join(part) in self._names or self._nouns.is_noun("".join(part))
        if len(part) < 2:
            return False
        first, last = (part[0], part[1:]) if describing.head_is_last else (part[-1], part[:-1])
        return self._is_quality(first) and self._is_noun(last)

    def _is_quality(self, word: str) -> bool:
        describing = self._nouns.describing
        return describing.key([word]) in self._nouns.qualities or "sizes" in describing.sense((word,))


def _of_senses(senses: Mapping[str, str], text: str) -> Element:
    """Return the element of an expression; which of its meanings counts, its neighbours decide."""
    kind: Kind = next((kind for kind in _ORDER if kind in senses), "filler")
    return Element(kind, senses.get(kind, ""), text, senses)


def _with_unknown_things(elements: list[Element]) -> list[Element]:
    """Return the elements with unknown words that stand where a noun phrase does as noun phrases."""
    found: list[Element] = []
    for element in elements:
        before = found[-1] if found else None
        if (
            element.kind == "unknown"
            and before is not None
            and before.kind == "thing"
            and not before.is_known
        ):
            before.text = before.value = f"{before.text} {element.text}"
        elif element.kind == "unknown" and (
            any(c.isdigit() for c in element.text)
            or (before is not None and (before.kind == "relation" or before.text in ("the", "a", "an")))
            or (before is not None and before.is_a("mark", *TENSES) and not element.text.endswith("ly"))
        ):
            found.append(Element("thing", element.text, element.text, is_known=False))
        else:
            found.append(element)
    return found
