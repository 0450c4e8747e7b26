"""Entities for tests of relations."""

from semmap.ontology.model_shapes import own_size_m
from semmap.schemas.entities import Entity, Pose, Provenance, orientation_from_yaw

PROVENANCE = Provenance(commit=1, stamp_ns=0, source="file")


def thing(name, at, model=None, *, yaw=0.0, turn=None, size=None, place=False, ref=None, types=()):
    """Return an entity. `model` is its name without the number, or "box" for a box of `size`."""
    model = name.rstrip("0123456789") if model is None else model
    return Entity(
        name=name,
        class_=model.title(),
        iri=f"urn:{name}",
        types=(model.title(), *types),
        pose=None if at is None else Pose(position_m=at, orientation_wxyz=turn or orientation_from_yaw(yaw)),
        size_m=size or (None if place else own_size_m(model)),
        place=place,
        model="" if place else model,
        preferred_reference=ref,
        provenance=PROVENANCE,
        pose_provenance=PROVENANCE,
        shape_provenance=PROVENANCE,
        reference_provenance=PROVENANCE,
    )


ROOM = thing("kitchen1", (0.0, 0.0, 0.0), size=(6.0, 6.0, 2.5), place=True, ref="kitchen")
CORNER = thing("corner1", (2.0, 2.0, 0.0), size=(1.5, 1.5, 2.5), place=True)
TABLE = thing("table1", (0.0, 0.0, 0.0), ref="kitchen table")
TOP = TABLE.size_m[2]
