"""What a map states of how far open a thing is, and whether it is on, kept consistent with itself.

There are three properties, each more exact than the one before: whether it is open, how far, and where each
joint stands; and two of switches, whether it is on, and where each of them stands. Who states one of them
takes back what is more exact and was stated earlier; what is less exact follows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from semmap.nodes.kb_node.entities.property_values import plain
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term
from semmap.schemas.joints import OPEN_FROM

_FROM_ROUGH_TO_EXACT: Final = (
    (v.IS_OPEN, v.OPENNESS, v.JOINT_POSITIONS),
    (v.IS_SWITCHED_ON, v.SWITCH_POSITIONS),
)


def implied(
    stated: Mapping[Term, Sequence[Term]], before: Mapping[Term, Sequence[Term]]
) -> dict[Term, list[Term]]:
    """What else is to be stated where `stated` is: values by property, none for what is taken back.

    `before` is what was stated until now.
    """
    new = {p for p in stated if list(stated[p]) != list(before.get(p, ()))}
    found: dict[Term, list[Term]] = {}
    for properties in _FROM_ROUGH_TO_EXACT:
        most_exact = max((rank for rank, p in enumerate(properties) if p in new), default=len(properties))
        outdated = (p for p in properties[most_exact + 1 :] if before.get(p) and p not in stated)
        found.update({p: [] for p in outdated})
    if v.OPENNESS in new and v.IS_OPEN not in stated and len(stated[v.OPENNESS]) == 1:
        share = plain(stated[v.OPENNESS][0])
        if isinstance(share, (int, float)):
            found[v.IS_OPEN] = [v.literal(str(share > OPEN_FROM).lower(), v.XSD_BOOLEAN)]
    return found
