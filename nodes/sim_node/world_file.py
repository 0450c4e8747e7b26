"""World files: an MJCF scene, or a scene in JSON on a bare floor."""

from __future__ import annotations

import codecs
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from semmap.nodes.runtime.class_names import ClassNames
from semmap.nodes.sim_node.config import RobotConfig
from semmap.nodes.sim_node.models.parts import rotation_matrix
from semmap.nodes.sim_node.order_validation import ModelSource
from semmap.nodes.sim_node.physics import base_scene
from semmap.nodes.sim_node.physics.build import run_in_background
from semmap.nodes.sim_node.robots.robot import put
from semmap.nodes.sim_node.vision.view import View, look_at, pinhole
from semmap.nodes.sim_node.world import World
from semmap.schemas import codec, scene_files
from semmap.schemas.entities import free_name
from semmap.schemas.errors import BadFile, UnknownClass
from semmap.schemas.scenes import BodyOrder

_PICTURE = (4, 3)
"""How wide and high what a camera sees may be thought to be; only the angle counts here."""


def is_scene(path: Path | None) -> bool:
    """Whether a world file is a scene in JSON, whose bodies are named by class. Raises BadFile."""
    return path is not None and (path.suffix == ".json" or codec.looks_like_json(_read(path)))


def names_classes(path: Path | None) -> bool:
    """Whether it depends on the names of classes what bodies the world of a file has. Raises BadFile."""
    if path is None:
        return False
    return is_scene(path) or base_scene.names_classes(base_scene.read_mjcf(path, compiles=False))


def require_world(path: Path, models: ModelSource, robot: RobotConfig | None = None) -> None:
    """Raises BadFile, as `open_world` does; of an MJCF scene by itself only that it compiles is looked at."""
    if robot is not None or is_scene(path):
        open_world(path, models, robot=robot)
    else:
        base_scene.read_mjcf(path)


def open_world(
    path: Path | None,
    models: ModelSource,
    while_waiting: Callable[[], None] = lambda: None,
    classes: ClassNames | None = None,
    robot: RobotConfig | None = None,
) -> World:
    """The world that a file describes, with a robot if there is one; a bare floor without a file.

    Bodies of a JSON scene are the world's own furniture (commit 0). Each has the model of its class, and
    stays where it is put if its class is fixed, as `classes` say; a class that they do not know has the model
    of its own name. If the scene places no cameras, there is one that sees all of it. `while_waiting` is as
    in `World`. Raises BadFile for a file that is neither MJCF nor a scene, or has a body that cannot be made.
    """
    if path is None:
        return _world(base_scene.bare_floor(), robot, models=models, while_waiting=while_waiting)
    if not is_scene(path):
        ground = run_in_background(lambda: base_scene.read_mjcf(path), while_waiting)
        known = classes or ClassNames()
        how = {"name": path.name, "models": models, "while_waiting": while_waiting, "is_class": known.has}
        return _world(ground, robot, **how)
    scene = scene_files.read(_read(path), path.name)
    views = (
        None if scene.cameras is None else [(camera.name or "", _view(camera)) for camera in scene.cameras]
    )
    floor = base_scene.bare_floor(views)
    world = _world(floor, robot, name=path.name, models=models, while_waiting=while_waiting)
    spawned = world.spawn(_orders(scene.entities, classes or ClassNames()))
    for name, reason in spawned.failed.items():
        raise BadFile(f"{path.name}: {name} cannot be created: {reason}")
    if views is None:
        world.aim_overview_camera()
    return world


def _world(ground: mujoco.MjSpec, robot: RobotConfig | None, **how: Any) -> World:
    """The world on this ground, with a robot if there is one."""
    if robot is not None:
        put(ground, robot)
    world = World(ground, **how)
    if robot is not None:
        world.mark_robot(robot.name)
    return world


def _view(camera: scene_files.Camera) -> View:
    """Where a camera of the file is and what it sees."""
    eye = np.asarray(camera.at)
    if camera.orientation is None:
        return look_at(eye, np.asarray(camera.look_at), *_PICTURE, camera.fovy)
    map_from_camera = np.eye(4)
    map_from_camera[:3, :3] = rotation_matrix(camera.orientation)
    map_from_camera[:3, 3] = eye
    return View(*_PICTURE, pinhole(*_PICTURE, camera.fovy), map_from_camera)


def _orders(described: Iterable[scene_files.Described], classes: ClassNames) -> list[BodyOrder]:
    taken = {item.name for item in described if item.name}
    orders = []
    for item in described:
        name = item.name or free_name(item.class_, taken)
        taken.add(name)
        model, fixed = _shape(item.class_, classes)
        orders.append(
            BodyOrder(
                name=name,
                class_=item.class_,
                model=model,
                pose=scene_files.pose_of(item.at or (0.0, 0.0, 0.0), item.yaw, item.orientation),
                size_m=item.size,
                fixed=fixed,
                commit=0,
            )
        )
    return orders


def _shape(class_name: str, classes: ClassNames) -> tuple[str, bool]:
    """The model of a class, and whether its bodies are fixed."""
    try:
        found = classes.find(class_name)
    except UnknownClass:
        return class_name.lower(), False
    return found.model, found.fixed


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes().removeprefix(codecs.BOM_UTF8)
    except OSError as error:
        raise BadFile(f"{path} cannot be read: {error.strerror}") from None
