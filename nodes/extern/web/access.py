"""Access control: browsers need the printed token, and pages of other origins are rejected.

It covers everything that is served: pages, assets, WebSockets and the scene.
"""

from __future__ import annotations

import hmac
import ipaddress
import socket
from collections.abc import Awaitable, Callable, MutableMapping
from http.cookies import CookieError, SimpleCookie
from typing import Any, Final
from urllib.parse import parse_qs, urlsplit

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

TOKEN: Final = "token"
_HTTP: Final = 80
_LOOPBACK: Final = frozenset(("127.0.0.1", "localhost", "::1"))
_POLICY: Final = (
    "default-src 'self' 'unsafe-inline' 'unsafe-eval' data: blob:; frame-ancestors 'self'; form-action 'self'"
)
"""The page may not load anything from other origins; the browser enforces this."""
_HEADERS: Final = (
    (b"content-security-policy", _POLICY.encode()),
    (b"referrer-policy", b"no-referrer"),
    (b"x-content-type-options", b"nosniff"),
)


class Access:
    """An ASGI application that requires the token, or the cookie that was given in exchange for it."""

    def __init__(self, app: App, host: str, port: int, token: str) -> None:
        """`host` and `port` are the address of the page. `token` is valid until this process ends."""
        self._app = app
        self._port = port
        self._hosts = _LOOPBACK | {host.lower(), socket.gethostname().lower()}
        self._any_address = _is_any(host)
        self._token = token.encode()
        self._cookie = hmac.digest(self._token, b"cookie", "sha256").hex()
        self._cookie_name = f"semmap-{port}"
        """It contains the port, because a browser sends the cookies of a host to all its ports."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass an authorized request to the application, and reject others."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        headers = _headers(scope)
        if not self._is_own_host(headers.get("host", "")):
            await _reject(scope, send, 403, "unknown host name; open the address that semmap printed")
        elif not self._is_own_origin(headers):
            await _reject(scope, send, 403, "requests from other origins are not allowed")
        elif scope["type"] == "http" and self._has_token(scope):  # also with a cookie: it hides the token
            await self._exchange(scope, send)
        elif self._has_cookie(headers):
            await self._forward(scope, receive, send)
        else:
            await _reject(
                scope, send, 401, "token required; open the address with the token that semmap printed"
            )

    async def _forward(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request to the application.

        A missing reply is not an error if the browser disconnected.
        """
        is_disconnected = False

        async def receiving() -> MutableMapping[str, Any]:
            nonlocal is_disconnected
            message = await receive()
            is_disconnected = is_disconnected or message["type"] == "http.disconnect"
            return message

        try:
            await self._app(scope, receiving, _with_headers(send))
        except RuntimeError:
            if not is_disconnected:
                raise

    def _is_own_host(self, header: str) -> bool:
        """Return whether the header has an address of the page; this prevents DNS rebinding."""
        try:
            parts = urlsplit(f"//{header}")
            host, port = (parts.hostname or "").lower(), parts.port
        except ValueError:
            return False
        if (port or _HTTP) != self._port:
            return False
        return host in self._hosts or (self._any_address and _is_address(host))

    def _is_own_origin(self, headers: dict[str, str]) -> bool:
        """Return whether the request has the origin of the page, or none, as from other programs."""
        origin = headers.get("origin")
        return origin is None or origin.lower() == f"http://{headers['host']}".lower()

    def _has_cookie(self, headers: dict[str, str]) -> bool:
        try:
            cookie = SimpleCookie(headers.get("cookie", "")).get(self._cookie_name)
        except CookieError:
            return False
        return cookie is not None and hmac.compare_digest(cookie.value.encode(), self._cookie.encode())

    def _has_token(self, scope: Scope) -> bool:
        tokens = parse_qs(scope["query_string"].decode("latin-1")).get(TOKEN, [])
        return len(tokens) == 1 and hmac.compare_digest(tokens[0].encode(), self._token)

    async def _exchange(self, scope: Scope, send: Send) -> None:
        """Set the cookie, and open the page without the token, which is then in no address or log."""
        cookie = f"{self._cookie_name}={self._cookie}; Path=/; HttpOnly; SameSite=Strict"
        headers = [
            (b"content-type", b"text/html; charset=utf-8"),
            (b"cache-control", b"no-store"),
            (b"set-cookie", cookie.encode()),
            *_HEADERS,
        ]
        # After an HTTP redirect from a link on another site, the browser would not send a strict cookie.
        text = '<!doctype html><title>semmap</title><meta http-equiv="refresh" content="0; url=/">'
        await send({"type": "http.response.start", "status": 200, "headers": headers})
        await send({"type": "http.response.body", "body": text.encode()})


def _headers(scope: Scope) -> dict[str, str]:
    """Return the headers by lower-case name. Values of repeated headers are joined, and thus invalid."""
    found: dict[str, str] = {}
    for name, value in scope["headers"]:
        key, text = name.decode("latin-1").lower(), value.decode("latin-1")
        joint = "; " if key == "cookie" else ", "
        found[key] = f"{found[key]}{joint}{text}" if key in found else text
    return found


async def _reject(scope: Scope, send: Send, status: int, text: str) -> None:
    body = f"{text}\n".encode()
    headers = [(b"content-type", b"text/plain; charset=utf-8"), (b"content-length", str(len(body)).encode())]
    kind = "http"
    if scope["type"] == "websocket":
        if "websocket.http.response" not in scope.get("extensions", {}):
            await send({"type": "websocket.close", "code": 1008})
            return
        kind = "websocket.http"
    await send({"type": f"{kind}.response.start", "status": status, "headers": headers})
    await send({"type": f"{kind}.response.body", "body": body})


def _with_headers(send: Send) -> Send:
    async def sending(message: MutableMapping[str, Any]) -> None:
        if message["type"] == "http.response.start":
            message = {**message, "headers": [*message.get("headers", ()), *_HEADERS]}
        await send(message)

    return sending


def _is_any(host: str) -> bool:
    """Return whether the address stands for all addresses of this machine."""
    return _is_address(host) and ipaddress.ip_address(host).is_unspecified


def _is_address(host: str) -> bool:
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False
    return True
