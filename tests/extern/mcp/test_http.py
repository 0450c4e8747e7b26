import asyncio
import re
import subprocess
import urllib.error
import urllib.request

import pytest
from mcp import Client
from mcp.client.streamable_http import streamable_http_client

from semmap.nodes.extern.mcp.http import choose_token, require_token
from semmap.schemas import errors
from tests.extern.mcp.conftest import Agent, run

TOKEN = "a-token-that-is-long-enough"


@pytest.fixture(scope="module")
def served(flat):
    """The URL of a server."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SEMMAP_MCP_TOKEN", TOKEN)
        with flat.spawned("mcp", "--http", "0", stderr=subprocess.PIPE) as process:
            url = process.stderr.readline().strip()
            assert re.fullmatch(r"http://127\.0\.0\.1:\d+/mcp", url)
            assert process.stderr.readline().strip() == f"Authorization: Bearer {TOKEN}"
            yield url
        process.stderr.close()


def status(url, **headers):
    request = urllib.request.Request(url, data=b"{}", headers={"Content-Type": "application/json", **headers})
    try:
        with urllib.request.urlopen(request, timeout=30) as reply:
            return reply.status
    except urllib.error.HTTPError as error:
        with error:
            return error.code


def test_who_has_the_token_reads_the_map(served):
    import httpx2

    async def session():
        async with (
            httpx2.AsyncClient(headers={"Authorization": f"Bearer {TOKEN}"}, timeout=60) as http,
            Client(streamable_http_client(served, http_client=http)) as client,
        ):
            agent = Agent(client)
            assert "overview" in await agent.tools()
            return await agent("get", name="cup1")

    assert run(session())["name"] == "cup1"


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"Authorization": ""},
        {"Authorization": "Bearer wrong"},
        {"Authorization": f"Bearer {TOKEN}x"},
        {"Authorization": TOKEN},
        {"Authorization": f"Basic {TOKEN}"},
    ],
)
def test_other_clients_are_rejected(served, headers):
    assert status(served, **headers) == 401


def test_a_page_of_another_site_is_not_let_in_though_it_had_the_token(served):
    bearing = {"Authorization": f"Bearer {TOKEN}"}
    assert status(served, **bearing, Origin="http://evil.example") == 403
    assert status(served, **bearing, Host="evil.example") in (403, 421)


def test_a_token_of_one_s_own_must_be_long():
    assert len(choose_token(None)) >= 32
    assert choose_token(None) != choose_token(None)
    assert choose_token(TOKEN) == TOKEN
    with pytest.raises(errors.BadRequest, match="at least 16"):
        choose_token("secret")


def test_a_request_with_two_tokens_does_not_reach_the_server():
    reached, sent = [], []

    async def app(scope, receive, send):
        reached.append(scope)

    async def send(message):
        sent.append(message)

    two = [(b"authorization", f"Bearer {TOKEN}".encode()), (b"authorization", b"Bearer x")]
    guarded = require_token(TOKEN, app)
    asyncio.run(guarded({"type": "http", "headers": two}, None, send))
    asyncio.run(guarded({"type": "websocket", "headers": []}, None, send))
    assert not reached
    assert sent[0]["status"] == 401
    asyncio.run(guarded({"type": "http", "headers": two[:1]}, None, send))
    assert len(reached) == 1


def test_a_port_that_is_taken_is_reported(flat, served):
    port = re.search(r":(\d+)/", served)[1]
    assert f"cannot listen on 127.0.0.1:{port}" in flat.cli("mcp", "--http", port, status=2)
