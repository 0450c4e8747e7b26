"""A planning scene's monitor, with the rules in the comments of moveit_msgs."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

ADD, REMOVE, MOVE = 0, 1, 3
NUMBERS = {1: 3, 2: 1, 3: 2}
"""Dimensions of a box, a sphere and a cylinder."""


class Planner:
    """What a planning scene's monitor makes of diffs: obstacles, and the objects attached to links."""

    def __init__(self) -> None:
        self.obstacles: dict[str, Any] = {}
        self.attached: dict[str, str] = {}
        self.poses: dict[str, Any] = {}

    def take(self, scene: Any) -> Planner:
        assert scene.is_diff
        assert scene.robot_state.is_diff
        attached = scene.robot_state.attached_collision_objects
        _require_unique(each.object.id for each in attached)
        _require_unique(each.id for each in scene.world.collision_objects)
        for each in attached:
            self._attach(each)
        for each in scene.world.collision_objects:
            self._change(each)
        return self

    def _attach(self, each: Any) -> None:
        name = each.object.id
        assert name
        if each.object.operation == ADD:
            assert each.link_name in each.touch_links
            _require_unique(each.touch_links)
            check_solid(each.object)
            self.obstacles.pop(name, None)
            self.attached[name] = each.link_name
            self.poses[name] = each.object.pose
        else:
            assert each.object.operation == REMOVE
            assert self.attached.pop(name) == each.link_name
            self.obstacles[name] = each.object  # a detached object is in the world

    def _change(self, each: Any) -> None:
        assert each.header.frame_id == "map"
        assert each.id
        if each.operation == ADD:
            check_solid(each)
            assert each.id not in self.attached
            self.obstacles[each.id] = each
            self.poses[each.id] = each.pose
        elif each.operation == MOVE:
            assert each.id in self.obstacles
            assert len(each.primitives) + len(each.meshes) + len(each.planes) == 0
            check_pose(each.pose)
            self.poses[each.id] = each.pose
        else:
            assert each.operation == REMOVE
            self.obstacles.pop(each.id, None)


def _require_unique(names: Iterable[str]) -> None:
    names = list(names)
    assert len(set(names)) == len(names)


def check_solid(found: Any) -> None:
    assert found.header.frame_id == "map"
    assert len(found.primitives) or len(found.meshes)
    assert len(found.primitives) == len(found.primitive_poses)
    assert len(found.meshes) == len(found.mesh_poses)
    for primitive in found.primitives:
        assert len(primitive.dimensions) == NUMBERS[primitive.type]
        assert min(primitive.dimensions) > 0.0
    for mesh in found.meshes:
        assert all(max(triangle.vertex_indices) < len(mesh.vertices) for triangle in mesh.triangles)
    for pose in (found.pose, *found.primitive_poses, *found.mesh_poses):
        check_pose(pose)


def check_pose(pose: Any) -> None:
    q = pose.orientation
    assert math.isclose(math.hypot(q.x, q.y, q.z, q.w), 1.0, abs_tol=1e-6)
