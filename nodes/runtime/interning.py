"""Interns the common parts of decoded entities, because each message repeats them."""

from __future__ import annotations

from typing import Final

from msgspec.structs import force_setattr as _set

from semmap.schemas.entities import IDENTITY, Entity, Provenance

_MOST: Final = 10_000
"""Largest number of stored texts, or provenances; then the store is cleared."""


class EntityInterner:
    """Shares equal classes, texts and provenance between entities; halves the memory of a map."""

    def __init__(self) -> None:
        self._kinds: dict[tuple[str, tuple[str, ...], str], tuple[str, tuple[str, ...], str]] = {}
        self._texts: dict[str, str] = {}
        self._provenances: dict[int, Provenance] = {}

    def entity(self, entity: Entity) -> Entity:
        """Make an entity share its parts with others, and return it.

        The entity is changed in place, because a copy takes several times as long. It must have been decoded
        just before, and no other thread may use it in the meantime.
        """
        kind = (entity.class_, entity.types, entity.model)
        shared = self._kinds.setdefault(kind, kind)
        if shared is not kind:
            class_, types, model = shared
            _set(entity, "class_", class_)
            _set(entity, "types", types)
            _set(entity, "model", model)
        pose, reference = entity.pose, entity.preferred_reference
        if pose is not None and pose.orientation_wxyz == IDENTITY:
            _set(pose, "orientation_wxyz", IDENTITY)
        if reference is not None:
            _set(entity, "preferred_reference", self._text(reference))
        whole, pose_s = self._provenance(entity.provenance), entity.pose_provenance
        shape_s, reference_s, seq = entity.shape_provenance, entity.reference_provenance, whole.commit
        of = self._provenance  # most entities come from a single commit
        _set(entity, "provenance", whole)
        _set(entity, "pose_provenance", whole if pose_s.commit == seq else of(pose_s))
        _set(entity, "shape_provenance", whole if shape_s.commit == seq else of(shape_s))
        _set(entity, "reference_provenance", whole if reference_s.commit == seq else of(reference_s))
        if (joint_s := entity.joint_provenance) is not None:
            _set(entity, "joint_provenance", whole if joint_s.commit == seq else of(joint_s))
        if (switch_s := entity.switch_provenance) is not None:
            _set(entity, "switch_provenance", whole if switch_s.commit == seq else of(switch_s))
        if (grip_s := entity.grip_provenance) is not None:
            _set(entity, "grip_provenance", whole if grip_s.commit == seq else of(grip_s))
        return entity

    def _text(self, text: str) -> str:
        if len(self._texts) > _MOST:
            self._texts.clear()
        return self._texts.setdefault(text, text)

    def _provenance(self, provenance: Provenance) -> Provenance:
        """Return the shared provenance; the commit number identifies it."""
        if len(self._provenances) > _MOST:
            self._provenances.clear()
        return self._provenances.setdefault(provenance.commit, provenance)
