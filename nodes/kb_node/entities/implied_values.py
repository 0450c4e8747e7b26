"""Property values that follow from other stated values: joint states, switches and attachment.

Three properties state how far open an entity is, from coarse to exact: `isOpen`, `openness` and the joint
positions. Two properties state whether it is on: `isSwitchedOn` and the switch positions. Setting one of
them clears the more exact ones and updates the coarser ones.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from semmap.nodes.kb_node.entities.property_values import to_json_value
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term
from semmap.schemas.joints import OPEN_FROM

_FROM_COARSE_TO_EXACT: Final = (
    (v.IS_OPEN, v.OPENNESS, v.JOINT_POSITIONS),
    (v.IS_SWITCHED_ON, v.SWITCH_POSITIONS),
)


def imply_joint_values(
    stated: Mapping[Term, Sequence[Term]], before: Mapping[Term, Sequence[Term]]
) -> dict[Term, list[Term]]:
    """Return the joint and switch properties that change because `stated` is set.

    `before` holds the values stated so far. An empty list in the result means that the property is cleared.
    """
    new = {p for p in stated if list(stated[p]) != list(before.get(p, ()))}
    found: dict[Term, list[Term]] = {}
    for properties in _FROM_COARSE_TO_EXACT:
        most_exact = max((rank for rank, p in enumerate(properties) if p in new), default=len(properties))
        outdated = (p for p in properties[most_exact + 1 :] if before.get(p) and p not in stated)
        found.update({p: [] for p in outdated})
    if v.OPENNESS in new and v.IS_OPEN not in stated and len(stated[v.OPENNESS]) == 1:
        share = to_json_value(stated[v.OPENNESS][0])
        if isinstance(share, (int, float)):
            found[v.IS_OPEN] = [v.literal(str(share > OPEN_FROM).lower(), v.XSD_BOOLEAN)]
    return found


def imply_attachment_values(
    stated: Mapping[Term, Sequence[Term]], before: Mapping[Term, Sequence[Term]]
) -> dict[Term, list[Term]]:
    """Return a cleared grasp pose if `stated` attaches the entity to another frame than `before`."""
    if v.IS_GRASPED_BY not in stated or v.GRASP_POSE in stated or not before.get(v.GRASP_POSE):
        return {}
    same = list(stated[v.IS_GRASPED_BY]) == list(before.get(v.IS_GRASPED_BY, ()))
    return {} if same else {v.GRASP_POSE: []}
