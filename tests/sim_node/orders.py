"""Helpers for orders, placements and worlds."""

from semmap.nodes.sim_node.world import World
from semmap.schemas.entities import Pose, Size, orientation_from_yaw
from semmap.schemas.scenes import Body, BodyOrder, Placement


def pose(x: float, y: float, z: float = 0.0, yaw: float = 0.0) -> Pose:
    return Pose(position_m=(x, y, z), orientation_wxyz=orientation_from_yaw(yaw))


def order(
    name: str,
    model: str,
    at: Pose,
    *,
    size_m: Size | None = None,
    fixed: bool = False,
    commit: int = 1,
) -> BodyOrder:
    return BodyOrder(
        name=name, class_=model.title(), model=model, pose=at, size_m=size_m, fixed=fixed, commit=commit
    )


def hand(name: str, at: Pose) -> Placement:
    return Placement(name=name, pose=at)


def spawned(*orders: BodyOrder) -> World:
    world = World()
    world.spawn(orders)
    return world


def bodies(world: World) -> dict[str, Body]:
    return {body.name: body for body in world.scene().bodies}
