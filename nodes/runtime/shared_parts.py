"""What many decoded entities have in common, kept once: a message says it again for each of them."""

from __future__ import annotations

from typing import Final

from msgspec import structs

from schemas.entities import IDENTITY, Entity, Pose, Provenance

_MOST: Final = 10_000
"""Texts, or provenances, remembered; then it begins anew."""


class SharedParts:
    """Classes, words and provenance of entities: equal ones become one object. Halves a map's memory."""

    def __init__(self) -> None:
        self._kinds: dict[tuple[str, tuple[str, ...], str], tuple[str, tuple[str, ...], str]] = {}
        self._texts: dict[str, str] = {}
        self._provenances: dict[int, Provenance] = {}

    def entity(self, entity: Entity) -> Entity:
        """An equal entity that shares its parts with others."""
        kind = (entity.class_, entity.types, entity.model)
        class_, types, model = self._kinds.setdefault(kind, kind)
        return structs.replace(
            entity,
            class_=class_,
            types=types,
            model=model,
            pose=_upright(entity.pose),
            preferred_reference=self._text(entity.preferred_reference),
            provenance=self._provenance(entity.provenance),
            pose_provenance=self._provenance(entity.pose_provenance),
            shape_provenance=self._provenance(entity.shape_provenance),
            reference_provenance=self._provenance(entity.reference_provenance),
        )

    def _text(self, text: str | None) -> str | None:
        if text is None:
            return None
        if len(self._texts) > _MOST:
            self._texts.clear()
        return self._texts.setdefault(text, text)

    def _provenance(self, said: Provenance) -> Provenance:
        """A commit has one provenance, so its number tells."""
        if len(self._provenances) > _MOST:
            self._provenances.clear()
        return self._provenances.setdefault(said.commit, said)


def _upright(pose: Pose | None) -> Pose | None:
    """A pose that is not turned shares its orientation with all others that are not."""
    if pose is None or pose.orientation_wxyz != IDENTITY:
        return pose
    return Pose(position_m=pose.position_m)
