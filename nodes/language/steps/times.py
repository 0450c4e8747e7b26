"""Expressions of time in a command: at ten o'clock, in five minutes, every evening."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from semmap.nodes.language.lexicon.commands import Grammar

_DURING: Final = ("in", "for", "after", "within", "before", "during", "about")
_AFTER_HOUR: Final = frozenset(
    ("", ",", ".", "!", "?", "and", "then", "please", "today", "tomorrow", "if", "unless")
)
"""Words after which a number before them is an hour: at ten."""


def starts_time(g: Grammar, words: Sequence[str], i: int) -> int:
    """Return the number of words of an expression of time that begins at `i`, or 0."""
    if i >= len(words):
        return 0
    if length := g.match("time", words, i):
        return length
    word, rest = words[i], words[i + 1 :]

    def at(k: int) -> str:
        return rest[k] if k < len(rest) else ""

    def is_unit(text: str) -> bool:
        return g.is_a(text.removesuffix("s"), "unit")

    if word in ("by", "before", "until", "till", "from", "after", "since") and (
        length := g.match("time", words, i + 1)
    ):
        return length + 1
    if length := _within(g, words, i):
        return length
    if word in ("at", "by", "around", "before", "after", "until", "from", "till", "about", "past"):
        if (at(0) in ("half", "quarter", "a") and "past" in rest[1:3]) or (
            "to" in rest[1:3] and at(0) == "quarter"
        ):
            k = 1 + (rest.index("past") if "past" in rest[1:3] else rest.index("to"))
            if g.number(at(k)) is not None:
                return k + 2
        k = 1 if at(0) in ("about", "around", "exactly", "half", "quarter") else 0
        if at(k) in ("noon", "midnight", "night", "lunchtime", "dinnertime"):
            return k + 2
        if ":" in at(k) or (at(k)[:1].isdigit() and "." in at(k)):
            return k + 2 + g.is_a(at(k + 1), "clock")
        if g.number(at(k)) is not None:
            if g.is_a(at(k + 1), "clock"):
                return k + 3
            if at(k + 1) in _AFTER_HOUR:
                return k + 2
            if (
                word == "at"
                and (i == 0 or words[i - 1] in (",", ".", "and", "then"))
                and g.verb(words, i + k + 2)[0]
            ):
                return k + 2  # at ten go to the kitchen
    if word in _DURING:
        k = 1 if at(0) in ("about", "the", "next", "a", "an") else 0
        k += at(k) in ("couple", "few", "next", "half", "of")
        k += at(k) in ("of", "an", "a")
        number = g.number(at(k)) is not None
        if is_unit(at(k + number)) and (number or k):
            return k + number + 2
        if (
            at(0) in ("the", "a")
            and g.is_a(at(1), "day_part")
            and word in ("in", "during")
            and at(1) in ("morning", "evening", "afternoon", "night")
        ):
            return 3
    if word in ("every", "each", "this", "next", "on") and at(0):
        if at(0) == "time" and at(1) not in ("", ",", ".", "!", "?", ";", "and", "then", "please"):
            return 0  # every time Anna comes
        if word == "on" and not at(0).removesuffix("s").endswith("day"):
            return 0
        k = int(g.number(at(0)) is not None)
        part = at(k).removesuffix("s")
        if g.is_a(part, "day_part") and (word != "on" or part.endswith("day")):
            extra = 1 if at(k + 1) in ("morning", "evening", "afternoon", "night") else 0
            return k + 2 + extra
    if g.number(word) is not None and at(0) == "times":
        return 2
    if word == "tomorrow" or word == "today":
        return 1
    return 0


def _within(g: Grammar, words: Sequence[str], i: int) -> int:
    """Return the length of a period at `i`: in a quarter of an hour, for an hour and a half; or 0."""
    if words[i] not in _DURING:
        return 0
    share = g.match("share", words, i + 1)
    j = i + 1 + share
    j += words[j : j + 1] == ("of",) if share else 0
    number = words[j : j + 1] in (("a",), ("an",), ("the",)) or (
        j < len(words) and g.number(words[j]) is not None
    )
    j += number
    if not (share or number) or j >= len(words) or not g.is_a(words[j].removesuffix("s"), "unit"):
        return 0
    is_more = words[j + 1 : j + 2] == ("and",)
    more = g.match("share", words, j + 2) if is_more else 0
    return j + 1 - i + (more + 1 if more else 0)
