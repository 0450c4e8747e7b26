"""What a map states of who holds a thing, kept consistent with itself: another holder holds it elsewhere."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term


def implied(
    stated: Mapping[Term, Sequence[Term]], before: Mapping[Term, Sequence[Term]]
) -> dict[Term, list[Term]]:
    """What else is to be stated where `stated` is: where it was held, no more, if somebody else holds it now.

    `before` is what was stated until now.
    """
    if v.IS_GRASPED_BY not in stated or v.GRASP_POSE in stated or not before.get(v.GRASP_POSE):
        return {}
    same = list(stated[v.IS_GRASPED_BY]) == list(before.get(v.IS_GRASPED_BY, ()))
    return {} if same else {v.GRASP_POSE: []}
