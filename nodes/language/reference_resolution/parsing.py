"""A small grammar of noun phrases for all languages; language-specific words are in the lexicon's tables."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from typing import Any, Final

from semmap.nodes.language.reference_resolution.description import (
    Affords,
    Among,
    AnyOf,
    Called,
    Description,
    FromViewer,
    Has,
    Not,
    Of,
    Order,
    Owned,
    Quality,
    Related,
    Restriction,
    State,
    Unknown,
)
from semmap.nodes.language.reference_resolution.noun_phrase import Draft, NounPhraseReader
from semmap.nodes.language.reference_resolution.reading import Reading, forms

_BEGINS: Final = (
    *("definite", "indefinite", "noun", "it", "one", "mine", "quality", "numbers", "sizes"),
    *("plural_determiner", "anything", "ordinals", "sides", "every", "he"),
)
"""Kinds of words that can begin a noun phrase."""
_SKIPPED: Final = ("definite", "indefinite", "relative", "be", "to", "possibly")
_OPENING: Final = (
    "relations",
    "relative",
    "where",
    "have",
    "lack",
    "of",
    "sides",
    "not",
    "called",
    "position",
)
_MOST_ATTACHMENTS: Final = 6
"""The maximum number of phrases for which other attachments are tried."""


def parses(reading: Reading) -> Iterator[tuple[Description, ...]]:
    """Yield the possible parses of a text, the most likely first; each is a list of descriptions.

    They differ in the attachment of phrases: in *the cup on the table near the door*, either the cup or the
    table is near the door.
    """
    first = _Parser(reading)
    yield first.all()
    inner = first.inner[:_MOST_ATTACHMENTS]
    for number in range(1, len(inner) + 1):
        for high in combinations(inner, number):
            yield _Parser(reading, frozenset(high)).all()


class _Parser(NounPhraseReader):
    def __init__(self, reading: Reading, high: frozenset[int] = frozenset()) -> None:
        super().__init__(reading)
        self._high = high
        self.inner: list[int] = []
        """The start indices of phrases that could also be attached to an earlier noun."""

    # Phrases

    def all(self) -> tuple[Description, ...]:
        """Return the descriptions in the text."""
        i, found, is_alternative = 0, list[Description](), False
        while i < len(self._words) and (
            length := max(self._length("opening", i), self._length("filler", i), self._length("polite", i))
        ):
            i += length
        if self._length("be", len(self._words) - 1) and not self._length("afford", i):
            i += self._length("where", i)  # where Anna is; not: where can I sit
        while i < len(self._words):
            made, j = self._phrase(i, 0)
            if j == i:  # no phrase begins here: keep the word as unknown
                unread = Unknown(self._words[i])
                made, j = replace(made, text=unread.text, restrictions=(unread,)), i + 1
            joined = any(self._length(kind, j) for kind in ("and", "or", "definite", "indefinite"))
            if j < len(self._words) and not joined:  # the next word cannot be attached
                unread = Unknown(self._words[j])
                made, j = replace(made, restrictions=(*made.restrictions, unread)), j + 1
            found.append(replace(made, is_alternative=is_alternative))
            is_alternative = bool(self._length("or", j))
            i = j + (self._length("or", j) or self._length("and", j))
        return tuple(self._with_nouns(found))

    def _with_nouns(self, found: list[Description]) -> Iterator[Description]:
        """Add the noun to earlier phrases without one: the red and the blue cup."""
        following: Description | None = None
        for i in reversed(range(len(found))):
            phrase = found[i]
            if phrase.head != "one":
                following = phrase
            elif (
                following is not None and phrase.restrictions and not any(d.head == "noun" for d in found[:i])
            ):
                found[i] = replace(phrase, head=following.head, key=following.key, noun=following.noun)
        return iter(found)

    def _phrase(self, i: int, depth: int, owner: Restriction | None = None) -> tuple[Description, int]:
        draft = Draft(i)
        if owner is not None:
            draft.restrictions.append(owner)
        if (it := self._length("it", i)) and not self._length("noun", i) > it:
            draft.head = "it"
            return self._done(draft, i + it), i + it
        i = self._determiners(draft, i)
        if not depth and i == 0 and (who := self._sense("who", i)):
            noun = self._r.nouns.describing.wording["person"]
            draft.head, draft.key, draft.noun = "noun", self._r.nouns.describing.base(noun), noun
            draft.is_plural, i = True, who[0]
        else:
            i = self._around_the_noun(draft, i)
        if (possessive := self._length("possessive", i)) and draft.head == "noun":
            by = Owned(self._text(draft.first, i), self._done(draft, i))
            made, j = self._phrase(i + possessive, depth, by)
            return replace(made, text=self._text(draft.first, j)), j
        i = self._after_the_noun(draft, i, depth)
        return self._done(draft, i), i

    def _done(self, draft: Draft, end: int) -> Description:
        order = None
        if draft.axis is not None or draft.place is not None:
            axis, sign = draft.axis or ("", 1)
            order = Order(draft.order_text, axis, sign, draft.place or 1, draft.number or 1, draft.to)
        return Description(
            self._text(draft.first, end), draft.head, draft.key, draft.noun, draft.is_definite,
            draft.is_plural, draft.number, tuple(draft.restrictions), order,
        )  # fmt: skip

    # After the noun

    def _after_the_noun(self, draft: Draft, i: int, depth: int) -> int:
        negated = False
        either = False
        while i < len(self._words):
            if depth and self._opens(i):
                self.inner.append(i)
                if (i in self._high) != self._denies_kind(i):
                    return i
            if (length := self._length("except", i)) and not self._goes_on(i + length):
                if depth:  # it is an exception to the outer phrase
                    return i
                if self._ends(i + length):
                    return i
                other, j = self._phrase(i + length, depth + 1)
                text = self._text(i, j)
                draft.restrictions.append(Not(text, Among(text, other)))
                i = j
                continue
            if (length := self._length("or", i)) and self._goes_on(i + length):
                either, i = True, i + length
                continue
            if (length := self._length("and", i)) and self._length("lack", i) < 2:
                if not self._goes_on(i + length):
                    return i
                i += length
                continue
            length = max(self._length("not", i), self._length("except", i))
            if length and length >= self._length("relations", i):
                negated, i = True, i + length
                continue
            before, order = len(draft.restrictions), (draft.axis, draft.order_text, draft.to)
            j = self._one_after(draft, i, depth)
            if negated and j > i and (draft.axis, draft.order_text, draft.to) != order:  # not at the top
                first = replace(self._done(draft, j), is_definite=True, is_plural=False, number=None)
                draft.axis, draft.order_text, draft.to = order
                draft.restrictions.append(Among(self._text(i, j), first))
            if j == i and negated and not self._ends(i):
                other, j = self._phrase(i, depth + 1)
                draft.restrictions.append(Among(self._text(i, j), other))
            if j == i:
                return i
            if len(draft.restrictions) > before:
                made = draft.restrictions.pop()
                if negated:
                    made, negated = Not(self._denied(made.text), made), False
                if either and draft.restrictions:
                    made, either = AnyOf((draft.restrictions.pop(), made)), False
                draft.restrictions.append(made)
            i = j
        return i

    def _denied(self, text: str) -> str:
        return self._r.nouns.describing.wording["not"].format(text)

    def _opens(self, i: int) -> bool:
        """Return whether a modifying phrase begins at i."""
        return any(self._length(kind, i) for kind in _OPENING)

    def _denies_kind(self, i: int) -> bool:
        """Return whether *that is not a box* is at i: on the shelf that is not a box, no shelf is meant."""
        j, is_denied = i, False
        while length := max(self._length(kind, j) for kind in ("relative", "be", "not", "indefinite")):
            is_denied = is_denied or self._length("not", j) == length
            j += length
        return is_denied and self._length("noun", j) > max(self._length(k, j) for k in ("quality", "states"))

    def _goes_on(self, i: int) -> bool:
        """Return whether the word at i continues the description of the same object."""
        kinds = ("relations", "relative", "not", "be", "have", "lack", "states", "quality", "sizes", "afford")
        return any(self._length(kind, i) for kind in kinds) and not (
            self._length("noun", i) and not self._length("quality", i)
        )

    def _one_after(self, draft: Draft, i: int, depth: int) -> int:
        """Read one modifier after the noun. Returns the index of the next word, or i if there is none."""
        if (length := self._length("called", i)) and i + length < len(self._words):
            return self._called(draft, i, i + length)
        if owned := self._owned_by(draft, i, depth):
            return owned
        if (length := self._length("position", i)) and (rank := self._sense("numbers", i + length)):
            draft.place, end = rank[1], i + length + rank[0]  # at position 2 from the left
            draft.order_text = self._text(i, end)
            return end
        if (action := self._action(i)) is not None:
            length, affordances = action
            draft.restrictions.append(Affords(self._text(i, i + length), affordances))
            draft.is_definite = draft.is_definite and not self._length("where", i)
            return i + length
        ordering = self._ordering(draft, i, depth)
        if ordering != i:
            return ordering
        relation, side = self._sense("relations", i), self._sense("sides", i)
        if side is not None and (relation is None or side[0] > relation[0] or self._ends(i + relation[0])):
            draft.axis, draft.order_text = side[1], f"{draft.order_text} {self._text(i, i + side[0])}".strip()
            end = i + side[0]
            if side[1][0] == "distance" and (to := self._length("to", end)):
                draft.to, end = self._phrase(end + to, depth + 1)
            return end
        state = self._sense("states", i)
        if state is not None and (relation is None or self._ends(i + state[0]) or state[0] > relation[0]):
            draft.restrictions.append(self._adjective("states", self._text(i, i + state[0]), state[1]))
            return i + state[0]
        of = self._length("of", i)
        if of and of >= self._length("relations", i) and (made := self._of(draft, i, of, depth)):
            return made
        if relation is not None:
            return self._related(draft, i, relation, depth)
        if (length := self._length("from", i)) and not self._ends(i + length):  # a cup from the table
            other, j = self._phrase(i + length, depth + 1)
            draft.restrictions.append(Of(self._text(i, j), other))
            return j
        if (length := self._length("lack", i)) and length >= self._length("have", i):
            return self._lacking(draft, i, length, depth)
        if length := self._length("have", i):
            if no := self._length("no", i + length):
                return self._lacking(draft, i, length + no, depth)
            other, j = self._phrase(i + length, depth + 1)
            draft.restrictions.append(Has(self._text(i, j), other))
            return j
        if (length := self._length("where", i)) and not self._ends(j := self._behind_be(i + length)):
            other, j = self._phrase(j, depth + 1)
            draft.restrictions.append(Has(self._text(i, self._behind_be(j)), other))
            return self._behind_be(j)
        if (length := self._length("to", i)) and draft.head == "noun" and not self._ends(i + length):
            other, j = self._phrase(i + length, depth + 1)  # the door to the bathroom
            draft.restrictions.append(Of(self._text(i, j), other))
            return j
        for kind in ("quality", "sizes"):
            if (sense := self._sense(kind, i)) is not None:
                draft.restrictions.append(self._adjective(kind, self._text(i, i + sense[0]), sense[1]))
                return i + sense[0]
        for kind in ("relative", "be", "filler", "possibly"):
            if length := self._length(kind, i):
                return i + length
        if mine := self._length("mine", i):
            draft.restrictions.append(Owned(self._text(i, i + mine)))
            return i + mine
        if not self._r.senses[i]:
            draft.restrictions.append(Unknown(self._words[i]))
            return i + 1
        return i

    def _called(self, draft: Draft, i: int, first: int) -> int:
        """Read a name after *called*: as many words as are a label or name, or else the rest."""
        describing, end = self._r.nouns.describing, len(self._words)
        keys = ((j, describing.key(list(self._words[first:j]))) for j in range(end, first, -1))
        j, key = next((pair for pair in keys if pair[1] in self._r.nouns.exact), (end, ""))
        draft.restrictions.append(Called(self._text(i, j), key))
        return j

    def _owned_by(self, draft: Draft, i: int, depth: int) -> int:
        """Read *that Anna owns*, *Anna owns*; return the index of the next word, or 0."""
        length = self._length("relative", i)
        if not (length or self._owns(i)) or self._ends(i + length):
            return 0
        if not any(self._length("own", j) for j in range(i + length + 1, len(self._words))):
            return 0
        owner, j = self._phrase(i + length, depth + 1)
        if not (own := self._length("own", j)):
            return 0
        draft.restrictions.append(Owned(self._text(i, j + own), owner))
        return j + own

    def _behind_be(self, i: int) -> int:
        while length := self._length("be", i):
            i += length
        return i

    def _ends(self, i: int) -> bool:
        """Return whether no noun phrase begins at i."""
        if i >= len(self._words):
            return True
        return not any(self._length(kind, i) for kind in _BEGINS)

    def _action(self, i: int) -> tuple[int, frozenset[str]] | None:
        """Return the number of words of an action at i, and the affordances that it denotes."""
        if not (length := self._length("afford", i)):
            return None
        actions, j = self._r.nouns.actions, i + length
        if j >= len(self._words):
            return None
        tail = self._length("afford_tail", j + 1)
        if tail and not self._ends(j + 1 + tail):  # something to read on the desk
            tail = 0
        endings = (self._text(j + 1, j + 1 + tail), "") if tail else ("",)
        for ending in endings:
            for form in forms(self._words[j]):
                if (text := f"{form} {ending}".strip()) in actions:
                    return length + 1 + tail, frozenset(actions[text])
        if self._length("where", i):  # where can I sit: on an object that affords sitting on it
            verbs = tuple(f"{form} " for form in forms(self._words[j]))
            found = frozenset[str]().union(
                *(names for text, names in actions.items() if text.startswith(verbs))
            )
            return (length + 1, found) if found else None
        return None

    def _ordering(self, draft: Draft, i: int, depth: int) -> int:
        """Read the reference of an order: *from the left*, *from the door*."""
        is_distance = draft.axis is not None and draft.axis[0] == "distance" and draft.to is None
        length = max(self._length("from", i), self._length("to", i) if is_distance else 0)
        if not length or (draft.place is None and draft.axis is None):
            return i
        end = i + length
        if (place := self._sense("places", end)) is not None:
            draft.axis = place[1]
            end += place[0]
        elif draft.axis is not None and (me := self._length("possibly", end)):  # nearest to me
            end += me
        elif (draft.axis is None or draft.axis[0] == "distance") and not self._ends(end):
            draft.axis = draft.axis or ("distance", 1)
            draft.to, end = self._phrase(end, depth + 1)
        else:
            return i
        draft.order_text = f"{draft.order_text} {self._text(i, end)}".strip()
        return end

    def _of(self, draft: Draft, i: int, length: int, depth: int) -> int:
        """Read *of wood*, *of the kitchen*, *of Anna* or *of water*; return 0 if none of them follows."""
        j = i + length
        article = self._length("definite", j)
        quality = self._sense("quality", j)
        if quality is not None and not article and not self._length("noun", j) > quality[0]:
            draft.restrictions.append(Quality(self._text(i, j + quality[0]), quality[1]))
            return j + quality[0]
        if self._sense("relations", i) is not None and self._length("relations", i) >= length:
            return 0
        if self._ends(j):
            return 0
        other, end = self._phrase(j, depth + 1)
        if other.head == "one" and len(other.restrictions) == 1:  # something of Anna's is of Anna
            (owned,) = other.restrictions
            other = (owned.by if isinstance(owned, Owned) else None) or other
        is_content = draft.key in self._r.nouns.describing.content
        draft.restrictions.append(Of(self._text(i, end), other, is_content))
        return end

    def _related(self, draft: Draft, i: int, relation: tuple[int, Any], depth: int) -> int:
        length, name = relation
        j = i + length
        which = self._length("relative", j)
        if me := self._length("viewer", j):  # behind me
            draft.restrictions.append(FromViewer(self._text(i, j + me), name))
            return j + me
        if (
            self._ends(j + self._length("no", j)) and not which
        ):  # the other object was mentioned before: with a glass on it, senza bicchiere accanto
            if depth:
                draft.restrictions.append(Related(self._text(i, j), name, (Description("it", "it"),)))
            return j
        if which and not self._ends(j + which):  # on which the laptop is
            other, end = self._phrase(j + which, depth + 1)
            draft.restrictions.append(Has(self._text(i, end), other))
            return end
        others: list[Description] = []
        no = self._length("no", j)
        other, end = self._phrase(j + no, depth + 1)
        others.append(other)
        if name == "outside":
            text = self._text(i, end)
            draft.restrictions.append(Not(text, Related(text, "isInside", (other,))))
            return end
        if name == "isBetween" and not other.is_plural and (joined := self._length("and", end)):
            other, end = self._phrase(end + joined, depth + 1)
            others.append(other)
        text = self._text(i, end)
        related: Restriction = Related(text, "isInside" if name == "at" else name, tuple(others))
        if name == "at":  # in a room, or beside a table
            related = AnyOf((related, Related(text, "isNextTo", tuple(others))))
        draft.restrictions.append(Not(text, related) if no else related)
        return end

    def _lacking(self, draft: Draft, i: int, length: int, depth: int) -> int:
        text, j = self._text(i, i + length), i + length
        if text.endswith(("nothing", "niente")):
            relation = self._length("relations", j)
            j += relation + self._length("it", j + relation)
            draft.restrictions.append(State(self._text(i, j), "holding", False))
            return j
        other, end = self._phrase(j, depth + 1)
        text = self._text(i, end)
        draft.restrictions.append(Not(text, Has(text, other)))
        return end
