"""Simulated scenes with ground truth per pixel: things on a table and on the floor, seen by depth cameras."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType

import mujoco
import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.projection import cloud_of
from semmap.nodes.sim_node.models.library import Model, assemble
from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.sim_node.models.parts import Colour, Vec3, rotation_matrix
from semmap.nodes.sim_node.vision.camera import Eye
from semmap.nodes.sim_node.vision.noise import kinect_noise
from semmap.nodes.sim_node.vision.view import View
from semmap.nodes.sim_node.world import World
from semmap.nodes.training.scenes.paint import Paint, painted
from semmap.nodes.training.scenes.varieties import Form
from semmap.schemas.entities import Pose, orientation_from_yaw
from semmap.schemas.scenes import Body, BodyOrder

DISTRACTOR = "strange"
_FOREIGN = "@"
_MASS_KG = 0.4


def foreign_label(name: str, class_: str, *, new: bool) -> str:
    """Return the label of a foreign thing: its name with its class, or with no class if it is new."""
    return f"{name}{_FOREIGN}{'' if new else class_}"


def foreign_class(label: str) -> tuple[str, str] | None:
    """Return the name and class (or "") of a foreign thing, or None for our own models."""
    name, at, class_ = label.partition(_FOREIGN)
    return (name, class_) if at else None


@dataclass(frozen=True)
class Item:
    """One thing to be put into a scene: a model at a size and in a colour, standing at a pose.

    `form` builds one that does not look like its model. `said`: what it is to be taken for, if not for its
    kind. `paint` is put on what the cameras see.
    """

    name: str
    kind: str
    size_m: Vec3
    colour: Colour
    position_m: Vec3
    yaw_rad: float
    form: Form | None = None
    said: str = ""
    paint: Paint | None = None

    @property
    def label(self) -> str:
        """The expected label."""
        return self.said or self.kind


@dataclass(frozen=True)
class Shot:
    """Frames of one scene taken at the same time, and the truth about them.

    `owners`: for each cloud (H, W) the number of the body that a pixel sees, counted from 1 in the order of
    `bodies`, 0 for none.
    """

    clouds: tuple[Cloud, ...]
    owners: tuple[NDArray[np.int32], ...]
    bodies: tuple[Body, ...]


@lru_cache(maxsize=64)
def tinted(item: Item) -> Model:
    """Return the item's model in its size and colour."""
    kind = MODELS.get(item.kind)
    x, y, z = item.size_m
    form = item.form or (kind and kind.parts)
    if form is None:
        raise ValueError(f"{item.kind} has no form")
    return assemble(item.kind, form(x, y, z, item.colour), kind.mass_kg if kind else _MASS_KG)


class Stage:
    """A world in which scenes are set up and rendered one after another."""

    def __init__(self) -> None:
        self._models: dict[str, Model] = {}
        self._world = World(models=lambda name, _: self._models[name])
        self._eye = Eye()

    def show(self, items: Sequence[Item], *, settle_s: float = 0.0) -> tuple[Body, ...]:
        """Replace the scene by these things; with `settle_s` they can fall first."""
        self._world.delete(list(self._models))
        self._models = {item.name: tinted(item) for item in items}
        self._world.spawn(
            [
                BodyOrder(
                    name=item.name,
                    class_=item.kind,
                    model=item.name,
                    pose=Pose(
                        position_m=item.position_m, orientation_wxyz=orientation_from_yaw(item.yaw_rad)
                    ),
                    fixed=settle_s == 0.0,
                    commit=1,
                )
                for item in items
            ]
        )
        if settle_s:
            self._world.step(settle_s)
        return tuple(body for body in self._world.scene().bodies if not body.ghost)

    def paint(self, colours: Mapping[str, Colour], light: float) -> None:
        """Set the colours of the world's geoms (`floor`), and the brightness of the light (about 0.35)."""
        model = self._world.model
        for name, colour in colours.items():
            model.geom_rgba[mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, name), :3] = colour
        model.vis.headlight.ambient[:] = light
        model.vis.headlight.diffuse[:] = light

    def shoot(
        self,
        bodies: Sequence[Body],
        views: Sequence[View],
        rng: np.random.Generator,
        paints: Mapping[str, Paint] = MappingProxyType({}),
    ) -> Shot:
        """Render the scene with sensor noise; bodies with `paints` are painted."""
        clouds, owners = zip(*(self._look(bodies, view, rng, paints) for view in views), strict=True)
        return Shot(clouds, owners, tuple(bodies))

    def _look(
        self, bodies: Sequence[Body], view: View, rng: np.random.Generator, paints: Mapping[str, Paint]
    ) -> tuple[Cloud, NDArray[np.int32]]:
        model, data = self._world.model, self._world.data
        rgb, depth = self._eye.render(model, data, view)
        geoms = self._eye.segment(model, data, view)
        number = {body.name: at for at, body in enumerate(bodies, 1)}
        owners = np.array([number.get(name, 0) for name in self._world.body_names()] + [0], np.int32)[geoms]
        bare = cloud_of(depth, rgb, view.intrinsics, view.map_from_camera)
        for body in bodies:
            where = owners == number[body.name]
            if body.name in paints and where.any():
                _put_on(paints[body.name], rgb, bare, where, body)
        return cloud_of(kinect_noise(depth, rng), rgb, view.intrinsics, view.map_from_camera), owners


def _put_on(paint: Paint, rgb: NDArray[np.uint8], cloud: Cloud, where: NDArray[np.bool_], body: Body) -> None:
    """Paint the pixels of a picture (H, W, 3) that see a body."""
    pose = np.eye(4) if cloud.map_from_camera is None else cloud.map_from_camera
    points = cloud.points_camera[where].astype(float) @ pose[:3, :3].T + pose[:3, 3]
    own = (points - body.pose.position_m) @ rotation_matrix(body.pose.orientation_wxyz)
    half = np.array(body.size_m) / 2.0
    own[:, 2] -= half[2]
    rgb[where] = painted(rgb[where], np.nan_to_num(own / half).astype(np.float32), paint)
