"""The floor plan, to scale: it can be printed and saved, and a click selects."""

from __future__ import annotations

import asyncio
import base64
import contextlib
from collections.abc import Awaitable, Callable, Coroutine
from functools import partial
from typing import Any, Final

from nicegui import events, ui

from semmap.nodes.extern.plan.floor import Floor, floor_of
from semmap.nodes.extern.plan.svg import Drawing, draw
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.widgets.redraw import LazyRedraw
from semmap.schemas import errors
from semmap.schemas.commands import PlanFloor
from semmap.schemas.plans import Plan

_PAUSE_S: Final = 1.0
"""Minimum interval between two drawings, and thus between two requests for the plan [s]."""
_PATIENCE_S: Final = 0.5
"""Time that a drawing waits for the plan [s]."""
_ZOOMS: Final = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)
_MARKED: Final = 'fill="rgba(47,129,247,.25)" stroke="#2f81f7" stroke-width="2"'
_PRINT: Final = """
const frame = document.createElement("iframe");
frame.style.cssText = "position:fixed;right:0;bottom:0;width:0;height:0;border:0";
document.body.append(frame);
const sheet = frame.contentDocument;
const style = sheet.createElement("style");
style.textContent = "@page { size: %(sheet)s; margin: 0 } body { margin: 0 } img { width: %(wide)gmm }";
sheet.head.append(style);
const image = sheet.createElement("img");
image.onload = () => { frame.contentWindow.print(); setTimeout(() => frame.remove(), 60000) };
image.src = "%(source)s";
sheet.body.append(image);
"""


def plan(page: Page) -> None:
    """Draw the plan at the moment shown; a click selects."""
    _Plan(page)


class PlanRequests:
    """Requests the plan of a moment once, one request at a time. A drawing waits only briefly for it."""

    def __init__(
        self,
        ask: Callable[[int | None], Awaitable[Plan]],
        start_task: Callable[[Coroutine[Any, Any, None]], asyncio.Task[None]],
        on_late: Callable[[], None],
    ) -> None:
        """Create it. `ask(commit)` sends a request, and `start_task` runs it in the background.

        `on_late()` is called when a plan arrives after `at` has returned without it, and when a request has
        ended that prevented another one.
        """
        self._ask = ask
        self._start_task = start_task
        self._on_late = on_late
        self._known: tuple[object, Plan] | None = None
        self._task: asyncio.Task[None] | None = None
        self._wanted: object = None
        self._is_late = False

    async def at(self, commit: int | None, content: object) -> Plan | None:
        """Return the plan after a commit, or the current one for None.

        The result is None if the plan is not there yet, or if the knowledge base cannot send it. `content`
        identifies the content of the plan: a plan that is known is not requested again.
        """
        self._wanted = content
        if self._task is None and not self._has(content):
            self._task = self._start_task(self._request(commit, content))
            await asyncio.wait([self._task], timeout=_PATIENCE_S)
        self._is_late = self._task is not None
        return self._known[1] if self._known is not None and self._has(content) else None

    def _has(self, content: object) -> bool:
        return self._known is not None and self._known[0] == content

    async def _request(self, commit: int | None, content: object) -> None:
        try:
            with contextlib.suppress(errors.SemmapError):
                self._known = (content, await self._ask(commit))
        finally:
            self._task = None
        if self._is_late and (self._has(content) or self._wanted != content):
            self._on_late()


