"""Questions about the past with the entities that their noun phrases denote."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from semmap.nodes.language.past.question import PastQuestion


@dataclass(frozen=True, slots=True)
class Referent:
    """What a noun phrase denotes: entities of the present or past map.

    `problem` states why there are none, or that one of several is meant. `author` is the author of commits
    with that name.
    """

    text: str
    names: tuple[str, ...] = ()
    problem: str = ""
    author: str = ""
    is_plural: bool = False


@dataclass(frozen=True, slots=True)
class ResolvedQuestion:
    """A question and the referents of its noun phrases. `subjects` are those that *it* refers to."""

    question: PastQuestion
    referents: Mapping[str, Referent]
    it: tuple[str, ...] = ()
    questions: Sequence[str] = field(default=())
    """Clarification questions."""
