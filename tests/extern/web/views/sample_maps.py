"""Small maps for the tests of views."""

from __future__ import annotations

from semmap.ontology import vocabulary as v
from semmap.schemas.commits import Commit, PlaceChanges
from semmap.schemas.entities import ClassInfo, Entity, Pose, Provenance

SAID = Provenance(commit=1, stamp_ns=1_000_000_000, source="operator", reason="test")


def thing(name, class_="Cup", *, types=(), at=(0.0, 0.0, 0.0), **fields):
    return Entity(
        name=name,
        class_=class_,
        iri=f"{v.ABOX}{name}",
        types=(class_, *types),
        pose=None if at is None else Pose(position_m=at),
        provenance=SAID,
        pose_provenance=SAID,
        shape_provenance=SAID,
        reference_provenance=SAID,
        **fields,
    )


def place(name, size=(3.0, 3.0, 2.5), **fields):
    return thing(name, "Room", size_m=size, place=True, **fields)


def by_name(*entities):
    return {entity.name: entity for entity in entities}


def fact(subject, relation, other):
    return (v.entity_iri(subject), v.dm(relation), v.entity_iri(other))


def commit(seq=2, *, came=(), went=(), denied=(), undenied=(), **fields):
    places = PlaceChanges(came=tuple(came), went=tuple(went), denied=tuple(denied), undenied=tuple(undenied))
    return Commit(seq=seq, stamp_ns=1, id=str(seq), source="operator", places=places, **fields)


def class_(name, *parents, **fields):
    return ClassInfo(
        name=name,
        iri=f"{v.TBOX}{name}",
        parents=parents,
        ancestors=parents,
        spatial=True,
        place=False,
        fixed=False,
        model="",
        labels=fields.pop("labels", {}),
        **fields,
    )
