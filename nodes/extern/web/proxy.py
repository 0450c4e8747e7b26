"""A proxy for the client and the WebSocket of viser, at `/scene/<page>/` of the page's origin."""

from __future__ import annotations

import asyncio
import gzip
from collections.abc import Awaitable
from functools import cache
from pathlib import Path
from typing import Final

import viser
from fastapi import APIRouter, Request, Response, WebSocket, WebSocketDisconnect
from fastapi.responses import PlainTextResponse
from websockets.asyncio.client import ClientConnection, unix_connect
from websockets.exceptions import ConnectionClosed
from websockets.typing import Subprotocol

PATH: Final = "/scene"
_LARGEST: Final = 64 << 20
_GONE: Final = 1001
_TRY_AGAIN: Final = 1013
_OWN: Final = """<style>
div:has(canvas) ~ div, .mantine-Notifications-root { display: none !important; }
</style><script>
const press = (init) =>
  parent.document.body.dispatchEvent(new KeyboardEvent("keydown", { ...init, bubbles: true }));
addEventListener("keydown", (event) => {
  if (event.target.closest && event.target.closest("input, textarea, select")) return;
  const { key, code, shiftKey, ctrlKey, altKey, metaKey } = event;
  press({ key, code, shiftKey, ctrlKey, altKey, metaKey });
});
addEventListener("keydown", (event) => {
  if (!event.key.startsWith("Arrow") || event.ctrlKey || event.altKey || event.metaKey) return;
  if (!parent.document.querySelector(".semmap-marks")?.dataset.selected) return;
  event.stopImmediatePropagation();
  const { key, shiftKey } = event;
  press({ key, shiftKey });
}, true);
addEventListener("dblclick", (event) => {
  if (event.target.tagName === "CANVAS") press({ key: "f" });
});
</script>"""
"""Hides the panels of viser, and forwards key presses to the page; a double click is the key `f`.

The arrow keys turn the view only without a selection, which they move otherwise.
"""


def router(at: Path) -> APIRouter:
    """Return the routes under `/scene` for a viser server on the Unix socket `at`."""

    async def relay(websocket: WebSocket) -> None:
        await _relay(websocket, at)

    made = APIRouter()
    made.add_route(f"{PATH}/{{page}}/", _client)
    for path in (f"{PATH}/{{page}}", f"{PATH}/{{page}}/"):
        made.add_websocket_route(path, relay)
    return made


async def _client(request: Request) -> Response:
    """Return the client of viser, which is a single file."""
    if "gzip" not in request.headers.get("accept-encoding", ""):
        return PlainTextResponse("gzip encoding required; open this address in a browser", 406)
    headers = {"content-encoding": "gzip", "cache-control": "private, max-age=3600"}
    return Response(_packed(), media_type="text/html", headers=headers)


@cache
def _packed() -> bytes:
    page = (Path(viser.__file__).parent / "client/build/index.html").read_bytes()
    return gzip.compress(page.replace(b"</title>", b"</title>" + _OWN.encode(), 1), 6)


async def _relay(websocket: WebSocket, at: Path) -> None:
    """Relay messages between the browser and viser until one of them closes the connection."""
    page = websocket.path_params["page"]
    subprotocols = [Subprotocol(name) for name in websocket.scope.get("subprotocols", ())]
    try:
        connection = await unix_connect(
            str(at),
            f"ws://localhost/{page}",
            subprotocols=subprotocols or None,
            compression=None,
            max_size=_LARGEST,
            ping_interval=None,
        )
    except OSError:
        await websocket.close(_TRY_AGAIN)
        return
    async with connection:
        await websocket.accept(connection.subprotocol)
        await _run_until_first(_to_viser(websocket, connection), _to_browser(websocket, connection))


async def _to_viser(websocket: WebSocket, connection: ClientConnection) -> None:
    try:
        while True:
            message = await websocket.receive()
            if message["type"] == "websocket.disconnect":
                return
            content = message.get("bytes")
            await connection.send(message["text"] if content is None else content)
    except (ConnectionClosed, WebSocketDisconnect, RuntimeError):
        return


async def _to_browser(websocket: WebSocket, connection: ClientConnection) -> None:
    try:
        async for message in connection:
            if isinstance(message, bytes):
                await websocket.send_bytes(message)
            else:
                await websocket.send_text(message)
        await websocket.close(_GONE)
    except (ConnectionClosed, WebSocketDisconnect, RuntimeError):
        return


async def _run_until_first(*directions: Awaitable[None]) -> None:
    """Run both directions until one has ended, and cancel the other."""
    tasks = [asyncio.ensure_future(direction) for direction in directions]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
