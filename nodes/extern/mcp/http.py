"""The server over streamable HTTP, on this machine only, for clients with the token."""

from __future__ import annotations

import secrets
import socket
from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any, Final

import uvicorn

from semmap.nodes.extern.mcp.server import server
from semmap.nodes.extern.mcp.tools import Tools
from semmap.schemas import errors

HOST: Final = "127.0.0.1"
PORT: Final = 7448
TOKEN_VARIABLE: Final = "SEMMAP_MCP_TOKEN"
SHORTEST_TOKEN: Final = 16
_LARGEST_BODY: Final = 1 << 20

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]


def choose_token(token: str | None) -> str:
    """Return the configured token, or a new random one. Raises BadRequest for a token that is too short."""
    if not token:
        return secrets.token_urlsafe(24)
    if len(token) < SHORTEST_TOKEN or not token.isascii():
        raise errors.BadRequest(f"{TOKEN_VARIABLE} must have at least {SHORTEST_TOKEN} ASCII characters")
    return token


def run_http(tools: Tools, port: int, token: str, tell: Callable[[str], None]) -> None:
    """Serve on loopback until interrupted. Raises BadRequest if the port is in use."""
    listening = _listen(port)
    made = server(tools)
    app = require_token(token, made.streamable_http_app(host=HOST, max_request_body_size=_LARGEST_BODY))
    config = uvicorn.Config(app, log_level="warning", lifespan="on")
    tell(f"http://{HOST}:{listening.getsockname()[1]}/mcp")
    tell(f"Authorization: Bearer {token}")
    uvicorn.Server(config).run(sockets=[listening])


def require_token(token: str, app: App) -> App:
    """Wrap `app`: requests without the token are rejected with status 401."""
    expected = f"Bearer {token}".encode()

    async def guarded(scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await app(scope, receive, send)
            return
        given = [value for name, value in scope["headers"] if name == b"authorization"]
        if scope["type"] == "http" and len(given) == 1 and secrets.compare_digest(given[0], expected):
            await app(scope, receive, send)
            return
        if scope["type"] != "http":
            await send({"type": "websocket.close"})
            return
        headers = [(b"www-authenticate", b"Bearer"), (b"content-type", b"text/plain")]
        await send({"type": "http.response.start", "status": 401, "headers": headers})
        text = b"missing or wrong token; use the one printed by semmap mcp: Authorization: Bearer TOKEN\n"
        await send({"type": "http.response.body", "body": text})

    return guarded


def _listen(port: int) -> socket.socket:
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((HOST, port))
        listening.listen()
    except OSError as error:
        listening.close()
        raise errors.BadRequest(
            f"cannot listen on {HOST}:{port}: {error.strerror}; choose another port: --http PORT"
        ) from None
    return listening
