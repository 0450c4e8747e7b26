"""Who may come in: those who know the token that was printed, and no page of another origin.

Everything that is served is behind this: pages, assets, WebSockets, the scene.
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
"""Nothing that the page shows may fetch anything from elsewhere; the browser itself sees to it."""
_HEADERS: Final = (
    (b"content-security-policy", _POLICY.encode()),
    (b"referrer-policy", b"no-referrer"),
    (b"x-content-type-options", b"nosniff"),
)


class Access:
    """An ASGI application that lets in who knows the token, or has the cookie that it was exchanged for."""

    def __init__(self, app: App, host: str, port: int, token: str) -> None:
        """`host` and `port` are where the page listens. `token` is valid as long as this process lives."""
        self._app = app
        self._port = port
        self._hosts = _LOOPBACK | {host.lower(), socket.gethostname().lower()}
        self._any_address = _is_any(host)
        self._token = token.encode()
        self._cookie = hmac.digest(self._token, b"cookie", "sha256").hex()
        self._cookie_name = f"semmap-{port}"
        """A browser sends the cookies of a host to all its ports."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer, or let the application answer."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        headers = _headers(scope)
        if not self._is_own_host(headers.get("host", "")):
            await _refuse(
                scope, send, 403, "this address is not the page's; open the one that semmap printed"
            )
        elif not self._is_own_origin(headers):
            await _refuse(scope, send, 403, "the page does not answer pages of another origin")
        elif scope["type"] == "http" and self._has_token(
            scope
        ):  # which leaves the address even if it is known
            await self._exchange(scope, send)
        elif self._is_known(headers):
            await self._answer(scope, receive, send)
        else:
            await _refuse(scope, send, 401, "open the address with the token that semmap printed")

    async def _answer(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let the application answer; where the browser has gone meanwhile, no answer is no error."""
        is_gone = False

        async def receiving() -> MutableMapping[str, Any]:
            nonlocal is_gone
            message = await receive()
            is_gone = is_gone or message["type"] == "http.disconnect"
            return message

        try:
            await self._app(scope, receiving, _with_headers(send))
        except RuntimeError:
            if not is_gone:
                raise

    def _is_own_host(self, said: str) -> bool:
        """Is it an address of the page's own? A foreign name may be made to point here (rebinding)."""
        try:
            parts = urlsplit(f"//{said}")
            host, port = (parts.hostname or "").lower(), parts.port
        except ValueError:
            return False
        if (port or _HTTP) != self._port:
            return False
        return host in self._hosts or (self._any_address and _is_address(host))

    def _is_own_origin(self, headers: dict[str, str]) -> bool:
        """A browser says from which origin a page asks; a program that is none need not say."""
        origin = headers.get("origin")
        return origin is None or origin.lower() == f"http://{headers['host']}".lower()

    def _is_known(self, headers: dict[str, str]) -> bool:
        try:
            cookie = SimpleCookie(headers.get("cookie", "")).get(self._cookie_name)
        except CookieError:
            return False
        return cookie is not None and hmac.compare_digest(cookie.value.encode(), self._cookie.encode())

    def _has_token(self, scope: Scope) -> bool:
        said = parse_qs(scope["query_string"].decode("latin-1")).get(TOKEN, [])
        return len(said) == 1 and hmac.compare_digest(said[0].encode(), self._token)

    async def _exchange(self, scope: Scope, send: Send) -> None:
        """Give the cookie, and go on without the token: it stays neither in the address nor in a log."""
        cookie = f"{self._cookie_name}={self._cookie}; Path=/; HttpOnly; SameSite=Strict"
        headers = [
            (b"content-type", b"text/html; charset=utf-8"),
            (b"cache-control", b"no-store"),
            (b"set-cookie", cookie.encode()),
            *_HEADERS,
        ]
        # A redirection would be part of the visit of whoever has the link, and a strict cookie not be sent.
        text = '<!doctype html><title>semmap</title><meta http-equiv="refresh" content="0; url=/">'
        await send({"type": "http.response.start", "status": 200, "headers": headers})
        await send({"type": "http.response.body", "body": text.encode()})


def _headers(scope: Scope) -> dict[str, str]:
    """By name, in lower case. Of what is said twice the values are joined, which is then no valid one."""
    found: dict[str, str] = {}
    for name, value in scope["headers"]:
        key, text = name.decode("latin-1").lower(), value.decode("latin-1")
        joint = "; " if key == "cookie" else ", "
        found[key] = f"{found[key]}{joint}{text}" if key in found else text
    return found


async def _refuse(scope: Scope, send: Send, status: int, text: str) -> None:
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
    """Does it listen at all addresses of this machine?"""
    return _is_address(host) and ipaddress.ip_address(host).is_unspecified


def _is_address(host: str) -> bool:
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False
    return True
