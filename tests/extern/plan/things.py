"""Entities to draw."""

import math

from semmap.ontology import vocabulary as v
from semmap.schemas.entities import Entity, Pose, Provenance, orientation_from_yaw

SINCE = Provenance(commit=1, stamp_ns=1, source="file")


def thing(name, class_="Table", at=(0.0, 0.0, 0.0), size=(1.0, 2.0, 0.7), yaw_deg=0.0, **others):
    return Entity(
        name=name,
        class_=class_,
        iri=v.bare(v.entity_iri(name)),
        types=others.pop("types", (class_, "Physical_Thing")),
        pose=Pose(position_m=at, orientation_wxyz=orientation_from_yaw(math.radians(yaw_deg))),
        size_m=size,
        provenance=SINCE,
        pose_provenance=SINCE,
        shape_provenance=SINCE,
        reference_provenance=SINCE,
        **others,
    )


def place(name, at, size, **others):
    return thing(name, "Kitchen", (*at, 0.0), (*size, 2.5), place=True, **others)
