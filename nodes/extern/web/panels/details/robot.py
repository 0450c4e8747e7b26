"""The drive, speed and live pose of the selected robot, and buttons to drive and stop it."""

from __future__ import annotations

import contextlib
import time
from typing import Final

from nicegui import ui

from semmap.nodes.extern.web.live import LiveEvent
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.views.entities.robot_state import (
    LiveAge,
    Speed,
    can_drive,
    describe_drive,
    describe_end,
    ended_goals,
    is_shown,
)
from semmap.schemas import errors, keys
from semmap.schemas.commands import Drive, Get
from semmap.schemas.entities import Entity, Live
from semmap.schemas.live import LivePoses
from semmap.schemas.scenes import Body, Point

_REDRAW_S: Final = 0.5


def draw_robot(page: Page, entity: Entity) -> Robot | None:
    """Draw the panel of a robot or a tracked entity; return None for others, and in the past."""
    return Robot(page, entity) if has_panel(page, entity) else None


def has_panel(page: Page, entity: Entity) -> bool:
    """Return whether an entity is shown with this panel at the moment shown."""
    return page.moment.is_now and is_shown(entity, _body_of(page, entity.name))


class Robot:
    """The panel of one entity, which follows the live poses until `close`."""

    def __init__(self, page: Page, entity: Entity) -> None:
        self._page, self._entity = page, entity
        self._age = LiveAge()
        self._speed = Speed()
        self._paths = dict(page.live.drives)
        self._ended = ""
        """How the last drive ended."""
        with ui.expansion("Robot" if self._can_drive else "Live pose", icon="smart_toy") as self._all:
            self._all.props("dense").classes("w-full semmap-robot")
            self._drive = ui.label().classes("semmap-sentence").props('role="status" aria-label="Drive"')
            self._motion = ui.label().classes("semmap-quiet semmap-figures")
            if self._can_drive and page.is_allowed("drive"):
                self._draw_controls()
        self._all.value = True
        self._drive.set_visibility(self._can_drive)
        self._stops = [page.live.follow(keys.LIVE_POSES, self._on_poses), page.live.listen(self._on_event)]
        page.client.on_delete(self.close)
        ui.timer(_REDRAW_S, self._show)
        self._show()
        if entity.tracked:
            page.start_task(self._fetch())

    def close(self) -> None:
        """Stop following."""
        while self._stops:
            self._stops.pop()()

    @property
    def _can_drive(self) -> bool:
        return can_drive(_body_of(self._page, self._entity.name))

    def _draw_controls(self) -> None:
        with ui.row().classes("w-full items-center gap-2 no-wrap"):
            self._to = [
                ui.number(axis, step=0.1)
                .props(f'dense outlined hide-bottom-space aria-label="goal {axis}"')
                .classes("grow")
                .style("flex-basis: 0; min-width: 0")
                for axis in ("x [m]", "y [m]")
            ]
            ui.button("Drive", on_click=self._drive_to_fields).props("unelevated")
        with ui.row().classes("w-full items-center gap-2 no-wrap"):
            if self._page.pick is not None:
                here = ui.button("Drive here", icon="my_location", on_click=self._drive_to_click)
                here.props("flat dense no-caps").tooltip("Pick the goal in the scene")
            ui.space()
            ui.button("Stop", icon="stop", on_click=self._stop).props("outline color=negative")

    async def _drive_to_fields(self) -> None:
        x, y = (field.value for field in self._to)
        if x is None or y is None:
            self._page.notify("goal is required; enter x and y in metres", "warning")
            return
        await self._start((float(x), float(y)))

    async def _drive_to_click(self) -> None:
        place = await self._page.pick_place()
        if place is not None:
            await self._start((round(place[0], 3), round(place[1], 3)))

    async def _start(self, goal: Point) -> None:
        self._ended = ""
        reply = await self._page.change(Drive(name=self._entity.name, to=(goal,)))
        if reply is not None:
            self._page.notify(reply.text, "positive")

    async def _stop(self) -> None:
        reply = await self._page.change(Drive(name=self._entity.name, stop=True))
        if reply is not None:
            self._page.notify(reply.text, "positive")

    async def _fetch(self) -> None:
        """Request the last live pose: stale poses are not published."""
        with contextlib.suppress(errors.SemmapError):  # it was just removed, which will be drawn
            entity = await self._page.live.ask(Get(name=self._entity.name))
            if entity.live is not None:
                self._add(entity.live)
                self._show()

    def _on_poses(self, _: str, poses: LivePoses) -> None:
        self._add(poses.entities.get(self._entity.name))

    def _add(self, live: Live | None) -> None:
        now_s = time.monotonic()
        self._age.add(live, now_s)
        if live is not None:
            self._speed.add(now_s, live.pose.position_m)

    def _on_event(self, event: LiveEvent) -> None:
        if event.kind == "drives":
            goal = ended_goals(self._paths, self._page.live.drives).get(self._entity.name)
            if goal is not None:
                self._ended = describe_end(goal, self._page.live.poses.get(self._entity.name))
            self._paths = dict(self._page.live.drives)
            with self._page.client:
                self._show()

    def _show(self) -> None:
        now_s, name = time.monotonic(), self._entity.name
        entity = self._page.live.entities.get(name, self._entity)
        pose = self._page.live.poses.get(name, entity.pose)
        path = self._paths.get(name, ())
        _set(self._drive, describe_drive(path, pose) if path else self._ended or "Not driving")
        speed = f"Speed {self._speed.mean_m_s(now_s):.2f} m/s"
        _set(self._motion, f"{speed} · {self._age.describe(entity, now_s)}")


def _set(label: ui.label, text: str) -> None:
    if label.text != text:
        label.text = text


def _body_of(page: Page, name: str) -> Body | None:
    scene = page.live.scene
    return None if scene is None else next((body for body in scene.bodies if body.name == name), None)
