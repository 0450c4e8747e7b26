"""A viser server that only this process can reach.

viser normally listens on a TCP port, and every program that can connect to it can view and edit the scene.
Here it listens on a Unix socket in a folder that only this user can open, and the page forwards the messages
of browsers.
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
from typing import Any, Final

import viser
import websockets.asyncio.server
from viser.infra import WebsockClientConnection
from websockets.asyncio.server import ServerConnection

from semmap.nodes.runtime.sockets import socket_folder

_PREFIX: Final = "semmap-scene-"
_SOCKET: Final = "viser.sock"
_page: contextvars.ContextVar[str] = contextvars.ContextVar("page", default="")
_patching = threading.Lock()


class _Private(viser.ViserServer):
    """A viser server that never opens a public tunnel."""

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Return None, because there is no public URL."""
        return None


class SceneServer:
    """A viser server on a Unix socket."""

    def __init__(self) -> None:
        folder = socket_folder(f"{_PREFIX}12345678/{_SOCKET}")  # mkdtemp adds eight characters
        self._folder = Path(tempfile.mkdtemp(prefix=_PREFIX, dir=folder))
        self.at = self._folder / _SOCKET
        """The path of the socket, in a folder that only this user can open."""
        with _unix_socket(self.at), contextlib.redirect_stdout(io.StringIO()):
            self.viser = _Private(host="127.0.0.1", port=0, verbose=False)
        self._pages: dict[int, str] = {}
        self.viser._websock_server.on_client_connect(self._on_connect)
        self.viser._websock_server.on_client_disconnect(self._on_disconnect)

    def page_of(self, client_id: int) -> str:
        """Return the id of the tab (`Page.id`) of a viser client; empty if the client has disconnected."""
        return self._pages.get(client_id, "")

    def is_open(self, client_id: int) -> bool:
        """Return whether a viser client is connected."""
        return client_id in self.viser.get_clients()

    def close(self) -> None:
        """Stop the server and remove the socket."""
        with contextlib.redirect_stdout(io.StringIO()):
            self.viser.stop()
        shutil.rmtree(self._folder, ignore_errors=True)

    async def _on_connect(self, connection: WebsockClientConnection) -> None:
        self._pages[connection.client_id] = _page.get()

    async def _on_disconnect(self, connection: WebsockClientConnection) -> None:
        self._pages.pop(connection.client_id, None)


@contextlib.contextmanager
def _unix_socket(path: Path) -> Iterator[None]:
    """Have a viser server that is created in this context listen on `path`.

    Viser 1.1 has no option for it.
    """
    original = websockets.asyncio.server.serve

    def serve(
        handler: Callable[[ServerConnection], Awaitable[None]], host: str, port: int, **rest: Any
    ) -> Any:
        async def of_a_page(connection: ServerConnection) -> None:
            request = connection.request
            _page.set(request.path.strip("/") if request is not None else "")
            await handler(connection)

        return original(of_a_page, unix=True, path=str(path), **rest)

    with _patching:
        websockets.asyncio.server.serve = serve  # type: ignore[assignment, misc]
        try:
            yield
        finally:
            websockets.asyncio.server.serve = original  # type: ignore[misc]
