"""Alignments with other vocabularies: their spatial classes, and how they express poses.

Each alignment is a file in `ontology/alignments/`; docs/ontologies.md describes the format. An alignment
applies to a TBox with classes or properties in one of its namespaces.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta, Struct

from semmap.ontology import ALIGNMENTS
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.explanations import Term

_PLAIN = frozenset({"title", "prefixes", "order", "origin", "why"})

Path = Annotated[tuple[Term, ...], Meta(max_length=8)]
"""Properties to follow from an entity to the individual with the value; the smallest object is used."""


class PoseMapping(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How a pose is expressed: at the end of `path`, as text with numbers."""

    path: Path = ()
    position: Term
    """Property: "x y z" [m]."""
    orientation: Term | None = None
    """Property: four numbers, a unit quaternion."""
    order: Literal["xyzw", "wxyz"] = "xyzw"
    origin: Literal["middle", "bottom"] = "middle"
    """The point of the entity at the position: the centre of its box, or of its bottom."""
    relative: Term | None = None
    """Property of a pose that is not in the map frame. Such a pose is not read."""


class SizeMapping(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How a size along the body's axes is expressed: at the end of `path`, one property per axis [m]."""

    path: Path = ()
    x: Term
    y: Term
    z: Term


class NameMapping(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How a name is expressed that is not a text of the entity itself: at the end of `path`."""

    path: Annotated[Path, Meta(min_length=1)]
    text: Term
    """Property: the name."""


class PerceptionMapping(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How events state where they perceived an object; the latest gives its pose when a file is loaded."""

    object: Term
    """Property of the event: the object."""
    pose: Term
    """Property of the event: the individual with the pose, as a matrix or as `PoseMapping` describes."""
    matrix: Term
    """Stem of the properties of the matrix: with row and column, such as `00`, that of a number."""
    relative: Term
    """Property of that individual: something in whose frame the pose is."""
    time: Term
    """Property of the event: a point in time, whose name or value ends with seconds."""


class IgnoredStatement(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A statement of the ontology that is ignored, because it would make every map inconsistent."""

    triple: tuple[Term, Term, Term]
    why: str
    instead: tuple[Term, Term, Term] | None = None
    """The statement to use in its place."""


class Alignment(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """One vocabulary. Terms are IRI terms; in a file they are written with its prefixes, or in `<>`."""

    title: str
    prefixes: dict[str, str]
    namespaces: tuple[str, ...]
    """Prefixes. The alignment applies to a TBox with classes or properties in one of them."""
    things: tuple[Term, ...] = ()
    """Roots of the spatial classes."""
    places: tuple[Term, ...] = ()
    """Roots of the classes of places, which never have a body."""
    solid: tuple[Term, ...] = ()
    """Roots of classes that have bodies although they are below a place, such as a wall."""
    fixed: tuple[Term, ...] = ()
    """Roots of the classes with fixed bodies."""
    names: tuple[Term, ...] = ()
    """Properties with the name of an entity, best first."""
    named: tuple[NameMapping, ...] = ()
    pose: tuple[PoseMapping, ...] = ()
    size: tuple[SizeMapping, ...] = ()
    perceived: tuple[PerceptionMapping, ...] = ()
    helpers: tuple[Term, ...] = ()
    """Classes of the individuals that state poses. A map may use them although the TBox lacks them."""
    set_aside: tuple[IgnoredStatement, ...] = ()
    relations: dict[Literal["isOn", "isInside", "isLocatedIn"], Term] = {}
    """By measurable relation: the property for it in the vocabulary."""

    @property
    def edges(self) -> frozenset[Term]:
        """The properties that lead from an entity to the individuals that describe it."""
        return frozenset(p for path in self._paths for p in path)

    @property
    def _paths(self) -> tuple[Path, ...]:
        placed = (*(words.path for words in self.pose), *(words.path for words in self.size))
        return (*placed, *(words.path for words in self.named))

    @property
    def entry_properties(self) -> frozenset[Term]:
        """The properties of an entity itself from which its pose, size or name is found."""
        poses = {words.path[0] if words.path else words.position for words in self.pose}
        sizes = {p for words in self.size for p in (words.path[:1] or (words.x, words.y, words.z))}
        named = {words.path[0] for words in self.named}
        return frozenset((*poses, *sizes, *named, *self.names, v.RDFS_LABEL))


def find_for_namespaces(namespaces: Iterable[str]) -> tuple[Alignment, ...]:
    """Return the shipped alignments for these namespaces."""
    there = set(namespaces)
    return tuple(known for known in shipped() if not there.isdisjoint(known.namespaces))


@cache
def shipped() -> tuple[Alignment, ...]:
    """Return all shipped alignments in the order of file names."""
    return tuple(read(path.read_text(), path.name) for path in sorted(ALIGNMENTS.glob("*.toml")))


def read(text: str, name: str) -> Alignment:
    """Parse an alignment file. Raises BadFile."""
    try:
        raw = tomllib.loads(text)
        prefixes = msgspec.convert(raw.get("prefixes", {}), dict[str, str])
        return msgspec.convert(_resolved(raw, prefixes), Alignment)
    except (tomllib.TOMLDecodeError, msgspec.ValidationError) as error:
        raise errors.BadFile(f"{name} is not an alignment: {error}") from None
    except KeyError as error:
        raise errors.BadFile(f"{name} is not an alignment: it has no prefix {error}") from None


def _resolved(value: Any, prefixes: Mapping[str, str], key: str = "") -> Any:
    """Return the content of a file with terms for prefixed names."""
    if key in _PLAIN:
        return value
    if isinstance(value, dict):
        return {key: _resolved(part, prefixes, key) for key, part in value.items()}
    if isinstance(value, list):
        return [_resolved(part, prefixes, key) for part in value]
    if not isinstance(value, str) or value.startswith("<"):
        return value
    prefix, _, local = value.partition(":")
    return prefixes[prefix] if key == "namespaces" else v.iri(prefixes[prefix] + local)
