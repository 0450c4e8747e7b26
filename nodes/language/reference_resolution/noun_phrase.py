"""Reads the words around a noun: determiners, head and modifiers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Final

from semmap.nodes.language.reference_resolution.description import (
    AnyOf,
    Axis,
    Description,
    Head,
    Of,
    Owned,
    Quality,
    Restriction,
    Sized,
    State,
    Unknown,
)
from semmap.nodes.language.reference_resolution.reading import Reading
from semmap.schemas import errors

_BOUNDS: Final = (
    *("relations", "relative", "where", "be", "have", "lack", "not", "except", "no", "and", "or", "of"),
    *("possessive", "afford", "from", "called", "own", "position"),
)
"""Kinds of words that end the noun group."""
_BEFORE_A_NOUN: Final = (
    *("quality", "states", "sizes", "sides", "ordinals"),
    *("numbers", "mine", "he", "filler", "every"),
)
_DETERMINERS: Final = (
    *("every", "pair", "bounds", "definite", "indefinite", "mine", "he", "filler", "numbers"),
    "plural_determiner",
)


@dataclass(slots=True)
class Draft:
    """A description that is being built."""

    first: int
    head: Head = "one"
    key: str = ""
    noun: str = ""
    is_definite: bool = True
    is_plural: bool = False
    number: int | None = None
    beyond: int = 0
    restrictions: list[Restriction] = field(default_factory=list)
    place: int | None = None
    axis: tuple[Axis, int] | None = None
    order_text: str = ""
    to: Description | None = None


class NounPhraseReader:
    """Reads the words around a noun into a draft."""

    def __init__(self, reading: Reading) -> None:
        self._r = reading
        self._words = reading.words

    # Look-up by position

    def _sense(self, kind: str, i: int) -> tuple[int, Any] | None:
        return self._r.senses[i].get(kind) if i < len(self._words) else None

    def _length(self, kind: str, i: int) -> int:
        found = self._sense(kind, i)
        return 0 if found is None else found[0]

    def _text(self, first: int, end: int) -> str:
        return " ".join(self._words[first:end])

    # Before the noun

    def _determiners(self, draft: Draft, i: int) -> int:
        while i < len(self._words):
            best = max(_DETERMINERS, key=lambda kind: self._length(kind, i))
            length, value = self._sense(best, i) or (0, None)
            if not length or self._length("noun", i) > length or self._length("anything", i) > length:
                break
            if self._length("ordinals", i) > length or self._length("sides", i) > length:
                break
            if self._length("plural_determiner", i) == length or self._length("every", i) == length:
                draft.is_plural = True
            if self._length("pair", i) == length:
                draft.number, draft.is_plural = 2, True
            if best == "indefinite":
                draft.is_definite = False
            elif best == "mine":
                draft.restrictions.append(Owned(self._text(i, i + length)))
            elif best == "he":
                draft.restrictions.append(Owned(self._text(i, i + length), Description("it", "it")))
            elif best == "bounds":
                draft.is_definite, draft.beyond = False, int(value or 0)
            elif best == "numbers" and value:
                draft.is_definite = draft.is_definite and draft.first != i
                self._number(draft, value)
            i += length
        return i

    def _number(self, draft: Draft, value: int) -> None:
        draft.number = value + draft.beyond
        draft.is_plural = draft.number > 1

    def _run_end(self, i: int) -> int:
        """Return the index after the noun group that begins at i."""
        seen_noun, begin = False, i
        while i < len(self._words) and not (i > begin and self._owns(i)):
            noun = self._length("noun", i)
            bound = max(self._length(kind, i) for kind in _BOUNDS)
            beside = max(self._length(kind, i) for kind in _BEFORE_A_NOUN)
            if anything := self._length("anything", i):
                i, seen_noun = i + anything, True
            elif noun > 1 and noun >= bound:
                i, seen_noun = i + noun, True
            elif self._joins_qualities(i) and not seen_noun:
                i += 1
            elif (bound and (bound >= beside or self._length("states", i) == beside)) or (
                beside and self._length("sides", i) == beside and seen_noun and beside > 1
            ):
                break
            else:
                seen_noun = seen_noun or (bool(noun) and not self._followed_by_noun(i + noun))
                i += 1 if not beside or noun else beside
        return i

    def _owns(self, i: int) -> bool:
        """Return whether an owner and *owns* are at i: the cup ANNA OWNS."""
        noun = i + self._length("definite", i)
        return self._length("noun", noun) > 0 and self._length("own", noun + self._length("noun", noun)) > 0

    def _joins_qualities(self, i: int) -> bool:
        """Return whether the *and* or *or* at i joins two adjectives before a noun."""
        if not (self._length("and", i) or self._length("or", i)):
            return False
        adjectives = ("quality", "states", "sizes")
        following = any(self._length(kind, i + 1) for kind in adjectives)
        before = i > 0 and any(self._length(kind, i - 1) for kind in adjectives)
        return following and before and self._r.nouns.describing.head_is_last

    def _followed_by_noun(self, i: int) -> bool:
        return bool(self._length("noun", i))

    def _around_the_noun(self, draft: Draft, i: int) -> int:
        end = self._run_end(i)
        head = self._head(draft, i, end)
        if head is None:
            self._modifiers(draft, i, end)
            return end
        first, last = head
        self._modifiers(draft, i, first)
        self._modifiers(draft, last, end)
        return end

    def _head(self, draft: Draft, first: int, end: int) -> tuple[int, int] | None:
        """Return the span of the head noun: the last or the first one, depending on the language."""
        is_last = self._r.nouns.describing.head_is_last
        if is_last and end - 1 > first and self._length("one", end - 1) and not self._length("noun", end - 1):
            draft.head, draft.is_plural = "one", self._words[end - 1] == "ones"  # the orange one
            return end - 1, end
        spans = [
            (i, i + length)
            for i in range(first, end)
            for length in range(1, end - i + 1)
            if self._sense(f"noun{length}", i) is not None
            and not (length > 1 and i > first and self._joins_qualities(i - 1))
        ]
        if spans:
            if is_last:
                start, stop = max(spans, key=lambda span: (span[1], span[1] - span[0]))
            else:
                start, stop = min(spans, key=lambda span: (span[0], span[0] - span[1]))
            sense = self._sense(f"noun{stop - start}", start)
            if sense is None:
                raise errors.InternalError("a word that was recognised has no meaning")
            draft.head, draft.key, draft.noun = "noun", sense[1], self._text(start, stop)
            self._say_number(draft, stop - 1 if is_last else start)
            return start, stop
        for kind in ("anything", "one"):
            for i in range(first, end):
                if length := self._length(kind, i):
                    draft.head = "anything" if kind == "anything" else "one"
                    if kind == "anything":
                        articles = ("definite", "ordinals", "sides")
                        draft.is_definite = any(
                            self._length(article, j) for article in articles for j in range(draft.first, i)
                        )
                    if self._words[i] in ("ones", "things", "objects"):
                        draft.is_plural = True
                    return i, i + length
        return None

    def _say_number(self, draft: Draft, i: int) -> None:
        describing, word = self._r.nouns.describing, self._words[i]
        if word in describing.pluralia:
            if draft.number is None:
                draft.is_plural = draft.is_plural and not self._only_agrees(draft)
        elif word in describing.collectives or (
            describing.head_is_last and describing.base(word) != word and word.endswith(("s", "ves", "men"))
        ):
            draft.is_plural = True

    def _only_agrees(self, draft: Draft) -> bool:
        """Return whether only the article is plural: le chiavi."""
        return not any(self._length("every", i) for i in range(draft.first, len(self._words)))

    def _modifiers(self, draft: Draft, i: int, end: int) -> None:
        either: Restriction | None = None
        while i < end:
            if self._length("and", i) or self._length("or", i):
                either = draft.restrictions.pop() if draft.restrictions else None
                i += 1
                continue
            i = self._modifier(draft, i, end)
            if either is not None and draft.restrictions:
                draft.restrictions.append(AnyOf((either, draft.restrictions.pop())))
                either = None
        if either is not None:
            draft.restrictions.append(either)

    def _modifier(self, draft: Draft, i: int, end: int) -> int:
        """Read one modifier beside the noun. Returns the index of the next word."""
        kinds = [kind for kind in _BEFORE_A_NOUN if 0 < self._length(kind, i) <= end - i]
        noun = self._sense("noun", i)
        best = max(kinds, key=lambda kind: self._length(kind, i), default="")
        if noun is not None and noun[0] <= end - i and noun[0] > (self._length(best, i) if best else 0):
            text = self._text(i, i + noun[0])
            draft.restrictions.append(Of(text, Description(text, "noun", noun[1], text, is_definite=False)))
            return i + noun[0]
        if not best:
            if any(
                self._length(kind, i)
                for kind in ("definite", "indefinite", "relative", "be", "to", "possibly")
            ):
                return i + 1
            draft.restrictions.append(Unknown(self._words[i]))
            return i + 1
        sense = self._sense(best, i)
        if sense is None:
            raise errors.InternalError("a word that was recognised has no meaning")
        length, value = sense
        text = self._text(i, i + length)
        match best:
            case "quality" | "states" | "sizes":
                draft.restrictions.append(self._adjective(best, text, value))
            case "sides":
                draft.axis, draft.order_text = value, f"{draft.order_text} {text}".strip()
            case "ordinals":
                draft.place, draft.order_text = value, f"{draft.order_text} {text}".strip()
            case "numbers" if value:
                self._number(draft, value)
            case "mine":
                draft.restrictions.append(Owned(text))
            case "every":
                draft.is_plural = True
        return i + length

    def _adjective(self, kind: str, text: str, value: Any) -> Restriction:
        if kind == "quality":
            return Quality(text, value)
        if kind == "sizes":
            return Sized(text, value[0], value[1])
        return State(text, value[0], value[1])
