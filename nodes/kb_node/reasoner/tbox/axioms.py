"""Compiled axioms: roles, chains, limits, keys, and the axioms of one property.

A *role* is a property or its inverse: for an edge x-y, `(q, False)` is x q y and `(q, True)` is y q x.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from semmap.nodes.kb_node.reasoner.explanations import Term
from semmap.nodes.kb_node.reasoner.terms import DIFFERENT_FROM, SAME_AS, TYPE, is_named

Role = tuple[int, bool]
"""The number of a property, and whether it is read backwards."""

ANY = -1
"""The pseudo class of everything."""
PROPERTIES_WITH_MEANING = frozenset((TYPE, SAME_AS, DIFFERENT_FROM))
"""The properties with rules about individuals. Their subproperties imply them (prp-spo1)."""
WIDE = 12
"""Number of properties in a group above which all edges of a node are scanned."""
SAME, DIFFERENT = 0, 1
"""The property numbers of owl:sameAs and owl:differentFrom."""


@dataclass(frozen=True, slots=True)
class Group:
    """The edges along which a role leads: outgoing and incoming ones, by property."""

    out: tuple[int, ...]
    into: tuple[int, ...]
    is_wide: bool = field(init=False, compare=False)
    """Whether it is faster to scan all edges of a node than to look up each property."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "is_wide", len(self.out) + len(self.into) > WIDE)


@dataclass(frozen=True, slots=True)
class Limit:
    """At most one value of `role` in `filler` (or ANY) for members of `owner`."""

    role: Role
    owner: int
    filler: int


@dataclass(frozen=True, slots=True)
class Key:
    """Members of a class with common values of all properties are the same individual (prp-key)."""

    owner: int
    properties: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Chain:
    """x first y and y second z imply x result z (prp-spo2, prp-trp). Each is a property number."""

    first: int
    second: int
    result: int


@dataclass
class Axioms:
    """The axioms of one property. Classes are numbers, or ANY for no restriction."""

    term: Term
    domain: int = 0
    range: int = 0
    some: list[tuple[int, int]] = field(default_factory=list)
    """(restriction, filler): a value in the filler implies the restriction."""
    only: list[tuple[int, int]] = field(default_factory=list)
    """(restriction, filler): all values of members are in the filler."""
    none: list[tuple[int, int]] = field(default_factory=list)
    """(restriction, filler): members have no value in the filler."""
    limits: list[Limit] = field(default_factory=list)
    keys: list[Key] = field(default_factory=list)
    exclusive: set[Role] = field(default_factory=set)
    """Roles that exclude this property between the same two individuals."""
    irreflexive: bool = False
    is_shown: bool = field(init=False)
    """Whether implied edges are returned as inferred triples: auxiliary properties are not, and types and
    equalities are found otherwise."""

    has_meaning: bool = field(init=False)
    """Whether the rules are about the property itself: rdf:type, owl:sameAs or owl:differentFrom."""

    def __post_init__(self) -> None:
        self.is_shown = is_named(self.term) and " " not in self.term and self.term not in (TYPE, SAME_AS)
        self.has_meaning = self.term in PROPERTIES_WITH_MEANING


class NotCompilable(Exception):
    """The graph uses the vocabulary in a way that the compiled engine does not support (OWL Full)."""
