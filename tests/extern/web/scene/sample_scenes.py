"""Entities, bodies and surfaces for the tests of the scene."""

from __future__ import annotations

import numpy as np

from semmap.nodes.extern.web.scene.meshes import cube
from semmap.schemas.entities import BodyState, Entity, Pose, Provenance, orientation_from_yaw
from semmap.schemas.scenes import Body, Scene, Surface

_SAID = Provenance(commit=1, stamp_ns=1, source="operator")


def pose(x=0.0, y=0.0, z=0.0, yaw_rad=0.0) -> Pose:
    return Pose(position_m=(x, y, z), orientation_wxyz=orientation_from_yaw(yaw_rad))


def entity(name, class_="Chair", at=None, size_m=(0.5, 0.5, 1.0), *, place=False, model="chair") -> Entity:
    return Entity(
        name=name,
        class_=class_,
        iri=f"urn:{name}",
        types=(class_,),
        pose=at or pose(),
        size_m=size_m,
        place=place,
        model="" if place else model,
        body=BodyState(status="present", model=model),
        provenance=_SAID,
        pose_provenance=_SAID,
        shape_provenance=_SAID,
        reference_provenance=_SAID,
    )


def body(name, at=None, size_m=(0.5, 0.5, 1.0), *, model="chair", ghost=False, is_entity=True) -> Body:
    return Body(
        name=name,
        class_="Chair",
        model=model,
        pose=at or pose(),
        size_m=size_m,
        fixed=False,
        entity=is_entity,
        ghost=ghost,
        resting=True,
        commit=1,
        shape_commit=1,
    )


def scene(*bodies: Body, run: str = "1") -> Scene:
    return Scene(run=run, version=1, stamp_ns=1, sim_time_s=0.0, world="flat", bodies=bodies)


def surface(size_m=(1.0, 1.0, 1.0)) -> Surface:
    """Return a red box with the origin at its bottom centre."""
    points, triangles = cube()
    normals = np.zeros_like(points)
    colours = np.tile(np.array((255, 0, 0), np.uint8), (len(points), 1))
    return Surface(
        points=(points * size_m).astype("<f4").tobytes(),
        normals=normals.astype("<f4").tobytes(),
        colours=colours.tobytes(),
        triangles=triangles.astype("<u4").tobytes(),
    )
