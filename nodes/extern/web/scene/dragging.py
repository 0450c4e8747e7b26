"""Dragging: arrows and a ring at the selected thing, with which its body is moved and turned."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any, Final, Literal

from viser import SceneApi, TransformControlsHandle

from semmap.nodes.extern.web.scene.picking import Solid, support_m
from semmap.schemas.entities import Pose, Size, orientation_from_yaw

Phase = Literal["start", "update", "end"]
Dragged = Callable[[Phase, Pose], None]
"""Called on viser's thread, with where the thing has been dragged to."""

_STEP_UP_M: Final = 0.5
_SMALL_M: Final = 0.45
"""What is no larger is put on what it is dragged over, if that is no more than a step up."""
_CLEAR_M: Final = 0.003
_EVEN_M: Final = 0.001


class Gizmo:
    """Arrows along x, y and z and a ring about z; only about z does a hand turn things."""

    def __init__(self, scene: SceneApi, dragged: Dragged, is_open: Callable[[], bool]) -> None:
        """`is_open()`: the frame is still there; what was being dragged when it went was not let go."""
        self._scene = scene
        self._dragged = dragged
        self._is_open = is_open
        self._handles: tuple[TransformControlsHandle, ...] = ()
        self._pose: Pose | None = None
        self._shown = 0
        """How often it has been shown: part of its handles' names, so that none is used twice. A browser that
        is told at once to remove a node and to add one of the same name leaves it turned as it was, and an
        orientation that is the identity is not sent."""

    @property
    def is_shown(self) -> bool:
        """Is there something to drag by?"""
        return bool(self._handles)

    def put(self, pose: Pose, size_m: Size) -> None:
        """Show it where a thing stands."""
        upright = Pose(position_m=pose.position_m, orientation_wxyz=orientation_from_yaw(pose.yaw_rad))
        if upright == self._pose and self._handles:
            return
        self._pose = upright
        if not self._handles:
            scale = arm_m(size_m)
            self._shown += 1
            self._handles = (
                self._add(f"/gizmo/level/{self._shown}", scale, (True, True, False)),
                self._add(f"/gizmo/lift/{self._shown}", scale, (False, False, True)),
            )
        for handle in self._handles:
            handle.position = upright.position_m
            handle.wxyz = upright.orientation_wxyz

    def remove(self) -> None:
        """Show it no longer."""
        for handle in self._handles:
            handle.remove()
        self._handles, self._pose = (), None

    def _add(self, name: str, scale: float, axes: tuple[bool, bool, bool]) -> TransformControlsHandle:
        handle = self._scene.add_transform_controls(
            name,
            scale=scale,
            active_axes=axes,
            line_width=4.0,
            depth_test=False,
            opacity=0.9,
        )

        async def on_update(event: Any) -> None:
            pose = _pose_of(event.target)
            for other in self._handles:
                if other is not handle and event.phase == "update":
                    other.position = pose.position_m
            self._pose = None  # it has to be put back if the thing stays where it was
            if event.phase != "end" or self._is_open():
                self._dragged(event.phase, pose)

        handle.on_update(on_update)
        return handle


def arm_m(size_m: Size) -> float:
    """How long the arrows at a thing of this size are [m]."""
    return min(1.4, max(0.45, 0.9 * max(size_m)))


def _pose_of(handle: TransformControlsHandle) -> Pose:
    x, y, z = (float(value) for value in handle.position)
    w, qx, qy, qz = (float(value) for value in handle.wxyz)
    yaw = math.atan2(2.0 * (w * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz))
    return Pose(position_m=(x, y, z), orientation_wxyz=orientation_from_yaw(yaw))


def put_down(pose: Pose, size_m: Size, others: Iterable[Solid]) -> Pose:
    """Where a thing that was dragged to `pose` is put: what is small on top of what it was dragged over."""
    x, y, z = pose.position_m
    if max(size_m[:2]) > _SMALL_M:
        return pose
    support = support_m((x, y, z + _STEP_UP_M), others)
    if support <= z + _EVEN_M:
        return pose
    return Pose(position_m=(x, y, support + _CLEAR_M), orientation_wxyz=pose.orientation_wxyz)
