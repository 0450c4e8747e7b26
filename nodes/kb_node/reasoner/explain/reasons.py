"""The reasons of stored conclusions, which are derived edges and equalities."""

from __future__ import annotations

from typing import NamedTuple

from semmap.nodes.kb_node.reasoner.rules.swrl import SwrlRule
from semmap.nodes.kb_node.reasoner.tbox.axioms import ANY, Role


class Edge(NamedTuple):
    """An edge exists and implies a role between its subject and object (None: its own property)."""

    edge: int
    role: Role | None = None


class Member(NamedTuple):
    """A node belongs to a class, given by its number."""

    node: int
    cls: int


class Same(NamedTuple):
    """Two nodes are the same individual."""

    one: int
    other: int


class Applied(NamedTuple):
    """A SWRL rule of the schema was applied."""

    rule: SwrlRule


Claim = Edge | Member | Same | Applied


def member(node: int, cls: int) -> tuple[Claim, ...]:
    """Return the claim that a node belongs to a class; no claim for the class of everything."""
    return () if cls == ANY else (Member(node, cls),)


class Reason:
    """The claims that together entail a derived edge, or a link between two equal nodes."""

    __slots__ = ("alive", "claims", "edge", "link", "order")

    def __init__(
        self,
        order: int,
        claims: tuple[Claim, ...],
        edge: int | None = None,
        link: tuple[int, int] | None = None,
    ) -> None:
        self.order = order
        """Increases with each conclusion. A conclusion never depends on a later one."""
        self.claims = claims
        self.edge = edge
        self.link = link
        self.alive = True


class Clash(Exception):
    """A contradiction, and the claims that cause it."""

    def __init__(self, *claims: Claim) -> None:
        super().__init__(claims)
        self.claims = claims
