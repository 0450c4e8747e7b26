"""What a conclusion rests on, kept for the few conclusions that are stored: derived edges and equalities."""

from __future__ import annotations

from typing import NamedTuple

from semmap.nodes.kb_node.reasoner.tbox.axioms import ANY, Role


class Edge(NamedTuple):
    """An edge is there, and implies a role between its subject and object (None: its own property's)."""

    edge: int
    role: Role | None = None


class Member(NamedTuple):
    """A node belongs to a class, by its number."""

    node: int
    cls: int


class Same(NamedTuple):
    """Two nodes are the same individual."""

    one: int
    other: int


Claim = Edge | Member | Same


def member(node: int, cls: int) -> tuple[Claim, ...]:
    """That a node belongs to a class, unless that says nothing."""
    return () if cls == ANY else (Member(node, cls),)


class Reason:
    """Claims that together made a derived edge, or a link between two nodes that are the same."""

    __slots__ = ("alive", "claims", "edge", "link", "order")

    def __init__(
        self,
        order: int,
        claims: tuple[Claim, ...],
        edge: int | None = None,
        link: tuple[int, int] | None = None,
    ) -> None:
        self.order = order
        """Later conclusions have greater numbers, and no conclusion rests on a later one."""
        self.claims = claims
        self.edge = edge
        self.link = link
        self.alive = True


class Clash(Exception):
    """A contradiction, and the claims that make it."""

    def __init__(self, *claims: Claim) -> None:
        super().__init__(claims)
        self.claims = claims
