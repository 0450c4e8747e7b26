"""The scenes of all tabs: one viser server for the process, and a frame with a toolbar in each tab."""

from __future__ import annotations

import asyncio
import contextlib
from typing import Final

from nicegui import ui
from viser import ClientHandle

from semmap.nodes.extern.web.live import Live, LiveEvent
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.widgets.redraw import visibility_check
from semmap.nodes.extern.web.proxy import PATH
from semmap.nodes.extern.web.scene.assets import Assets
from semmap.nodes.extern.web.scene.switches import SWITCHES, Switch
from semmap.nodes.extern.web.scene.tab import TabScene
from semmap.nodes.extern.web.scene.viser_server import SceneServer

_RETRY_S: Final = 2.0
"""Time after which surfaces that did not arrive are requested again."""
_ICONS: Final[dict[Switch, str]] = {
    "names": "label",
    "walls": "border_style",
    "relations": "timeline",
    "viewer-relative relations": "visibility",
    "boxes": "check_box_outline_blank",
    "observations": "center_focus_weak",
    "cloud": "grain",
    "cameras": "photo_camera",
}


class SceneManager:
    """Assigns connecting frames to their tabs."""

    def __init__(self, live: Live, server: SceneServer) -> None:
        self._live = live
        self._server = server
        self._tabs: dict[str, TabScene] = {}
        self._assets = Assets(live, self._refresh)
        self._fetching: asyncio.Task[None] | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        live.listen(self._on_event)
        server.viser.on_client_connect(self._on_connect)
        server.viser.on_client_disconnect(self._on_disconnect)

    def add_tab(self, page: Page) -> None:
        """Add the scene of a new tab, which is drawn when its frame connects."""
        self._loop = asyncio.get_running_loop()
        tab = self._tabs[page.id] = TabScene(page, self._assets, self._server.is_open)
        page.draw_scene = lambda: scene(page, tab)
        page.client.on_delete(lambda: self._close(page.id))
        self._fetch()

    def _close(self, page: str) -> None:
        if (tab := self._tabs.pop(page, None)) is not None:
            tab.close()

    # On the thread of viser

    async def _on_connect(self, client: ClientHandle) -> None:
        self._post(self._attach, self._server.page_of(client.client_id), client)

    async def _on_disconnect(self, client: ClientHandle) -> None:
        self._post(self._detach, client.client_id)

    def _post(self, function: object, *arguments: object) -> None:
        if self._loop is not None:
            with contextlib.suppress(RuntimeError):  # the loop has ended
                self._loop.call_soon_threadsafe(function, *arguments)  # type: ignore[arg-type]

    # On the event loop of the page

    def _attach(self, page: str, client: ClientHandle) -> None:
        if (tab := self._tabs.get(page)) is not None:
            with tab.page.client:
                tab.attach(client)

    def _detach(self, client_id: int) -> None:
        for tab in self._tabs.values():
            tab.detach(client_id)

    def _on_event(self, event: LiveEvent) -> None:
        if event.kind == "scene":
            self._fetch()

    def _fetch(self) -> None:
        if self._tabs and (self._fetching is None or self._fetching.done()):
            self._fetching = asyncio.get_running_loop().create_task(self._fetch_assets())

    async def _fetch_assets(self) -> None:
        while self._tabs and not await self._assets.fetch():
            await asyncio.sleep(_RETRY_S)

    def _refresh(self) -> None:
        for tab in self._tabs.values():
            with tab.page.client:
                tab.refresh()


def scene(page: Page, tab: TabScene) -> None:
    """Draw the scene."""
    tab.is_in_view = visibility_check()
    frame = ui.element("iframe").props(f'src="{PATH}/{page.id}/" title="3-D scene"')
    tab.on_first_drawing = lambda: frame.classes(add="is-drawn")
    with ui.element("div").classes("semmap-scene-tools").props('role="toolbar" aria-label="Scene"'):
        for name in SWITCHES:
            _switch(tab, name)
        home = ui.button(icon="home", on_click=tab.show_all).tooltip("Show all")
        home.props('flat dense round color=secondary aria-label="Show all"')
    selection = ui.label().classes("semmap-unseen").props('role="status" aria-label="Selected"')
    past = ui.label().classes("semmap-scene-past").props('role="status"')

    def show() -> None:
        past.text = f"commit {page.state.commit:,}"
        past.visible = not page.moment.is_now
        frame.classes(**{"remove" if page.moment.is_now else "add": "is-past"})

    def show_selection() -> None:
        selection.text = ", ".join(page.selected[:20])

    page.on_select(show_selection)
    page.on_change(show)
    page.on_moment(show)
    show()


def _switch(tab: TabScene, name: Switch) -> None:
    label = SWITCHES[name]
    button = ui.button(icon=_ICONS[name]).tooltip(label)

    def show() -> None:
        is_on = name in tab.on
        colour = "primary" if is_on else "grey-6"
        button.props(
            f'flat dense round color={colour} aria-pressed={str(is_on).lower()} aria-label="{label}"'
        )

    def toggle() -> None:
        tab.switch(name, on=name not in tab.on)
        show()

    button.on_click(toggle)
    show()
