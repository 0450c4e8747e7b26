"""viser, where nobody but this process reaches it.

viser serves a port of its own, and whoever reaches that may look at the scene and drag what is in it. Here it
listens at a socket in a folder that only this user may open, and the page passes on what browsers say to it.
"""

from __future__ import annotations

import contextlib
import contextvars
import io
import shutil
import tempfile
import threading
from collections.abc import Awaitable, Callable, Iterator
from pathlib import Path
from typing import Any

import viser
import websockets.asyncio.server
from viser.infra import WebsockClientConnection
from websockets.asyncio.server import ServerConnection

_page: contextvars.ContextVar[str] = contextvars.ContextVar("page", default="")
_patching = threading.Lock()


class _Private(viser.ViserServer):
    """A viser that opens no tunnel to anywhere, whoever asks it to."""

    def request_share_url(self, verbose: bool = True) -> str | None:
        """There is none."""
        return None


class SceneServer:
    """A viser server at a socket in the file system; `close` ends it."""

    def __init__(self) -> None:
        self._folder = Path(tempfile.mkdtemp(prefix="semmap-scene-"))
        self.at = self._folder / "viser.sock"
        """Where it listens; the folder is this user's alone."""
        with _listening_at(self.at), contextlib.redirect_stdout(io.StringIO()):
            self.viser = _Private(host="127.0.0.1", port=0, verbose=False)
        self._pages: dict[int, str] = {}
        self.viser._websock_server.on_client_connect(self._on_connect)
        self.viser._websock_server.on_client_disconnect(self._on_disconnect)

    def page_of(self, client_id: int) -> str:
        """The open tab (`Page.id`) whose frame a client of viser's is; nothing for one that is gone."""
        return self._pages.get(client_id, "")

    def is_open(self, client_id: int) -> bool:
        """Is this client of viser's still there?"""
        return client_id in self.viser.get_clients()

    def close(self) -> None:
        """End it."""
        with contextlib.redirect_stdout(io.StringIO()):
            self.viser.stop()
        shutil.rmtree(self._folder, ignore_errors=True)

    async def _on_connect(self, connection: WebsockClientConnection) -> None:
        self._pages[connection.client_id] = _page.get()

    async def _on_disconnect(self, connection: WebsockClientConnection) -> None:
        self._pages.pop(connection.client_id, None)


@contextlib.contextmanager
def _listening_at(path: Path) -> Iterator[None]:
    """Have viser listen at `path` while it is made, for it offers a host and a port only (viser 1.1)."""
    own = websockets.asyncio.server.serve

    def serve(
        handler: Callable[[ServerConnection], Awaitable[None]], host: str, port: int, **rest: Any
    ) -> Any:
        async def of_a_page(connection: ServerConnection) -> None:
            request = connection.request
            _page.set(request.path.strip("/") if request is not None else "")
            await handler(connection)

        return own(of_a_page, unix=True, path=str(path), **rest)

    with _patching:
        websockets.asyncio.server.serve = serve  # type: ignore[assignment, misc]
        try:
            yield
        finally:
            websockets.asyncio.server.serve = own  # type: ignore[misc]
