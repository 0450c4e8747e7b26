"""Other people's vocabularies: which of their classes are things in space, and how poses are said in them.

Each is a file of `ontology/alignments/`; docs/ontologies.md says what may stand in one. An alignment holds
for a TBox that has classes or properties in one of its namespaces.
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
"""Properties to follow from an entity to the individual that says it; of several objects the least counts."""


class PoseMapping(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How a pose is said: at the end of `path`, as text of numbers."""

    path: Path = ()
    position: Term
    """Property: "x y z" [m]."""
    orientation: Term | None = None
    """Property: four numbers, a unit quaternion."""
    order: Literal["xyzw", "wxyz"] = "xyzw"
    origin: Literal["middle", "bottom"] = "middle"
    """What of the thing is at the position: the middle of its box, or the middle of its bottom."""
    relative: Term | None = None
    """Property of a pose that is not in the map frame: such a one is not read."""


class SizeMapping(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How an extent along the body's own axes is said: at the end of `path`, a property each [m]."""

    path: Path = ()
    x: Term
    y: Term
    z: Term


class IgnoredStatement(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A statement of the ontology that does not count, because no map could be kept with it."""

    triple: tuple[Term, Term, Term]
    why: str
    instead: tuple[Term, Term, Term] | None = None
    """What counts in its place."""


class Alignment(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """One vocabulary. Terms are IRI terms; in a file they are written with its prefixes, or in `<>`."""

    title: str
    prefixes: dict[str, str]
    namespaces: tuple[str, ...]
    """Prefixes: a TBox with classes or properties in one of them speaks this vocabulary."""
    things: tuple[Term, ...] = ()
    """Roots of the classes of things in space."""
    places: tuple[Term, ...] = ()
    """Roots of the classes of places: they never have a body."""
    solid: tuple[Term, ...] = ()
    """Roots of the classes that have bodies all the same: a wall, where that is below a place."""
    fixed: tuple[Term, ...] = ()
    """Roots of the classes whose bodies stay where they are put."""
    names: tuple[Term, ...] = ()
    """Properties of what people call a thing, the best first."""
    pose: tuple[PoseMapping, ...] = ()
    size: tuple[SizeMapping, ...] = ()
    set_aside: tuple[IgnoredStatement, ...] = ()
    relations: dict[Literal["isOn", "isInside", "isLocatedIn"], Term] = {}
    """Relation that can be measured to the property by which the vocabulary states it."""

    @property
    def edges(self) -> frozenset[Term]:
        """The properties that lead from an entity to the individuals that describe it, and on."""
        return frozenset(p for path in self._paths for p in path)

    @property
    def _paths(self) -> tuple[Path, ...]:
        return (*(words.path for words in self.pose), *(words.path for words in self.size))

    @property
    def entry_properties(self) -> frozenset[Term]:
        """The properties by which an entity itself begins to say where it is, how big, how called."""
        poses = {words.path[0] if words.path else words.position for words in self.pose}
        sizes = {words.path[0] if words.path else words.x for words in self.size}
        return frozenset((*poses, *sizes, *self.names, v.RDFS_LABEL))


def find_for_namespaces(namespaces: Iterable[str]) -> tuple[Alignment, ...]:
    """The shipped alignments of the vocabularies with these namespaces."""
    there = set(namespaces)
    return tuple(known for known in shipped() if not there.isdisjoint(known.namespaces))


@cache
def shipped() -> tuple[Alignment, ...]:
    """All that come with semmap, by file name."""
    return tuple(read(path.read_text(), path.name) for path in sorted(ALIGNMENTS.glob("*.toml")))


def read(text: str, name: str) -> Alignment:
    """The alignment in a file's text. Raises BadFile."""
    try:
        raw = tomllib.loads(text)
        prefixes = msgspec.convert(raw.get("prefixes", {}), dict[str, str])
        return msgspec.convert(_resolved(raw, prefixes), Alignment)
    except (tomllib.TOMLDecodeError, msgspec.ValidationError) as error:
        raise errors.BadFile(f"{name} is not an alignment: {error}") from None
    except KeyError as error:
        raise errors.BadFile(f"{name} is not an alignment: it has no prefix {error}") from None


def _resolved(value: Any, prefixes: Mapping[str, str], key: str = "") -> Any:
    """What a file says, with terms for prefixed names."""
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
