"""The gizmo: arrows and a ring at the selected entity, which move and turn its body."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any, Final, Literal

from viser import SceneApi, TransformControlsHandle

from semmap.nodes.extern.web.scene.picking import Solid, support_m
from semmap.schemas.entities import Pose, Size, orientation_from_yaw

Phase = Literal["start", "update", "end"]
DragListener = Callable[[Phase, Pose], None]
"""Called on the thread of viser with the current pose."""

_STEP_UP_M: Final = 0.5
_SMALL_M: Final = 0.45
"""Objects up to this width are placed on a support that is at most `_STEP_UP_M` higher."""
_CLEAR_M: Final = 0.003
_EVEN_M: Final = 0.001


class Gizmo:
    """Arrows along x, y and z, and a ring about z: only the yaw can be changed."""

    def __init__(self, scene: SceneApi, listener: DragListener, is_open: Callable[[], bool]) -> None:
        """`is_open()` returns whether the frame exists; a drag that its closing ends is not reported."""
        self._scene = scene
        self._listener = listener
        self._is_open = is_open
        self._handles: tuple[TransformControlsHandle, ...] = ()
        self._pose: Pose | None = None
        self._shown = 0
        """A counter that makes the names of the handles unique.

        If a node is removed and added under the same name, the browser keeps its old orientation, and viser
        does not send the identity.
        """

    @property
    def is_shown(self) -> bool:
        """Whether the gizmo is visible."""
        return bool(self._handles)

    def put(self, pose: Pose, size_m: Size) -> None:
        """Show the gizmo at the pose of an entity."""
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
        """Hide the gizmo."""
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
            self._pose = None  # so that `put` moves it back if the entity does not move
            if event.phase != "end" or self._is_open():
                self._listener(event.phase, pose)

        handle.on_update(on_update)
        return handle


def arm_m(size_m: Size) -> float:
    """Return the length of the arrows for an entity of this size [m]."""
    return min(1.4, max(0.45, 0.9 * max(size_m)))


def _pose_of(handle: TransformControlsHandle) -> Pose:
    x, y, z = (float(value) for value in handle.position)
    w, qx, qy, qz = (float(value) for value in handle.wxyz)
    yaw = math.atan2(2.0 * (w * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz))
    return Pose(position_m=(x, y, z), orientation_wxyz=orientation_from_yaw(yaw))


def place_on_support(pose: Pose, size_m: Size, others: Iterable[Solid]) -> Pose:
    """Return the pose for an entity that was dragged to `pose`. Small ones are placed on a support."""
    x, y, z = pose.position_m
    if max(size_m[:2]) > _SMALL_M:
        return pose
    support = support_m((x, y, z + _STEP_UP_M), others)
    if support <= z + _EVEN_M:
        return pose
    return Pose(position_m=(x, y, support + _CLEAR_M), orientation_wxyz=pose.orientation_wxyz)
