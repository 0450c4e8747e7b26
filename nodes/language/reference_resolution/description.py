"""The parsed form of a noun phrase."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from semmap.schemas.relations import RelationName

Axis = Literal["across", "height", "volume", "tallness", "length", "mass", "distance", ""]
"""The quantity to sort by: position from left to right, height, size, mass or distance."""


@dataclass(frozen=True, slots=True)
class Quality:
    """A property value, such as a colour; `values` are the individuals that the word may denote."""

    text: str
    values: frozenset[str]


@dataclass(frozen=True, slots=True)
class State:
    """A boolean property, such as open or switched on; `holding` means that something is in or on it."""

    text: str
    property: str
    value: bool | str


@dataclass(frozen=True, slots=True)
class Sized:
    """Big or small compared with other objects of its kind; `sign` is -1 for big."""

    text: str
    axis: Axis
    sign: int


@dataclass(frozen=True, slots=True)
class Related:
    """A spatial relation (on, in, near ...) to a described object; *between* has two."""

    text: str
    relation: RelationName
    others: tuple[Description, ...]


@dataclass(frozen=True, slots=True)
class Has:
    """The object has another one on or in it."""

    text: str
    other: Description


@dataclass(frozen=True, slots=True)
class Of:
    """Belongs to a place, an owner or a whole, or has this content; also for compounds: kitchen table."""

    text: str
    other: Description
    is_content: bool = False


@dataclass(frozen=True, slots=True)
class Among:
    """One of the objects that another description denotes: *except the black one*."""

    text: str
    other: Description


@dataclass(frozen=True, slots=True)
class Owned:
    """Owned by `by`, or by the asker if `by` is None."""

    text: str
    by: Description | None = None


@dataclass(frozen=True, slots=True)
class FromViewer:
    """Where the object is as seen by the viewer: behind me, near me, on my left."""

    text: str
    relation: RelationName


@dataclass(frozen=True, slots=True)
class Called:
    """The object has this label or name, in base form: the cup called red cup."""

    text: str
    key: str


@dataclass(frozen=True, slots=True)
class OneOf:
    """The object is one of the candidates of a clarification question."""

    text: str
    names: frozenset[str]


@dataclass(frozen=True, slots=True)
class Affords:
    """The object has one of these affordances."""

    text: str
    affordances: frozenset[str]


@dataclass(frozen=True, slots=True)
class Unknown:
    """An unknown word, which no object matches."""

    text: str


@dataclass(frozen=True, slots=True)
class Not:
    """The negation of a restriction."""

    text: str
    restriction: Restriction


@dataclass(frozen=True, slots=True)
class AnyOf:
    """At least one of the restrictions holds."""

    restrictions: tuple[Restriction, ...]

    @property
    def text(self) -> str:
        """The text of all alternatives."""
        return " or ".join(dict.fromkeys(restriction.text for restriction in self.restrictions))


Restriction = (
    Quality
    | State
    | Sized
    | Related
    | FromViewer
    | Called
    | OneOf
    | Has
    | Of
    | Among
    | Owned
    | Affords
    | Unknown
    | Not
    | AnyOf
)


@dataclass(frozen=True, slots=True)
class Order:
    """A rank (first, second, last) along an axis.

    `sign` is -1 to count from the other end, and 0 for the middle. `place` starts at 1; -1 is the last.
    `count` objects are selected from there on. Distances are measured from `to`, or else from the viewer.
    """

    text: str
    axis: Axis
    sign: int = 1
    place: int = 1
    count: int = 1
    to: Description | None = None


Head = Literal["noun", "anything", "one", "it"]


@dataclass(frozen=True, slots=True)
class Description:
    """A noun phrase: `noun` as written, `key` its base form, `number` the required number of objects.

    The head *anything* stands for all objects, *one* for the previous noun, *it* for the previous object.
    `is_alternative` marks a phrase that *or* joins to the previous one.
    """

    text: str
    head: Head
    key: str = ""
    noun: str = ""
    is_definite: bool = True
    is_plural: bool = False
    number: int | None = None
    restrictions: tuple[Restriction, ...] = ()
    order: Order | None = None
    is_alternative: bool = False
