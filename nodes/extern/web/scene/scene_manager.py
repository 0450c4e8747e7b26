"""The scenes of all tabs: one viser server for the process, and one scene per tab."""

from __future__ import annotations

import asyncio
import contextlib

from viser import ClientHandle

from semmap.nodes.extern.web.live import Live, LiveEvent
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.scene.assets import Assets
from semmap.nodes.extern.web.scene.controls import scene
from semmap.nodes.extern.web.scene.tab import TabScene
from semmap.nodes.extern.web.scene.viser_server import SceneServer


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
            self._fetching = asyncio.get_running_loop().create_task(self._assets.fetch())

    def _refresh(self) -> None:
        for tab in self._tabs.values():
            with tab.page.client:
                tab.refresh()
