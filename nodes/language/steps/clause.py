"""A clause of a command: a frame and the phrases that fill its roles."""

from __future__ import annotations

from dataclasses import dataclass, field

from semmap.nodes.language.steps.phrase import NounPhrase


@dataclass(slots=True)
class Role:
    """The filler of a role: noun phrases, or only words with a head."""

    role: str
    first: int
    end: int
    head: int
    phrases: list[NounPhrase] = field(default_factory=list)


@dataclass(slots=True)
class Clause:
    """A frame with its roles, as the words say it."""

    frame: str
    verb: str
    first: int
    roles: list[Role] = field(default_factory=list)
    negated: bool = False
    conditions: list[str] = field(default_factory=list)
    times: list[str] = field(default_factory=list)
    asks: bool = False
    contrasts: bool = False
    """Whether it is to be done although the words before it are negated: not the milk but THE WATER."""

    def role(self, name: str) -> Role | None:
        """Return the first filler of a role."""
        return next((role for role in self.roles if role.role == name), None)


@dataclass(slots=True)
class Parsed:
    """The clauses of a text, the verbs that are unknown and the words that no clause uses."""

    clauses: list[Clause] = field(default_factory=list)
    unknown: list[str] = field(default_factory=list)
    unused: list[str] = field(default_factory=list)
    context: list[tuple[int, NounPhrase]] = field(default_factory=list)
    """Persons that a part which is not understood mentions, each with the number of clauses before it."""
    structural: list[int] = field(default_factory=list)
    """Indices of words that only belong to a construction: show Anna THE WAY to the kitchen."""
    corrected: list[tuple[str, str]] = field(default_factory=list)
    """Words that the speaker took back, each with what is said instead."""
