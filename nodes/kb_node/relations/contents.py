"""The contents of an object: all that moves with it, standing on it or inside it, at any depth.

Objects that penetrate each other do not support each other. An example is an armchair pushed into a couch,
even where a part of one touches a part of the other from above. Attached objects move with their holder and
are not contents of anything else.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterator
from typing import NamedTuple

from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import proximity
from semmap.nodes.kb_node.relations.measuring.space import Space


class Carrier(NamedTuple):
    """The object that contains or supports another.

    Of several supports it is the one with the largest share.
    """

    name: str
    is_inside: bool


class Contents:
    """The contents of objects, from the stored `facts` or measured if there are none.

    A place has no contents.
    """

    def __init__(self, space: Space, facts: Facts | None = None) -> None:
        self._space = space
        self._facts = facts
        self._carriers: dict[str, Carrier | None] = {}

    def find_all(self, name: str, leave: Collection[str] = ()) -> list[str]:
        """Return the contents of an object, supports before what they support.

        Objects in `leave`, and those supported only by them, are left out.
        """
        found: dict[str, None] = {}
        waiting = deque([name])
        while waiting:
            for above, _ in self.find_direct(waiting.popleft()):
                if above not in found and above != name and above not in leave:
                    found[above] = None
                    waiting.append(above)
        return list(found)

    def find_direct(self, name: str) -> Iterator[tuple[str, Carrier]]:
        """Yield what stands directly on an object or is inside it, ordered by name."""
        solid = self._space.solids.get(name)
        if solid is None or solid.is_place:
            return
        if self._facts is not None:
            candidates = [other for other in map(self._space.solids.get, self._facts.about(name)) if other]
        else:
            candidates = [o for o in self._space.around(solid) if self._space.may_support(solid, o)]
        for other in sorted(candidates, key=lambda other: other.name):
            if other.name in self._space.holders:
                continue
            carrier = self._carrier(other)
            if carrier is None or carrier.name != name:
                continue
            if carrier.is_inside or not self._overlap(solid, other):
                yield other.name, carrier

    def _overlap(self, solid: Solid, other: Solid) -> bool:
        """Return whether two objects penetrate each other by more than the position tolerance."""
        contact = proximity.touches(solid, other, self._space.limits)
        return contact is not None and contact.gap_m < -self._space.limits.gap_m

    def _carrier(self, solid: Solid) -> Carrier | None:
        if solid.name not in self._carriers:
            self._carriers[solid.name] = self._find_carrier(solid)
        return self._carriers[solid.name]

    def _find_carrier(self, solid: Solid) -> Carrier | None:
        if solid.is_place:
            return None
        if self._facts is not None:
            return next(
                (
                    Carrier(other, relation == "isInside")
                    for relation, other in self._facts.of(solid.name)
                    if relation in ("isInside", "isOn")
                ),
                None,
            )
        container, supports, _ = self._space.spatial_relations(solid)
        if container is not None:
            return Carrier(container[0].name, is_inside=True)
        return Carrier(supports[0][0].name, is_inside=False) if supports else None
