"""What a question about the past asks, before its words are resolved in the map."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from semmap.nodes.language.past.times import Period

Asked = Literal[
    "where", "when", "since", "until", "how_long", "how_often", "who", "what", "how_many", "changed",
    "missing", "whether",
]  # fmt: skip
Order = Literal["", "first", "last"]
Anchor = Literal["before", "after", "while", "compare"]


@dataclass(slots=True)
class Claim:
    """Something that happened or was so.

    `subjects` and the second of each of `places` are noun phrases, the first a class of prepositions: `on`,
    `in`, `near`, `to`, `from`. Without an `event`, it is asked whether the subject was at the place or in the
    `state`.
    """

    subjects: list[str] = field(default_factory=list)
    event: str = ""
    state: str = ""
    places: list[tuple[str, str]] = field(default_factory=list)
    agent: str = ""
    is_anyone: bool = False
    is_anything: bool = False
    is_there: bool = False
    """Whether it is the present place of the subject that is meant: since when is it there."""
    is_it: bool = False
    """Whether the subject is a pronoun."""
    kind: str = ""
    """The noun of the place that is asked for: in which *rooms*, which *table* was it on."""


@dataclass(slots=True)
class PastQuestion:
    """A question about the past. `doubts` quote the words that were not used, also those in `unused`."""

    text: str
    asked: Asked
    claim: Claim
    period: Period
    order: Order = ""
    is_current: bool = False
    """Whether it is about what still is so: since when is it open, how long has it been open."""
    is_negated: bool = False
    """Whether it asks that something was never so."""
    is_previous: bool = False
    """Whether it asks for the place before the present one."""
    is_repeated: bool = False
    """Whether it asks for more than one time."""
    is_gross: bool = False
    """Whether it asks what happened, and not what is different in the end."""
    is_all: bool = False
    """Whether it asks that all is still there, or still the same."""
    is_last: bool = False
    """Whether only the last event counts: was it Anna who left it open."""
    anchor: Anchor | None = None
    anchored: Claim | None = None
    """What was so before, after or during what is asked."""
    doubts: list[str] = field(default_factory=list)
    unused: list[str] = field(default_factory=list)
    """Words that have a meaning in other questions: without them it would be another question."""
