"""World files: an MJCF scene, or a scene in JSON on a bare floor."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from nodes.sim_node.orders import ModelSource
from nodes.sim_node.world import World
from schemas import scene_files
from schemas.errors import BadFile
from schemas.scenes import BodyOrder


def open_world(path: Path | None, models: ModelSource, meanwhile: Callable[[], None] = lambda: None) -> World:
    """The world that a file describes, a bare floor without one.

    Bodies of a JSON scene are the world's own furniture (commit 0), each with the model of its class's name.
    `meanwhile` is as in World. Raises BadFile for a file that is neither MJCF nor a scene, or has a body that
    cannot be made.
    """
    content = _read(path) if path is not None else b""
    if path is None or not content.lstrip().startswith(b"{"):
        return World(path, models=models, meanwhile=meanwhile)
    world = World(models=models, meanwhile=meanwhile)
    world.name = path.name
    spawned = world.spawn(_orders(scene_files.read(content, path.name)))
    for name, reason in spawned.failed.items():
        raise BadFile(f"{path.name}: {name} cannot be made: {reason}")
    world.look_over()
    return world


def _orders(described: tuple[scene_files.Described, ...]) -> list[BodyOrder]:
    taken = {item.name for item in described}
    orders = []
    for i, item in enumerate(described, start=1):
        name = item.name or next(n for k in range(i, 10**9) if (n := f"{item.class_}_{k}") not in taken)
        taken.add(name)
        orders.append(
            BodyOrder(
                name=name,
                class_=item.class_,
                model=item.class_.lower(),
                pose=scene_files.pose_of(item.at or (0.0, 0.0, 0.0), item.yaw, item.orientation),
                size_m=item.size,
                commit=0,
            )
        )
    return orders


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise BadFile(f"{path} cannot be read: {error.strerror}") from None
