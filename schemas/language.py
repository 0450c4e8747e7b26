"""What a command in words means: frames, what fills their roles, and which entities those are."""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

Language = Literal["english", "italian"]
"""The languages in which commands are understood."""

Mood = Literal["command", "question", "past"]
"""What a sentence is said for; statements of what is (`this is the kitchen`) count as commands."""


class Argument(Struct, frozen=True):
    """What fills a role. Words count from 1.

    `entity` is the one that is meant; where several may be, `candidates` has their names instead.
    """

    role: str
    text: str
    span: tuple[int, int]  # first and last word
    head: int  # the word that it is about
    entity: str | None = None
    candidates: tuple[str, ...] = ()

    @property
    def filler(self) -> str:
        """The entity's name, the names of those that it may be, or the words."""
        return self.entity or "|".join(self.candidates) or f'"{self.text}"'


class Frame(Struct, frozen=True):
    """What is to be done or is said: a frame of FrameNet, the words that call for it, and its arguments."""

    name: str
    verb: tuple[int, ...]
    arguments: tuple[Argument, ...]
    negated: bool = False

    @property
    def text(self) -> str:
        """`Taking(Theme=bottle1, Source=table1)`, with `not` before it if it is not to be done."""
        filled = ", ".join(f"{argument.role}={argument.filler}" for argument in self.arguments)
        return f"{'not ' if self.negated else ''}{self.name}({filled})"


class Grounded(Struct, frozen=True):
    """A word and the entity that it names. Words count from 1."""

    token: int
    entity: str


class Understood(Struct, frozen=True):
    """A command as it was understood.

    `unknown` are words used as verbs that nobody has taught; `language` is the one in which it was read. A
    `mood` other than "command" says why there are no frames: something is asked, or told of the past.
    """

    words: tuple[str, ...]
    frames: tuple[Frame, ...]
    groundings: tuple[Grounded, ...]
    unknown: tuple[str, ...] = ()
    language: Language = "english"
    mood: Mood = "command"
