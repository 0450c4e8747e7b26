"""What a TBox says, in numbers: roles, chains, limits, keys, and the axioms of one property.

A *role* is a property read forwards or backwards: `(q, False)` of an edge x-y is x q y, `(q, True)` is y q x.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from semmap.nodes.kb_node.reasoner.explanations import Term

Role = tuple[int, bool]
"""A property's number, and whether it is read backwards."""

ANY = -1
"""In the place of a class: everything."""
WIDE = 12
"""Properties of a group beyond which nobody looks for their edges one by one."""
SAME, DIFFERENT = 0, 1
"""The numbers of owl:sameAs and owl:differentFrom among the properties."""


@dataclass(frozen=True, slots=True)
class Group:
    """How the individuals related to one by a role are found: along which of its edges."""

    out: tuple[int, ...]
    into: tuple[int, ...]
    is_wide: bool = field(init=False, compare=False)
    """Whether it is quicker to look at all edges of a node than for those of each property."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "is_wide", len(self.out) + len(self.into) > WIDE)


@dataclass(frozen=True, slots=True)
class Limit:
    """At most one value: of `role`, for members of `owner`, among members of `filler` (or ANY)."""

    role: Role
    owner: int
    filler: int


@dataclass(frozen=True, slots=True)
class Key:
    """Members of a class that agree on all properties are one individual (prp-key)."""

    owner: int
    properties: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Chain:
    """x first y and y second z make x result z (prp-spo2, prp-trp); each is a property's number."""

    first: int
    second: int
    result: int


@dataclass
class Axioms:
    """What is said of one property; classes are numbers, ANY where there is no restriction."""

    term: Term
    domain: int = 0
    range: int = 0
    some: list[tuple[int, int]] = field(default_factory=list)
    """(restriction, filler): relating to a filler makes a member."""
    only: list[tuple[int, int]] = field(default_factory=list)
    """(restriction, filler): what members relate to is a filler."""
    none: list[tuple[int, int]] = field(default_factory=list)
    """(restriction, filler): members relate to no filler."""
    limits: list[Limit] = field(default_factory=list)
    keys: list[Key] = field(default_factory=list)
    exclusive: set[Role] = field(default_factory=set)
    """Roles that never hold beside this property between the same two individuals."""
    irreflexive: bool = False


class NotCompilable(Exception):
    """The graph uses the vocabulary in a way that the compiled engine does not know (OWL Full)."""
