"""Dragging: the gizmo of the selected entity moves its body, and copies show entities at other poses."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from typing import Final

from msgspec import structs

from semmap.nodes.drawing.figures import is_still
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.scene.bodies import Bodies
from semmap.nodes.extern.web.scene.drawables import Drawable
from semmap.nodes.extern.web.scene.gizmo import Gizmo, Phase, place_on_support
from semmap.nodes.extern.web.scene.picking import Solid
from semmap.schemas import errors, keys
from semmap.schemas.commands import Move
from semmap.schemas.entities import Pose
from semmap.schemas.scenes import Body, SceneQuery

_POSE_DELAY_S: Final = 0.2
"""Time after which the new pose of a moved body has been received."""
_NO_ROOM: Final = "{name}: no free space, the position overlaps {other}; {name} was moved back"


class Dragging:
    """The gizmo and the copies in one frame of a scene."""

    def __init__(
        self,
        page: Page,
        gizmo: Gizmo,
        copies: Bodies,
        bodies: Callable[[], Mapping[str, Body]],
        things: Callable[[], Mapping[str, Drawable]],
        solids: Callable[[str], list[Solid]],
        draw: Callable[[], None],
    ) -> None:
        """`copies` draws the copies. `bodies()` and `things()` are those of the scene and the drawn objects.

        `solids(without)` are all objects but one. `draw()` draws the scene, with `name` as a ghost.
        """
        self.name = ""
        """The entity that is dragged, or ""."""
        self.gizmo = gizmo
        self._page, self._copies, self._bodies = page, copies, bodies
        self._things, self._solids, self._draw = things, solids, draw
        self._is_closed = False

    def close(self) -> None:
        """End dragging: the frame has disconnected."""
        self.name, self._is_closed = "", True

    def put_gizmo(self, selected: Mapping[str, Drawable]) -> None:
        """Show the gizmo at the only selected object, if it can be moved."""
        if self.name:
            return
        is_movable = self._page.moment.is_now and self._page.is_allowed("move")
        name = next(iter(selected)) if is_movable and len(selected) == 1 else ""
        if name in self._bodies():
            self.gizmo.put(selected[name].pose, selected[name].size_m)
        else:
            self.gizmo.remove()

    def on_drag(self, phase: Phase, pose: Pose) -> None:
        """Draw the selected object where it is dragged, and move it at the end."""
        if phase == "start":
            self._begin()
        if not self.name:
            return
        if phase == "end":
            self._page.start_task(self._move(self.name, pose))
        else:
            self._copy(pose)

    def cancel(self) -> bool:
        """End dragging without a move; return whether an object was dragged."""
        was_dragged = bool(self.name)
        if was_dragged:
            self.gizmo.remove()
            self._end()
        return was_dragged

    def preview(self, poses: Mapping[str, Pose]) -> None:
        """Draw these entities at other poses, too; those of an earlier call disappear."""
        things = self._things()
        if not self.name:
            self._copies.show(
                {
                    name: structs.replace(things[name], appearance="solid", pose=pose)
                    for name, pose in poses.items()
                    if name in things
                }
            )

    def _begin(self) -> None:
        names = [name for name in self._page.selected if name in self._things()]
        if len(names) == 1:
            self.name = names[0]
            self._draw()

    def _copy(self, pose: Pose) -> None:
        """Draw the object where it is dragged; a ghost is drawn at its original pose."""
        thing = self._things().get(self.name)
        if thing is not None:
            self._copies.show({self.name: structs.replace(thing, appearance="solid", pose=pose)})

    def _end(self) -> None:
        self.name = ""
        if not self._is_closed:
            self._copies.show({})
            self._draw()

    async def _move(self, name: str, pose: Pose) -> None:
        """Move the body to the pose where it was released; after a rejection it returns."""
        thing = self._things()[name]
        before = self._page.state.poses.get(name, thing.pose)
        body = self._bodies().get(name)
        was_ghost = body is not None and body.ghost
        if is_still(before, pose):  # a click on the arrows
            self.cancel()
            return
        target = place_on_support(pose, thing.size_m, self._solids(name))
        self._copy(target)
        reply = await self._page.change(Move(name=name, at=target.position_m, yaw=target.yaw_rad, carry=True))
        ghost = None if reply is None or was_ghost else await self._find_ghost(name)
        if ghost is not None:
            back = Move(name=name, at=before.position_m, yaw=before.yaw_rad, carry=True)
            if await self._page.change(back) is not None:
                self._page.notify(
                    _NO_ROOM.format(name=name, other=ghost.in_the_way or "another body"), "warning"
                )
        if reply is not None:
            await asyncio.sleep(_POSE_DELAY_S)
        self._end()

    async def _find_ghost(self, name: str) -> Body | None:
        """Return the body if it is non-colliding, because another body occupies its position."""
        try:
            scene = await self._page.live.query(keys.SIM, SceneQuery())
        except errors.SemmapError:
            return None
        return next((body for body in scene.bodies if body.name == name and body.ghost), None)
