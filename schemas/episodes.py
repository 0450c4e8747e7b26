"""Answers to questions about the past, with the episodes that they are based on."""

from __future__ import annotations

from msgspec import Struct


class Episode(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """An event, or a time in which something was so: `cup1` was `on table1` from one commit until another.

    `since` is the commit of the event or of the beginning. It is 0 if the history begins later, and None for
    a visit by live poses, which no commit has. `until` is the commit of the end of what is over. An event has
    no end, and `by` is its author. Time stamps are nanoseconds since 1970.
    """

    subject: str
    what: str
    since: int | None = None
    since_ns: int = 0
    until: int | None = None
    until_ns: int | None = None
    by: str = ""


class PastAnswer(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """The answer to a question about the past.

    `asked` is the kind of the question, such as `where` or `how_long`. What the answer consists of depends on
    it: `names` of places, entities or authors, `times_ns` [ns since 1970] in order, `seconds`, a `count`, or
    whether it is so (`verdict`). The answer is not known if `is_known` is False; `text` then states why.
    `evidence` are the episodes that it is based on, in order of time, at most 100.
    """

    asked: str
    text: str
    is_known: bool = True
    names: tuple[str, ...] = ()
    times_ns: tuple[int, ...] = ()
    seconds: float | None = None
    count: int | None = None
    verdict: bool | None = None
    evidence: tuple[Episode, ...] = ()
