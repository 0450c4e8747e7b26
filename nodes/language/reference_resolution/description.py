"""What a noun phrase says of the thing that it means."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from semmap.schemas.relations import RelationName

Axis = Literal["across", "height", "volume", "tallness", "length", "distance", ""]
"""What an order goes by: from left to right, the height it is at, its size, how far it is."""


@dataclass(frozen=True, slots=True)
class Quality:
    """A value of one of its properties, by the names of the individuals that the word may stand for."""

    said: str
    values: frozenset[str]


@dataclass(frozen=True, slots=True)
class State:
    """A boolean property: open, switched on. Of `holding`: whether anything is in or on it."""

    said: str
    property: str
    value: bool | str


@dataclass(frozen=True, slots=True)
class Sized:
    """Big or small beside its like; sign: -1 for much."""

    said: str
    axis: Axis
    sign: int


@dataclass(frozen=True, slots=True)
class Related:
    """On, in, near ... one of those that a description means; *between* two of them."""

    said: str
    relation: RelationName
    others: tuple[Description, ...]


@dataclass(frozen=True, slots=True)
class Has:
    """With something on or in it."""

    said: str
    other: Description


@dataclass(frozen=True, slots=True)
class Of:
    """Of a place, an owner, a whole, or with such content; as a noun before another, too: kitchen table."""

    said: str
    other: Description
    is_content: bool = False


@dataclass(frozen=True, slots=True)
class Among:
    """One of those that another description means: *except the black one*."""

    said: str
    other: Description


@dataclass(frozen=True, slots=True)
class Owned:
    """Somebody's; without `by` it is the asker's."""

    said: str
    by: Description | None = None


@dataclass(frozen=True, slots=True)
class Affords:
    """Something can be done with it."""

    said: str
    affordances: frozenset[str]


@dataclass(frozen=True, slots=True)
class Unknown:
    """A word that is not known: nothing fits it."""

    said: str


@dataclass(frozen=True, slots=True)
class Not:
    """What fits does not count."""

    said: str
    restriction: Restriction


@dataclass(frozen=True, slots=True)
class AnyOf:
    """One of them fits."""

    restrictions: tuple[Restriction, ...]

    @property
    def said(self) -> str:
        """As it was said."""
        return " or ".join(dict.fromkeys(restriction.said for restriction in self.restrictions))


Restriction = Quality | State | Sized | Related | Has | Of | Among | Owned | Affords | Unknown | Not | AnyOf


@dataclass(frozen=True, slots=True)
class Order:
    """The one that comes first, second, last by something.

    sign: -1 counts from the other end, 0 means the middle; place: counted from 1, or -1 for the last;
    count: how many from there on; to: what a distance is from, without it the viewer.
    """

    said: str
    axis: Axis
    sign: int = 1
    place: int = 1
    count: int = 1
    to: Description | None = None


Head = Literal["noun", "anything", "one", "it"]


@dataclass(frozen=True, slots=True)
class Description:
    """A noun phrase. noun: as it was said, key: in base form; number: how many there are to be.

    Of the heads *anything* stands for all things, *one* for the noun said before, *it* for the thing.
    is_alternative: it is joined to the one before by *or*.
    """

    said: str
    head: Head
    key: str = ""
    noun: str = ""
    is_definite: bool = True
    is_plural: bool = False
    number: int | None = None
    restrictions: tuple[Restriction, ...] = ()
    order: Order | None = None
    is_alternative: bool = False
