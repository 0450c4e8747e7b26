"""Who is let in: with the token or the cookie, by an address of the page itself, from no other origin."""

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
    """What is sent back, as a list of messages."""
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
def test_without_token_or_cookie_every_path_answers_401(path):
    assert status(HOST, path=path) == 401
    assert (
        ask(HOST, path=path)[1]["body"]
        == b"token required; open the address with the token that semmap printed\n"
    )


def test_the_token_is_exchanged_for_a_cookie_that_scripts_and_other_sites_cannot_use():
    said = cookie()
    assert said.startswith("semmap-8080=")
    assert {"HttpOnly", "SameSite=Strict", "Path=/"} <= {part.strip() for part in said.split(";")}
    assert TOKEN not in said
    assert status(HOST, sent_back()) == 200


@pytest.mark.parametrize(
    "query", ["token=wrong", "token=", f"token={TOKEN}&token={TOKEN}", f"Token={TOKEN}", "%"]
)
def test_what_is_not_the_token_opens_nothing(query):
    assert status(HOST, query=query) == 401


@given(st.text(max_size=40))
def test_no_cookie_but_the_right_one_opens(text):
    said = text.encode("utf-8").decode("latin-1")
    assert status(HOST, ("cookie", f"semmap-8080={said}")) == 401
    assert status(HOST, ("cookie", said)) == 401


def test_the_cookie_of_a_page_at_another_port_is_none():
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
def test_another_origin_is_refused_even_with_the_cookie(origin, kind):
    assert status(HOST, sent_back(), ("origin", origin), kind=kind) == 403


@pytest.mark.parametrize("kind", ["http", "websocket"])
def test_the_own_origin_is_let_in(kind):
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
def test_a_foreign_host_is_refused_as_by_rebinding_a_name(host):
    assert status(("host", host), sent_back()) == 403
    assert status(("host", host), query=f"token={TOKEN}") == 403


def test_without_a_host_nobody_comes_in():
    assert status(sent_back()) == 403
    assert status(HOST, HOST, sent_back()) == 403


@pytest.mark.parametrize(
    "host", ["localhost:8080", "[::1]:8080", "LOCALHOST:8080", f"{socket.gethostname()}:8080"]
)
def test_this_machine_has_several_names(host):
    assert status(("host", host), sent_back()) == 200


def test_listening_everywhere_it_is_called_by_addresses_and_by_no_foreign_name():
    assert status(("host", "192.168.0.7:8080"), sent_back(), host="0.0.0.0") == 200
    assert status(("host", "evil.example:8080"), sent_back(), host="0.0.0.0") == 403


def test_a_websocket_without_cookie_is_refused_with_401_and_the_token_does_not_open_it():
    assert status(HOST, kind="websocket") == 401
    assert status(HOST, kind="websocket", query=f"token={TOKEN}") == 401
    assert ask(HOST, kind="websocket", extensions={})[0]["type"] == "websocket.close"


def test_what_is_shown_may_fetch_nothing_from_elsewhere():
    headers = dict(ask(HOST, sent_back())[0]["headers"])
    assert b"default-src 'self'" in headers[b"content-security-policy"]
    assert b"http:" not in headers[b"content-security-policy"]
    assert headers[b"referrer-policy"] == b"no-referrer"


def test_a_browser_that_has_gone_is_no_error_and_a_fault_is_one():
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


def test_the_start_and_the_end_of_the_server_pass():
    assert ask(kind="lifespan") == []
