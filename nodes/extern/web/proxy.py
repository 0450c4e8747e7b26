"""The scene behind the page's own origin: viser's client and its WebSocket, at `/scene/<page>/`."""

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
addEventListener("keydown", (event) => {
  if (event.target.closest && event.target.closest("input, textarea, select")) return;
  const { key, code, shiftKey, ctrlKey, altKey, metaKey } = event;
  const told = { key, code, shiftKey, ctrlKey, altKey, metaKey, bubbles: true };
  parent.document.body.dispatchEvent(new KeyboardEvent("keydown", told));
});
</script>"""
"""The scene has no panel of its own, and the page hears the keys that are pressed in it."""


def router(at: Path) -> APIRouter:
    """What answers under `/scene`, for a viser that listens at the socket `at` in the file system."""

    async def relay(websocket: WebSocket) -> None:
        await _relay(websocket, at)

    made = APIRouter()
    made.add_route(f"{PATH}/{{page}}/", _client)
    for path in (f"{PATH}/{{page}}", f"{PATH}/{{page}}/"):
        made.add_websocket_route(path, relay)
    return made


async def _client(request: Request) -> Response:
    """Viser's client: one file, in which everything is."""
    if "gzip" not in request.headers.get("accept-encoding", ""):
        return PlainTextResponse("a browser is needed", 406)
    headers = {"content-encoding": "gzip", "cache-control": "private, max-age=3600"}
    return Response(_packed(), media_type="text/html", headers=headers)


@cache
def _packed() -> bytes:
    page = (Path(viser.__file__).parent / "client/build/index.html").read_bytes()
    return gzip.compress(page.replace(b"</title>", b"</title>" + _OWN.encode(), 1), 6)


async def _relay(websocket: WebSocket, at: Path) -> None:
    """Pass on what the browser and viser say to one another, until either hangs up."""
    page = websocket.path_params["page"]
    said = [Subprotocol(word) for word in websocket.scope.get("subprotocols", ())]
    try:
        connection = await unix_connect(
            str(at),
            f"ws://localhost/{page}",
            subprotocols=said or None,
            compression=None,
            max_size=_LARGEST,
            ping_interval=None,
        )
    except OSError:
        await websocket.close(_TRY_AGAIN)
        return
    async with connection:
        await websocket.accept(connection.subprotocol)
        await _first_of(_to_viser(websocket, connection), _to_browser(websocket, connection))


async def _to_viser(websocket: WebSocket, connection: ClientConnection) -> None:
    try:
        while True:
            message = await websocket.receive()
            if message["type"] == "websocket.disconnect":
                return
            said = message.get("bytes")
            await connection.send(message["text"] if said is None else said)
    except (ConnectionClosed, WebSocketDisconnect, RuntimeError):
        return


async def _to_browser(websocket: WebSocket, connection: ClientConnection) -> None:
    try:
        async for said in connection:
            await (websocket.send_bytes(said) if isinstance(said, bytes) else websocket.send_text(said))
        await websocket.close(_GONE)
    except (ConnectionClosed, WebSocketDisconnect, RuntimeError):
        return


async def _first_of(*ways: Awaitable[None]) -> None:
    """Until one has ended; the other is then ended, too."""
    tasks = [asyncio.ensure_future(way) for way in ways]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
