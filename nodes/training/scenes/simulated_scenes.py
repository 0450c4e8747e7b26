"""Simulated scenes whose every pixel is known: things on a table and on the floor, seen by depth cameras."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.input.cloud import Cloud
from nodes.perception_node.input.projection import cloud_of
from nodes.sim_node.models.library import Model, assemble
from nodes.sim_node.models.model_table import MODELS
from nodes.sim_node.models.parts import Colour, Vec3
from nodes.sim_node.vision.camera import Eye
from nodes.sim_node.vision.noise import kinect_noise
from nodes.sim_node.vision.view import View
from nodes.sim_node.world import World
from schemas.entities import Pose, orientation_from_yaw
from schemas.scenes import Body, BodyOrder

STRANGE = "strange"


@dataclass(frozen=True)
class Item:
    """One thing to be put into a scene: a model at a size and in a colour, standing at a pose.

    A `strange` one is so far from what its model should be that nobody is to recognise it.
    """

    name: str
    kind: str
    size_m: Vec3
    colour: Colour
    position_m: Vec3
    yaw_rad: float
    strange: bool = False

    @property
    def label(self) -> str:
        """What it is to be taken for."""
        return STRANGE if self.strange else self.kind


@dataclass(frozen=True)
class Shot:
    """Frames of one scene taken at the same time, and the truth about them.

    `owners`: for each cloud (H, W) the number of the body that a pixel sees, counted from 1 in the order of
    `bodies`, 0 for none.
    """

    clouds: tuple[Cloud, ...]
    owners: tuple[NDArray[np.int32], ...]
    bodies: tuple[Body, ...]


def tinted(item: Item) -> Model:
    """The item's model at its size, in its colour."""
    kind = MODELS[item.kind]
    x, y, z = item.size_m
    return assemble(item.kind, kind.parts(x, y, z, item.colour), kind.mass_kg)


class Stage:
    """One world in which scene after scene is set up and photographed."""

    def __init__(self) -> None:
        self._models: dict[str, Model] = {}
        self._world = World(models=lambda name, _: self._models[name])
        self._eye = Eye()

    def show(self, items: Sequence[Item], *, settle_s: float = 0.0) -> tuple[Body, ...]:
        """Put these things up instead of those before; with `settle_s` they are free to fall first."""
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
        """Colours of the world's own geoms (`floor`), and how bright the light is (about 0.35)."""
        model = self._world.model
        for name, colour in colours.items():
            model.geom_rgba[mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, name), :3] = colour
        model.vis.headlight.ambient[:] = light
        model.vis.headlight.diffuse[:] = light

    def shoot(self, bodies: Sequence[Body], views: Sequence[View], rng: np.random.Generator) -> Shot:
        """What cameras with a real sensor's faults see of the scene."""
        clouds, owners = zip(*(self._look(bodies, view, rng) for view in views), strict=True)
        return Shot(clouds, owners, tuple(bodies))

    def _look(
        self, bodies: Sequence[Body], view: View, rng: np.random.Generator
    ) -> tuple[Cloud, NDArray[np.int32]]:
        model, data = self._world.model, self._world.data
        rgb, depth = self._eye.see(model, data, view)
        geoms = self._eye.segment(model, data, view)
        number = {body.name: at for at, body in enumerate(bodies, 1)}
        owner = np.array([number.get(name, 0) for name in self._world.body_names()] + [0], np.int32)
        cloud = cloud_of(kinect_noise(depth, rng), rgb, view.intrinsics, view.map_from_camera)
        return cloud, owner[geoms]
