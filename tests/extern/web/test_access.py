"""Access control: token, cookie, host and origin."""

from __future__ import annotations

import asyncio
import socket

import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.extern.web.access import Access

TOKEN = "t" * 32
HOST = ("host", "127.0.0.1:8080")


async def inside(scope, receive, send):
    if scope["type"] == "lifespan":
        return
    if scope["type"] == "websocket":
        await send({"type": "websocket.accept"})
        return
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await send({"type": "http.response.body", "body": b"inside"})


def ask(*headers, path="/", query="", kind="http", host="127.0.0.1", port=8080, extensions=None, access=None):
    """Return the messages of the reply."""
    sent = []

    async def send(message):
        sent.append(message)

    scope = {
        "type": kind,
        "path": path,
        "query_string": query.encode(),
        "headers": [(name.encode(), value.encode("latin-1")) for name, value in headers],
        "extensions": {"websocket.http.response": {}} if extensions is None else extensions,
    }
    access = access or Access(inside, host, port, TOKEN)
    asyncio.run(access(scope, None, send))
    return sent


def status(*headers, **how):
    return ask(*headers, **how)[0].get("status")


def cookie(**how):
    (said,) = [v for n, v in ask(HOST, query=f"token={TOKEN}", **how)[0]["headers"] if n == b"set-cookie"]
    return said.decode()


def sent_back():
    return ("cookie", cookie().partition(";")[0])


@pytest.mark.parametrize(
    "path", ["/", "/_nicegui/3.18.0/static/nicegui.css", "/scene/x/", "/docs", "/no/such"]
)
def test_every_path_without_token_or_cookie_returns_401(path):
    assert status(HOST, path=path) == 401
    assert (
        ask(HOST, path=path)[1]["body"]
        == b"token required; open the address with the token that semmap printed\n"
    )


def test_the_token_is_exchanged_for_a_strict_http_only_cookie():
    said = cookie()
    assert said.startswith("semmap-8080=")
    assert {"HttpOnly", "SameSite=Strict", "Path=/"} <= {part.strip() for part in said.split(";")}
    assert TOKEN not in said
    assert status(HOST, sent_back()) == 200


@pytest.mark.parametrize(
    "query", ["token=wrong", "token=", f"token={TOKEN}&token={TOKEN}", f"Token={TOKEN}", "%"]
)
def test_invalid_tokens_are_rejected(query):
    assert status(HOST, query=query) == 401


@given(st.text(max_size=40))
def test_invalid_cookies_are_rejected(text):
    said = text.encode("utf-8").decode("latin-1")
    assert status(HOST, ("cookie", f"semmap-8080={said}")) == 401
    assert status(HOST, ("cookie", said)) == 401


def test_cookies_of_other_ports_are_rejected():
    assert status(("host", "127.0.0.1:9"), sent_back(), port=9) == 401


@pytest.mark.parametrize(
    "origin",
    [
        "http://evil.example",
        "null",
        "http://127.0.0.1:8081",
        "https://127.0.0.1:8080",
        "http://localhost:8080",
    ],
)
@pytest.mark.parametrize("kind", ["http", "websocket"])
def test_other_origins_are_rejected_even_with_the_cookie(origin, kind):
    assert status(HOST, sent_back(), ("origin", origin), kind=kind) == 403


@pytest.mark.parametrize("kind", ["http", "websocket"])
def test_the_own_origin_is_accepted(kind):
    first = ask(HOST, sent_back(), ("origin", "http://127.0.0.1:8080"), kind=kind)[0]
    assert first["type"] == ("http.response.start" if kind == "http" else "websocket.accept")


@pytest.mark.parametrize(
    "host",
    [
        "evil.example:8080",
        "evil.example",
        "127.0.0.1",
        "127.0.0.1:80",
        "127.0.0.1:x",
        "",
        "[::1",
        "192.168.0.7:8080",
    ],
)
def test_foreign_hosts_are_rejected_as_in_dns_rebinding(host):
    assert status(("host", host), sent_back()) == 403
    assert status(("host", host), query=f"token={TOKEN}") == 403


def test_requests_without_a_valid_host_are_rejected():
    assert status(sent_back()) == 403
    assert status(HOST, HOST, sent_back()) == 403


@pytest.mark.parametrize(
    "host", ["localhost:8080", "[::1]:8080", "LOCALHOST:8080", f"{socket.gethostname()}:8080"]
)
def test_all_names_of_this_machine_are_accepted(host):
    assert status(("host", host), sent_back()) == 200


def test_the_wildcard_address_accepts_ip_addresses_but_no_foreign_names():
    assert status(("host", "192.168.0.7:8080"), sent_back(), host="0.0.0.0") == 200
    assert status(("host", "evil.example:8080"), sent_back(), host="0.0.0.0") == 403


def test_websockets_need_the_cookie_and_do_not_accept_the_token():
    assert status(HOST, kind="websocket") == 401
    assert status(HOST, kind="websocket", query=f"token={TOKEN}") == 401
    assert ask(HOST, kind="websocket", extensions={})[0]["type"] == "websocket.close"


def test_the_security_policy_allows_no_other_origins():
    headers = dict(ask(HOST, sent_back())[0]["headers"])
    assert b"default-src 'self'" in headers[b"content-security-policy"]
    assert b"http:" not in headers[b"content-security-policy"]
    assert headers[b"referrer-policy"] == b"no-referrer"


def test_a_missing_reply_is_an_error_unless_the_browser_disconnected():
    async def gone():
        return {"type": "http.disconnect"}

    async def fails(scope, receive, send):
        await receive()
        raise RuntimeError("No response returned.")

    async def request():
        return {"type": "http.request"}

    async def send(message):
        pass

    scope = {"type": "http", "path": "/", "query_string": b"", "headers": []}
    scope["headers"] = [(name.encode(), value.encode()) for name, value in (HOST, sent_back())]
    access = Access(fails, "127.0.0.1", 8080, TOKEN)
    asyncio.run(access(scope, gone, send))
    with pytest.raises(RuntimeError):
        asyncio.run(access(scope, request, send))


def test_lifespan_messages_are_forwarded():
    assert ask(kind="lifespan") == []
