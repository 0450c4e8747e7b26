"""What words mean: commands as frames, roles and entities, and descriptions as the entities that fit them."""

from __future__ import annotations

from typing import Literal

from msgspec import Struct, field

Language = Literal["english", "italian"]
"""The languages in which commands are understood."""

Mood = Literal["command", "question", "past"]
"""What a sentence is said for; statements of what is (`this is the kitchen`) count as commands."""


class Argument(Struct, frozen=True):
    """What fills a role. Words count from 1.

    `entity` is the one that is meant; where several may be, `candidates` has their names instead. One of them
    is meant if it is `ambiguous`, any or all of them if it is not (*a cup*, *the cups*); `number` of them
    where a number is said (*two cups*).
    """

    role: str
    text: str
    span: tuple[int, int]  # first and last word
    head: int  # the word that it is about
    entity: str | None = None
    candidates: tuple[str, ...] = ()
    ambiguous: bool = False
    number: int | None = None

    @property
    def filler(self) -> str:
        """The entity's name, the names of those that it may be (`2 of cup1|cup2|cup3`), or the words."""
        several = "|".join(self.candidates)
        if several and self.number is not None:
            several = f"{self.number} of {several}"
        return self.entity or several or f'"{self.text}"'


class SemanticFrame(Struct, frozen=True):
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


class Account(Struct, frozen=True):
    """What is there after a commit, as a text of so many words, which names all but `left_out` things."""

    text: str
    words: int
    left_out: int
    commit: int


class Understood(Struct, frozen=True):
    """A command as it was understood.

    `unknown` are words used as verbs that nobody has taught; `language` is the one in which it was read. A
    `mood` other than "command" says why there are no frames: something is asked, or told of the past.
    `question` is what to ask back where arguments are ambiguous. `doubts` say, a sentence each, what of the
    command does not fit the map: a thing is not where it is to be taken from, or there are not so many.
    """

    words: tuple[str, ...]
    frames: tuple[SemanticFrame, ...]
    groundings: tuple[Grounded, ...]
    unknown: tuple[str, ...] = ()
    language: Language = "english"
    mood: Mood = "command"
    question: str = ""
    doubts: tuple[str, ...] = ()


class Candidate(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An entity that a description may mean, and what of the description fits it, a clause each."""

    entity: str
    class_: str = field(name="class")
    called: str
    reasons: tuple[str, ...] = ()


Outcome = Literal["one", "several", "ambiguous", "none"]


class Found(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a description means in the map, as of commit `seq`.

    `candidates` are what is meant (*one*, *several*) or may be (*ambiguous*, with the `question` to ask
    back), the best first, at most 50, and `others` counts the rest; *none* has none. `text` says the outcome
    in a sentence. `nearest` fit all but one part of the description; `gone` says when such a thing was last
    there. `read_as` pairs each word that was taken for another, mistyped or misheard, with that.
    """

    outcome: Outcome
    candidates: tuple[Candidate, ...] = ()
    text: str = ""
    question: str = ""
    nearest: tuple[Candidate, ...] = ()
    others: int = 0
    gone: tuple[str, ...] = ()
    read_as: tuple[tuple[str, str], ...] = ()
    seq: int = 0
