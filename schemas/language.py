"""Results of language processing: semantic frames of commands, and entities that match descriptions."""

from __future__ import annotations

from typing import Literal

from msgspec import Struct, field

from semmap.schemas.episodes import PastAnswer

Language = Literal["english", "italian"]
"""The languages of commands."""

Mood = Literal["command", "question", "past"]
"""The mood of a sentence; statements about the present (`this is the kitchen`) count as commands."""


class Argument(Struct, frozen=True):
    """The filler of a role. Words are counted from 1.

    `entity` is the referent; if there are several, `candidates` has their names instead. If `ambiguous`,
    exactly one of them is the referent; otherwise any or all of them are (*a cup*, *the cups*). `number` is
    set if the text contains a numeral (*two cups*).
    """

    role: str
    text: str
    span: tuple[int, int]  # first and last word
    head: int  # the head word
    entity: str | None = None
    candidates: tuple[str, ...] = ()
    ambiguous: bool = False
    number: int | None = None

    @property
    def filler(self) -> str:
        """The entity's name, the candidates' names (`2 of cup1|cup2|cup3`), or the words."""
        several = "|".join(self.candidates)
        if several and self.number is not None:
            several = f"{self.number} of {several}"
        return self.entity or several or f'"{self.text}"'


class SemanticFrame(Struct, frozen=True):
    """A semantic frame of FrameNet with the words that evoke it and its arguments."""

    name: str
    verb: tuple[int, ...]
    arguments: tuple[Argument, ...]
    negated: bool = False

    @property
    def text(self) -> str:
        """`Taking(Theme=bottle1, Source=table1)`, with `not` before it if it is negated."""
        filled = ", ".join(f"{argument.role}={argument.filler}" for argument in self.arguments)
        return f"{'not ' if self.negated else ''}{self.name}({filled})"


class Grounded(Struct, frozen=True):
    """A word and the entity that it denotes. Words are counted from 1."""

    token: int
    entity: str


class Account(Struct, frozen=True):
    """A text about the map after a commit, which names all but `left_out` things."""

    text: str
    words: int
    left_out: int
    commit: int


class PlaceRelation(Struct, frozen=True, rename={"is_": "is"}, omit_defaults=True):
    """Where a described thing is: a preposition, the words `of` the other thing, and its entities."""

    is_: str
    of: str
    entities: tuple[str, ...] = ()
    negated: bool = False


class ThingDescription(Struct, frozen=True, rename={"class_": "class"}, omit_defaults=True):
    """What a command says of a thing or person.

    `class_` is a class of the TBox, `called` the noun if it is not a label of that class, and `name` the name
    of a person. `quantity` is a number or `all`. If `at_least` or `at_most` bounds the number (*up to two*),
    `quantity` is a number within the bounds. `purpose` is what something is for (*to drink*).
    `alternatives` are other things any of which will do as well (*or a knife*).
    """

    class_: str = ""
    called: str = ""
    name: str = ""
    attributes: tuple[str, ...] = ()
    relation: tuple[PlaceRelation, ...] = ()
    superlative: str = ""
    quantity: int | Literal["all"] | None = None
    at_least: int | None = None
    at_most: int | None = None
    purpose: str = ""
    owner: str = ""
    excluded: tuple[str, ...] = ()
    alternatives: tuple[str, ...] = ()

    def number_of(self, there: int) -> str:
        """Return `2 of ` or `at most 2 of ` if not all of the things that are `there` are meant, or ""."""
        if self.at_least is not None and self.at_most is not None:
            return f"{self.at_least} to {self.at_most} of "
        if self.at_least is not None or self.at_most is not None:
            return f"at least {self.at_least} of " if self.at_most is None else f"at most {self.at_most} of "
        return "" if self.quantity in (None, "all", there) else f"{self.quantity} of "


class Antecedent(Struct, frozen=True):
    """The filler that a pronoun refers to: the number of its step, from 1, and its role."""

    step: int
    role: str


class Filler(Struct, frozen=True, omit_defaults=True):
    """The filler of a role in a step.

    `text` includes the preposition, and `head` is one of its words. `entities` are the entities that the
    whole description fits: one, all of those of which any will do, or all that are or may be meant. If they
    are empty, the `description` states what to look for. A message in words has neither.
    """

    text: str
    head: str
    entities: tuple[str, ...] = ()
    description: ThingDescription | None = None
    refers: Antecedent | None = None

    @property
    def shown(self) -> str:
        """The entities' names with how many of them are meant, or the words."""
        number = "" if self.description is None else self.description.number_of(len(self.entities))
        return number + "|".join(self.entities) if self.entities else f'"{self.text}"'


class CommandStep(Struct, frozen=True, omit_defaults=True):
    """One action of a command, in the order of the words: a frame, its verb and its roles.

    A `negated` step must not be done. A step with a `condition` or a `time` must not be done unconditionally
    or now. A condition with `not (...)` is that the one in parentheses does not hold.
    """

    frame: str
    verb: str
    roles: dict[str, tuple[Filler, ...]] = {}
    negated: bool = False
    condition: str = ""
    time: str = ""

    @property
    def text(self) -> str:
        """`Taking(Theme=bottle1, Source=table1)`, with `not` before it, and condition and time after it."""
        filled = ", ".join(
            f"{role}={filler.shown}" for role, fillers in self.roles.items() for filler in fillers
        )
        after = "".join(f" [{text}]" for text in (self.condition, self.time) if text)
        return f"{'not ' if self.negated else ''}{self.frame}({filled}){after}"


class Understood(Struct, frozen=True):
    """A parsed command.

    `steps` are its actions in order, each with what it states of things and people. `answer` answers a
    question from the map, or states that one has to look.

    `unknown` are unknown verbs, and `language` is the detected or given language. A `mood` other than
    "command" explains why there are no frames: the text is a question or about the past. `question` is a
    clarification question if arguments are ambiguous. `doubts` are sentences about parts of the command that
    contradict the map: an object is not at its stated source, or there are fewer objects than required.

    `past` has one answer for each question about the past, with its evidence; `answer` is their text.
    """

    words: tuple[str, ...]
    frames: tuple[SemanticFrame, ...]
    groundings: tuple[Grounded, ...]
    unknown: tuple[str, ...] = ()
    language: Language = "english"
    mood: Mood = "command"
    question: str = ""
    doubts: tuple[str, ...] = ()
    steps: tuple[CommandStep, ...] = ()
    answer: str = ""
    past: tuple[PastAnswer, ...] = ()


class Candidate(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An entity that matches a description, with one clause for each part that it matches."""

    entity: str
    class_: str = field(name="class")
    called: str
    reasons: tuple[str, ...] = ()


Outcome = Literal["one", "several", "ambiguous", "none"]


class Found(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The entities that a description denotes, as of commit `seq`.

    `candidates` are the matches (*one*, *several*) or possible matches (*ambiguous*, with a clarification
    `question`). They are sorted by quality, at most 50, and `others` counts the rest. `text` is the outcome
    in one sentence. If there are none, `nearest` are entities that match most of the description, and `gone`
    reports when such an entity last existed. `read_as` are pairs of a misspelt word and its correction.
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
