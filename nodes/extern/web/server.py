"""The page's process: one server on one port, for the page, its assets and the scene."""

from __future__ import annotations

import contextlib
import logging
import os
import socket
import sys
import tempfile
from collections.abc import AsyncIterator, Callable, Iterator
from typing import Any, Final

import uvicorn
from fastapi import FastAPI
from msgspec import Struct

from semmap.nodes import bus
from semmap.nodes.extern.web.access import TOKEN, Access
from semmap.nodes.identity import Identity
from semmap.nodes.runtime.web_token import new_token
from semmap.schemas import errors

HOST: Final = "127.0.0.1"
PORT: Final = 8080
_CLOSING_S: Final = 1
_LARGEST_MESSAGE: Final = 64 << 20


class WebConfig(Struct, frozen=True, kw_only=True):
    """Where the page listens, and which system it shows."""

    network: bus.Network
    host: str = HOST
    port: int = PORT
    """0 is any port that is free."""
    token: str = ""
    """What opens the page; one is made up where none is given."""

    @property
    def identity(self) -> Identity | None:
        """Whose role the page acts under, where the system is secure."""
        return self.network.identity


def run(config: WebConfig, tell: Callable[[str], None]) -> None:
    """Serve the page until SIGINT or SIGTERM; `tell` is given its address when it can be opened.

    Raises BadRequest for a port that is taken, an address that is not this machine's, or a bad token.
    """
    token = new_token(config.token)
    with contextlib.closing(_listen(config.host, config.port)) as listening, _own_storage():
        bus.set_reader_threads()
        with bus.open_session(config.network) as session:
            _serve(config, token, session, listening, tell)


def _serve(
    config: WebConfig,
    token: str,
    session: bus.Session,
    listening: socket.socket,
    tell: Callable[[str], None],
) -> None:
    with _as_if_not_installed("aiohttp", "requests"):
        from nicegui import Client, ui  # after its storage has a place

    from semmap.nodes.extern.web import proxy
    from semmap.nodes.extern.web.layout import layout
    from semmap.nodes.extern.web.live import Live
    from semmap.nodes.extern.web.page import Page
    from semmap.nodes.extern.web.scene.stage import Stage
    from semmap.nodes.extern.web.scene.viser_server import SceneServer

    live, scene = Live(session, config.network, config.identity), SceneServer()
    stage = Stage(live, scene)
    port = listening.getsockname()[1]

    @contextlib.asynccontextmanager
    async def living(_: FastAPI) -> AsyncIterator[None]:
        live.start()
        address = f"http://{_written(config.host)}:{port}/"
        live.ready(address)
        tell(f"{address}?{TOKEN}={token}")
        try:
            yield
        finally:
            live.stop()
            scene.close()

    app = FastAPI(lifespan=living, docs_url=None, redoc_url=None, openapi_url=None)

    app.include_router(proxy.router(scene.at))

    @ui.page("/", title="semmap", language="en-US")
    def tab(client: Client) -> None:
        page = Page(live, client)
        stage.show(page)
        layout(page)

    ui.run_with(
        app,
        title="semmap",
        dark=None,
        tailwind=False,  # it works out styles in the browser; page.css has those that are used
        gzip_middleware_factory=None,  # it takes longer than to send it within this machine
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
        hint = "another program uses the port; choose another with --port, or --port 0 for any that is free"
        reason = hint if port else error.strerror
        raise errors.BadRequest(f"the page cannot listen on {_written(host)}:{port}: {reason}") from None
    return listening


def _written(host: str) -> str:
    return f"[{host}]" if ":" in host else host


@contextlib.contextmanager
def _as_if_not_installed(*modules: str) -> Iterator[None]:
    """NiceGUI's sockets import these for clients that ask elsewhere, where they are there; it takes 0.2 s."""
    absent = [module for module in modules if module not in sys.modules]
    sys.modules.update(dict.fromkeys(absent))  # type: ignore[arg-type]
    try:
        yield
    finally:
        for module in absent:
            del sys.modules[module]


@contextlib.contextmanager
def _own_storage() -> Iterator[None]:
    """NiceGUI keeps a folder for its storage, of which the page needs nothing: it is not the user's."""
    logging.getLogger("nicegui").setLevel(logging.WARNING)
    with tempfile.TemporaryDirectory(prefix="semmap-web-") as folder:
        os.environ["NICEGUI_STORAGE_PATH"] = folder
        yield
