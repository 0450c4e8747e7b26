"""World files: an MJCF scene, or a JSON scene on a bare floor."""

from __future__ import annotations

import codecs
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from semmap.nodes.runtime.class_names import ClassNames
from semmap.nodes.sim_node.body_classes import BodyClasses
from semmap.nodes.sim_node.config import RobotConfig
from semmap.nodes.sim_node.models.parts import rotation_matrix
from semmap.nodes.sim_node.order_validation import ModelSource
from semmap.nodes.sim_node.physics import base_scene
from semmap.nodes.sim_node.physics.build import run_in_background
from semmap.nodes.sim_node.robots.robot import add_robot
from semmap.nodes.sim_node.vision.view import View, look_at, pinhole
from semmap.nodes.sim_node.world import World
from semmap.schemas import codec, scene_files
from semmap.schemas.entities import free_name
from semmap.schemas.errors import BadFile, UnknownClass
from semmap.schemas.scenes import BodyOrder

_IMAGE = (4, 3)
"""Image size assumed for a camera; only the angle matters."""


def is_scene(path: Path | None) -> bool:
    """Return whether a world file is a JSON scene, whose bodies are named by class. Raises BadFile."""
    return path is not None and (path.suffix == ".json" or codec.looks_like_json(_read(path)))


def names_classes(path: Path | None) -> bool:
    """Return whether the bodies of a world file depend on names of classes. Raises BadFile."""
    if path is None:
        return False
    return is_scene(path) or base_scene.names_classes(base_scene.read_mjcf(path, compiles=False))


def require_world(path: Path, models: ModelSource, robot: RobotConfig | None = None) -> None:
    """Raise BadFile as `open_world` does. An MJCF scene without a robot is only compiled."""
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
    class_map: Mapping[str, str] | None = None,
) -> World:
    """Open the world of a file, with an optional robot; a bare floor without a file.

    Bodies of a JSON scene are furniture of the world (commit 0). Each has the model of its class, and is
    fixed if its class is, according to `classes`; an unknown class has the model of its own name. If the
    scene has no cameras, one that sees all of it is added. `class_map` has the classes of bodies of an MJCF
    scene, by name. `while_waiting` is as in `World`. Raises BadFile for an invalid file, an unknown class, or
    a body that cannot be created.
    """
    if path is None:
        return _world(base_scene.bare_floor(), robot, models=models, while_waiting=while_waiting)
    if not is_scene(path):
        ground = run_in_background(lambda: base_scene.read_mjcf(path), while_waiting)
        _name_single_body(ground, path)
        found = _body_classes(classes or ClassNames(), class_map or {})
        how = {"name": path.name, "models": models, "while_waiting": while_waiting, "classes": found}
        return _world(ground, robot, **how)
    scene = scene_files.read(_read(path), path.name)
    for number, item in enumerate(scene.entities, start=1):
        if item.on or item.in_ or item.next_to:
            raise BadFile(
                f"{path.name}: entity {item.name or number}: on, in and next_to place objects of a map; in a"
                " world give at"
            )
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
    """Return the world on this ground, with an optional robot."""
    if robot is not None:
        add_robot(ground, robot)
    world = World(ground, **how)
    if robot is not None:
        world.mark_robot(robot.name)
    return world


def _body_classes(classes: ClassNames, class_map: Mapping[str, str]) -> BodyClasses:
    """Return the classes of bodies by their names. Raises BadFile for an unknown class in `class_map`."""
    known = classes.by_name
    try:
        named = {name: classes.find(word).name if known else word for name, word in class_map.items()}
    except UnknownClass as error:
        raise BadFile(f"--class-map: {error.text}") from None
    return BodyClasses(known.values(), named)


def _name_single_body(ground: mujoco.MjSpec, path: Path) -> None:
    """Name the only body of a file like the file, if it has no name."""
    bodies = ground.worldbody.bodies
    if len(bodies) == 1 and not bodies[0].name and path.stem not in {body.name for body in ground.bodies}:
        bodies[0].name = path.stem


def _view(camera: scene_files.Camera) -> View:
    """Return the view of a camera of the file."""
    eye = np.asarray(camera.at)
    if camera.orientation is None:
        return look_at(eye, np.asarray(camera.look_at), *_IMAGE, camera.fovy)
    map_from_camera = np.eye(4)
    map_from_camera[:3, :3] = rotation_matrix(camera.orientation)
    map_from_camera[:3, 3] = eye
    return View(*_IMAGE, pinhole(*_IMAGE, camera.fovy), map_from_camera)


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
    """Return the model of a class, and whether its bodies are fixed."""
    try:
        found = classes.find(class_name)
    except UnknownClass:
        return class_name.lower(), False
    return found.model, found.fixed


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes().removeprefix(codecs.BOM_UTF8)
    except OSError as error:
        raise BadFile(f"cannot read {path}: {error.strerror}") from None