class _Plan:
    def __init__(self, page: Page) -> None:
        self._page = page
        self._requests = PlanRequests(
            lambda commit: page.live.ask(PlanFloor(as_of=commit)), page.start_task, self._again
        )
        self._floor: Floor | None = None
        self._drawing: Drawing | None = None
        self._redraw: LazyRedraw | None = None
        self._zoom = 1.0
        with ui.column().classes("w-full gap-2"):
            with ui.row().classes("w-full items-center gap-2"):
                self._title = ui.input("Title", value="Plan").props("dense outlined").classes("grow")
                self._title.on("blur", self._again)
                ui.button("SVG", icon="download", on_click=self._download).props(
                    "dense no-caps flat"
                ).tooltip("Save the plan as a file").mark("plan-download")
                ui.button("Print", icon="print", on_click=self._print).props("dense no-caps flat")
                for icon, label, by in (("zoom_out", "Zoom out", -1), ("zoom_in", "Zoom in", 1)):
                    button = ui.button(icon=icon, on_click=partial(self._zoom_by, by)).tooltip(label)
                    button.props(f'flat round dense color=secondary aria-label="{label}"')
            self._scroll = ui.element("div").classes("w-full semmap-plan-scroll")
            self._scroll.props('tabindex=0 role="region" aria-label="Plan drawing"')
        with self._scroll:
            self._image = ui.interactive_image(on_mouse=self._click, events=["click"], sanitize=False)
            self._image.classes("w-full semmap-framed semmap-plan").style("background: #fff")
            self._image.props('role="img" aria-label="Plan of the rooms and the furniture"').mark("plan")
        self._redraw = LazyRedraw(page, self._draw, pause_s=_PAUSE_S)
        page.on_change(self._again)
        page.on_select(self._mark)

    def _zoom_by(self, steps: int) -> None:
        """Enlarge or reduce the plan, at least to the width of the panel."""
        self._zoom = next_zoom(self._zoom, steps)
        self._image.style(f"width: {round(100 * self._zoom)}%; max-width: none")

    def _again(self) -> None:
        if self._redraw is not None:
            self._redraw.mark_stale()

    async def _draw(self) -> None:
        state = self._page.state
        entities, poses, title = (
            tuple(state.entities.values()),
            dict(state.poses),
            self._title.value or "Plan",
        )
        commit, stamp_ns = state.commit, _stamp_ns(self._page)
        scene = self._page.live.scene if self._page.moment.is_now else None
        sizes_m = {} if scene is None else {body.name: body.size_m for body in scene.bodies}
        outlines = await self._outlines()

        def drawn() -> tuple[Floor, Drawing]:
            floor = floor_of(entities, poses, body_sizes_m=sizes_m, plan=outlines)
            return floor, draw(floor, title=title, commit=commit, stamp_ns=stamp_ns)

        self._floor, drawing = await asyncio.to_thread(drawn)
        self._drawing = drawing
        self._image.set_source(_source(drawing.svg))
        self._mark()

    async def _outlines(self) -> Plan | None:
        """Return the outlines of objects at the moment shown; None if the knowledge base cannot send them."""
        if not self._page.live.connected:
            return None
        live, commit = self._page.live, self._page.moment.commit
        return await self._requests.at(commit, (live.map_id, commit, self._page.state.commit, live.scene))

    def _mark(self) -> None:
        """Outline the selected entities. Only numbers go into the markup."""
        if self._floor is None or self._drawing is None:
            return
        shapes = {room.name: room.outline for room in (*self._floor.rooms, *self._floor.zones)}
        shapes.update((piece.name, piece.outline) for piece in self._floor.pieces)
        marks = [
            f'<polygon points="{" ".join(f"{x:.1f},{y:.1f}" for x, y in map(self._drawing.pixel, outline))}" '
            f"{_MARKED}/>"
            for name in self._page.selected
            if (outline := shapes.get(name)) is not None
        ]
        self._image.content = "".join(marks)

    def _click(self, event: events.MouseEventArguments) -> None:
        if self._floor is None or self._drawing is None:
            return
        name = self._floor.at(self._drawing.point(event.image_x, event.image_y))
        if name is not None:
            self._page.select((name,), "plan")

    def _download(self) -> None:
        if self._drawing is not None:
            name = f"plan-{self._page.state.commit}.svg"
            ui.download.content(self._drawing.svg.encode(), name, "image/svg+xml")

    def _print(self) -> None:
        if self._drawing is not None:
            sheet = "A4 landscape" if self._drawing.wide_mm > self._drawing.high_mm else "A4 portrait"
            values = {"sheet": sheet, "wide": self._drawing.wide_mm, "source": _source(self._drawing.svg)}
            ui.run_javascript(_PRINT % values)


def next_zoom(zoom: float, steps: int) -> float:
    """Return the magnification after some steps of the buttons, from the width of the panel (1) to 8."""
    return _ZOOMS[max(0, min(len(_ZOOMS) - 1, _ZOOMS.index(zoom) + steps))]


def _source(svg: str) -> str:
    """Return the plan as a data URL of an image, in which scripts do not run."""
    return f"data:image/svg+xml;base64,{base64.b64encode(svg.encode()).decode()}"


def _stamp_ns(page: Page) -> int:
    """Return the time of the last change of an entity, as an estimate for the time of the commit."""
    stamps = [e.provenance.stamp_ns for e in page.state.entities.values()]
    return max(stamps, default=0)
