"""The scene as viser shows it: one server for the process, and a view for each tab."""

from __future__ import annotations

import asyncio
import contextlib

from viser import ClientHandle

from semmap.nodes.extern.web.live import Happening, Live
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.scene.assets import Assets
from semmap.nodes.extern.web.scene.controls import scene
from semmap.nodes.extern.web.scene.tab import TabScene
from semmap.nodes.extern.web.scene.viser_server import SceneServer


class Stage:
    """Brings the frames that connect together with the tabs that they are in."""

    def __init__(self, live: Live, server: SceneServer) -> None:
        self._live = live
        self._server = server
        self._tabs: dict[str, TabScene] = {}
        self._assets = Assets(live, self._refresh)
        self._fetching: asyncio.Task[None] | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        live.listen(self._on_happening)
        server.viser.on_client_connect(self._on_connect)
        server.viser.on_client_disconnect(self._on_disconnect)

    def show(self, page: Page) -> None:
        """A tab has been opened: its view, which is drawn as soon as its frame connects."""
        self._loop = asyncio.get_running_loop()
        tab = self._tabs[page.id] = TabScene(page, self._assets, self._server.is_open)
        page.draw_scene = lambda: scene(page, tab)
        page.client.on_delete(lambda: self._close(page.id))
        self._fetch()

    def _close(self, page: str) -> None:
        if (tab := self._tabs.pop(page, None)) is not None:
            tab.close()

    # viser's thread

    async def _on_connect(self, client: ClientHandle) -> None:
        self._hand_over(self._attach, self._server.page_of(client.client_id), client)

    async def _on_disconnect(self, client: ClientHandle) -> None:
        self._hand_over(self._detach, client.client_id)

    def _hand_over(self, function: object, *arguments: object) -> None:
        if self._loop is not None:
            with contextlib.suppress(RuntimeError):  # the loop has ended
                self._loop.call_soon_threadsafe(function, *arguments)  # type: ignore[arg-type]

    # The event loop of the page

    def _attach(self, page: str, client: ClientHandle) -> None:
        if (tab := self._tabs.get(page)) is not None:
            with tab.page.client:
                tab.attach(client)

    def _detach(self, client_id: int) -> None:
        for tab in self._tabs.values():
            tab.detach(client_id)

    def _on_happening(self, happening: Happening) -> None:
        if happening.kind == "scene":
            self._fetch()

    def _fetch(self) -> None:
        if self._tabs and (self._fetching is None or self._fetching.done()):
            self._fetching = asyncio.get_running_loop().create_task(self._assets.fetch())

    def _refresh(self) -> None:
        for tab in self._tabs.values():
            with tab.page.client:
                tab.refresh()
