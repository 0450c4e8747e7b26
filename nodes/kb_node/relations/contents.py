"""What goes along when a thing is carried away: all that stands on it or is inside it, and so on upward.

Not what reaches deep into it: of two things whose shapes overlap, as those of an armchair pushed into a couch
do, neither rests on the other, even where some part of one meets a part of the other from above. Nor what
something holds: that goes where its holder goes.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterator
from typing import NamedTuple

from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import measures
from semmap.nodes.kb_node.relations.measuring.space import Space


class Carrier(NamedTuple):
    """What a thing is inside, or else stands on; of several supports that which counts most."""

    name: str
    is_inside: bool


class Contents:
    """What things bear: as `facts` are kept of them or, without any, as they stand. A place bears nothing."""

    def __init__(self, space: Space, facts: Facts | None = None) -> None:
        self._space = space
        self._facts = facts
        self._bearers: dict[str, Carrier | None] = {}

    def find_all(self, name: str, leave: Collection[str] = ()) -> list[str]:
        """What a thing bears, what bears before what is borne; without `leave` and what only that bears."""
        found: dict[str, None] = {}
        waiting = deque([name])
        while waiting:
            for above, _ in self.find_direct(waiting.popleft()):
                if above not in found and above != name and above not in leave:
                    found[above] = None
                    waiting.append(above)
        return list(found)

    def find_direct(self, name: str) -> Iterator[tuple[str, Carrier]]:
        """What stands on a thing itself, or is inside it, in the order of names."""
        solid = self._space.solids.get(name)
        if solid is None or solid.is_place:
            return
        if self._facts is not None:
            beside = [other for other in map(self._space.solids.get, self._facts.about(name)) if other]
        else:
            beside = [o for o in self._space.around(solid) if self._space.may_support(solid, o)]
        for other in sorted(beside, key=lambda other: other.name):
            if other.name in self._space.holders:
                continue
            bearer = self._bearer(other)
            if bearer is None or bearer.name != name:
                continue
            if bearer.is_inside or not self._overlap(solid, other):
                yield other.name, bearer

    def _overlap(self, solid: Solid, other: Solid) -> bool:
        """Whether two reach into one another by more than what rests may be off."""
        contact = measures.touches(solid, other, self._space.limits)
        return contact is not None and contact.gap_m < -self._space.limits.gap_m

    def _bearer(self, solid: Solid) -> Carrier | None:
        if solid.name not in self._bearers:
            self._bearers[solid.name] = self._looked_up(solid)
        return self._bearers[solid.name]

    def _looked_up(self, solid: Solid) -> Carrier | None:
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
