"""Messages for tests."""

import numpy as np

from semmap.ontology import vocabulary as v
from semmap.schemas.commits import Commit, Departed, Star
from semmap.schemas.entities import Entity, Pose, Provenance
from semmap.schemas.scenes import Body, Poses, Scene, Surface

SINCE = Provenance(commit=1, stamp_ns=1, source="file")
START_NS = 1_700_000_000_000_000_000


def pose(x=0.0, y=0.0, z=0.0, wxyz=(1.0, 0.0, 0.0, 0.0)):
    return Pose(position_m=(x, y, z), orientation_wxyz=wxyz)


def entity(name, class_="Chair", at=None, **others):
    return Entity(
        name=name,
        class_=class_,
        iri=v.bare(v.entity_iri(name)),
        types=(class_,),
        pose=at or pose(),
        **others,
        provenance=SINCE,
        pose_provenance=SINCE,
        shape_provenance=SINCE,
        reference_provenance=SINCE,
    )


def body(name, at=None, **others):
    about = {"class_": "Chair", "model": "", "fixed": False, "entity": True, "ghost": False}
    return Body(
        name=name,
        pose=at or pose(),
        size_m=(0.5, 0.5, 1.0),
        resting=True,
        commit=1,
        shape_commit=1,
        **(about | others),
    )


def surface():
    """Return one red triangle."""
    return Surface(
        points=np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], dtype="<f4").tobytes(),
        normals=np.tile(np.array([0, 0, 1], dtype="<f4"), 3).tobytes(),
        colours=bytes([200, 0, 0] * 3),
        triangles=np.arange(3, dtype="<u4").tobytes(),
    )


def scene(*bodies, version=1):
    return Scene(
        run="r", version=version, stamp_ns=START_NS, sim_time_s=1.0, world="flat", bodies=tuple(bodies)
    )


def poses(at_by_name, version=1, sim_time_s=2.0):
    rows = [(*at.position_m, *at.orientation_wxyz) for at in at_by_name.values()]
    return Poses(
        run="r",
        version=version,
        stamp_ns=START_NS + round(sim_time_s * 1e9),
        sim_time_s=sim_time_s,
        names=tuple(at_by_name),
        poses=tuple(number for row in rows for number in row),
        resting=(False,) * len(rows),
        commits=(1,) * len(rows),
    )


def relation(subject, name, object_):
    return (v.entity_iri(subject), v.dm(name), v.entity_iri(object_))


def commit(seq, *changed, removed=(), inserted=(), retracted=(), **others):
    return Commit(
        seq=seq,
        stamp_ns=START_NS + seq * 1_000_000_000,
        id=f"id-{seq}",
        source="operator",
        changed=changed,
        removed=tuple(Departed(name=name, types=("Chair",)) for name in removed),
        inserted=inserted,
        retracted=retracted,
        **others,
    )


def star(name, *own, seq=1):
    return Star(seq=seq, name=name, iri=v.entity_iri(name), own=own, incoming=())
