"""Rendered tables of third-party objects, with the textures of their meshes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from semmap.nodes.sim_node.vision.camera import Eye
from semmap.nodes.sim_node.vision.noise import kinect_noise
from semmap.nodes.sim_node.vision.view import View, look_at
from semmap.nodes.training.scenes.foreign_things import ForeignThing
from semmap.nodes.training.scenes.placements import spread

WIDTH, HEIGHT = 640, 480
TOGETHER = 8
_TABLE_M = (1.0, 1.4)
_NEAR_M, _FAR_M = (0.8, 1.2), (1.6, 2.1)
_FOVY_RAD = (0.78, 1.0)
_BEDDED_M = 0.0005


@dataclass(frozen=True)
class Stood:
    """A placed thing: bottom centre [m] and yaw [rad]."""

    thing: ForeignThing
    x: float
    y: float
    z: float
    yaw: float


def scenes(
    things: Sequence[ForeignThing], alone: int, mixed: int, rng: np.random.Generator
) -> Iterator[tuple[str, list[Stood]]]:
    """Yield each thing alone `alone` times, and `mixed` tables of several things."""
    for thing in things:
        for _ in range(alone):
            x, y = rng.uniform(-0.15, 0.15, 2).tolist()
            yield "alone", [Stood(thing, x, y, _height(rng), float(rng.uniform(-math.pi, math.pi)))]
    for _ in range(mixed):
        some = [things[n] for n in rng.choice(len(things), TOGETHER, replace=False)]
        places = spread([t.size_m for t in some], (0.7, 0.9), 0.03, rng)
        z, pairs = _height(rng), zip(some, places, strict=True)
        yield "mixed", [Stood(t, place[0], place[1], z, place[4]) for t, place in pairs if place is not None]


def distance_m(number: int, rng: np.random.Generator) -> float:
    """Return the range of distances of a frame; every second one is from near."""
    return float(rng.uniform(*(_NEAR_M if number % 2 == 0 else _FAR_M)))


def _height(rng: np.random.Generator) -> float:
    return float(rng.uniform(0.5, 0.9))


class Studio:
    """Renders tables of things."""

    def __init__(self) -> None:
        self._eye = Eye()

    def shoot(
        self, stood: Sequence[Stood], distance_m: float, rng: np.random.Generator
    ) -> tuple[View, NDArray[np.uint8], NDArray[np.float32], NDArray[np.uint8]]:
        """Return the view, rgb (H, W, 3), noisy depth (H, W) [m], and object numbers (H, W), 0 for none."""
        model = _compiled(stood, rng)
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        azimuth, elevation = rng.uniform(-math.pi, math.pi), rng.uniform(0.45, 1.05)
        back = np.array([math.cos(azimuth), math.sin(azimuth), math.tan(elevation)]) * math.cos(elevation)
        middle = np.mean([(one.x, one.y, one.z) for one in stood], axis=0)
        target = middle + rng.normal(0.0, 0.04, 3)
        view = look_at(target + distance_m * back, target, WIDTH, HEIGHT, float(rng.uniform(*_FOVY_RAD)))
        rgb, depth = self._eye.render(model, data, view)
        geoms = self._eye.segment(model, data, view)
        owner = np.zeros(model.ngeom + 1, np.uint8)
        for geom in range(model.ngeom):
            name = model.body(model.geom_bodyid[geom]).name
            owner[geom] = int(name.removeprefix("thing")) if name.startswith("thing") else 0
        return view, rgb, kinect_noise(depth, rng), owner[geoms]


def _compiled(stood: Sequence[Stood], rng: np.random.Generator) -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    spec.visual.headlight.ambient[:] = spec.visual.headlight.diffuse[:] = rng.uniform(0.3, 0.45)
    spec.visual.headlight.specular[:] = 0.05
    floor, table = (np.append(rng.uniform(0.15, 0.9, 3), 1.0) for _ in range(2))
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[6, 6, 0.1], rgba=floor)
    x, y = _TABLE_M
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_BOX, size=[x / 2, y / 2, 0.02], pos=[0, 0, stood[0].z - 0.02], rgba=table
    )
    for number, one in enumerate(stood, 1):
        _add(spec, one, number)
    return spec.compile()


def _add(spec: mujoco.MjSpec, one: Stood, number: int) -> None:
    """Return a thing's parts with their textures."""
    import trimesh

    body = spec.worldbody.add_body(
        name=f"thing{number}",
        pos=[one.x, one.y, one.z - _BEDDED_M],
        quat=[math.cos(one.yaw / 2), 0, 0, math.sin(one.yaw / 2)],
    )
    parts = trimesh.load_scene(one.thing.mesh).dump()
    low = np.min([part.bounds[0] for part in parts], axis=0)
    high = np.max([part.bounds[1] for part in parts], axis=0)
    middle = (low + high) / 2.0
    for n, part in enumerate(parts):
        name = f"{number}-{n}"
        vertices = np.asarray(part.vertices) - [middle[0], middle[1], low[2]]
        mesh = spec.add_mesh(name=name, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL)
        mesh.uservert, mesh.userface = vertices.ravel(), np.asarray(part.faces).ravel()
        geom = body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, contype=0, conaffinity=0)
        image, rgba = _look(part)
        geom.rgba = rgba
        if image is not None:
            mesh.usertexcoord = (np.asarray(part.visual.uv) * [1, -1] + [0, 1]).ravel()
            texture = spec.add_texture(name=name, type=mujoco.mjtTexture.mjTEXTURE_2D)
            texture.width, texture.height, texture.nchannel = image.width, image.height, 3
            texture.data = np.asarray(image).tobytes()
            material = spec.add_material(name=name, specular=0.1)
            material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name
            geom.material = name


def _look(part: Any) -> tuple[Image.Image | None, list[float]]:
    """Return a part's texture and colour."""
    material = getattr(part.visual, "material", None)
    image = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
    if image is not None and getattr(part.visual, "uv", None) is not None:
        return image.convert("RGB"), [1.0, 1.0, 1.0, 1.0]
    colour = getattr(material, "main_color", np.array([168, 168, 168, 255]))
    return None, [*(np.asarray(colour[:3], float) / 255.0).tolist(), 1.0]
