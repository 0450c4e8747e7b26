"""The server of the page, its assets and the scene, on one port."""

from __future__ import annotations

import contextlib
import logging
import os
import signal
import socket
import sys
import tempfile
from collections.abc import AsyncIterator, Callable, Iterator
from typing import Any, Final

import uvicorn
from fastapi import FastAPI
from msgspec import Struct

from semmap.nodes import bus
from semmap.nodes.extern import connection
from semmap.nodes.extern.web.access import TOKEN, Access
from semmap.nodes.identity import Identity
from semmap.nodes.runtime.web_token import new_token
from semmap.schemas import errors

HOST: Final = "127.0.0.1"
PORT: Final = 8080
_CLOSING_S: Final = 1
_LARGEST_MESSAGE: Final = 64 << 20


class WebConfig(Struct, frozen=True, kw_only=True):
    """Configuration of the page: the system it shows, and the address it listens on."""

    network: bus.Network
    host: str = HOST
    port: int = PORT
    """0 is any free port."""
    token: str = ""
    """The token that gives access to the page; empty generates one."""

    @property
    def identity(self) -> Identity | None:
        """The identity whose role the page has in a secure system."""
        return self.network.identity


def resolve_network(where: str | None, identity: str | None, namespace: str | None) -> bus.Network:
    """Return how to reach the system that `semmap.connect` would connect to with these arguments.

    The returned network reconnects for as long as the process runs. Raises NoAnswer when the system does not
    respond now, and the other errors of `connect`.
    """
    found = connection.identity(identity)
    where = connection.resolve_endpoint(where, connection.namespace(namespace))
    name = connection.namespace(namespace, where)
    with connection.open_session(where, name, found, mode="client"):
        pass
    at = where if found is None else bus.to_tls(where)
    return bus.Network(connect=(at,), mode="client", namespace=name, patience_s=bus.FOREVER_S, identity=found)


def run(config: WebConfig, on_ready: Callable[[str], None]) -> None:
    """Serve the page until SIGINT or SIGTERM. `on_ready` is called with its address when it can be opened.

    Raises BadRequest for a port in use, an address of another machine, or an invalid token.
    """
    token = new_token(config.token)
    with contextlib.closing(_listen(config.host, config.port)) as listening, _temporary_storage():
        bus.set_reader_threads()
        with bus.open_session(config.network) as session:
            _serve(config, token, session, listening, on_ready)


def _serve(
    config: WebConfig,
    token: str,
    session: bus.Session,
    listening: socket.socket,
    on_ready: Callable[[str], None],
) -> None:
    with _hidden_modules("aiohttp", "requests"):
        from nicegui import Client, ui  # after its storage path is set

    from semmap.nodes.extern.web import proxy
    from semmap.nodes.extern.web.layout import layout
    from semmap.nodes.extern.web.live import Live
    from semmap.nodes.extern.web.page import Page
    from semmap.nodes.extern.web.scene.scene_manager import SceneManager
    from semmap.nodes.extern.web.scene.viser_server import SceneServer

    live, scene = Live(session, config.network, config.identity), SceneServer()
    scenes = SceneManager(live, scene)
    port = listening.getsockname()[1]

    @contextlib.asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        live.start()
        address = f"http://{_url_host(config.host)}:{port}/"
        live.ready(address)
        on_ready(f"{address}?{TOKEN}={token}")
        try:
            yield
        finally:
            live.stop()
            scene.close()

    app = FastAPI(lifespan=lifespan, docs_url=None, redoc_url=None, openapi_url=None)

    app.include_router(proxy.router(scene.at))

    @ui.page("/", title="semmap", language="en-US")
    def tab(client: Client) -> None:
        page = Page(live, client)
        scenes.add_tab(page)
        layout(page)

    ui.run_with(
        app,
        title="semmap",
        dark=None,
        tailwind=False,  # it computes styles in the browser; page.css has the ones in use
        gzip_middleware_factory=None,  # on one machine compression takes longer than sending
        show_welcome_message=False,
        reconnect_timeout=30.0,
    )
    uvicorn.Server(_uvicorn(Access(app, config.host, port, token))).run(sockets=[listening])


def _uvicorn(app: Any) -> uvicorn.Config:
    return uvicorn.Config(
        app,
        log_level="warning",
        access_log=False,
        server_header=False,
        proxy_headers=False,
        ws="websockets-sansio",
        ws_max_size=_LARGEST_MESSAGE,
        ws_per_message_deflate=False,
        timeout_graceful_shutdown=_CLOSING_S,
    )


def _listen(host: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    listening = socket.socket(family, socket.SOCK_STREAM)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((host, port))
        listening.listen(128)
    except OSError as error:
        listening.close()
        reason = "port in use; choose another with --port, or any free one with --port 0"
        raise errors.BadRequest(
            f"cannot listen on {_url_host(host)}:{port}: {reason if port else error.strerror}"
        ) from None
    return listening


def _url_host(host: str) -> str:
    return f"[{host}]" if ":" in host else host


@contextlib.contextmanager
def _hidden_modules(*modules: str) -> Iterator[None]:
    """Hide modules that NiceGUI imports for clients of other servers if installed, which takes 0.2 s."""
    absent = [module for module in modules if module not in sys.modules]
    sys.modules.update(dict.fromkeys(absent))  # type: ignore[arg-type]
    try:
        yield
    finally:
        for module in absent:
            del sys.modules[module]


@contextlib.contextmanager
def _temporary_storage() -> Iterator[None]:
    """Have NiceGUI use a temporary folder for its storage, which the page does not need.

    uvicorn raises SIGTERM again at its end, which by default ends the process before the folder is removed.
    """
    logging.getLogger("nicegui").setLevel(logging.WARNING)
    before = signal.signal(signal.SIGTERM, lambda number, _: sys.exit(128 + number))
    try:
        with tempfile.TemporaryDirectory(prefix="semmap-web-") as folder:
            os.environ["NICEGUI_STORAGE_PATH"] = folder
            yield
    finally:
        signal.signal(signal.SIGTERM, before)
