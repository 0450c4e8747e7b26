"""A client that disconnects, and a system that is not running."""

import json
import os
import subprocess

from semmap.nodes.supervisor.ports import free_endpoint
from tests.extern.mcp.conftest import SEMMAP, by_stdio, run


def test_a_server_starts_before_its_system_and_says_so():
    async def session():
        words = ("--allow", "change", "--classes", "Cup")
        async with by_stdio(free_endpoint(), *words) as agent:
            return await agent.tools(), await agent.refused("overview")

    tools, refused = run(session())
    assert {"overview", "propose"} <= set(tools)
    assert refused.startswith("no response from tcp/127.0.0.1:")
    assert refused.endswith("start a system with: semmap up")


def test_when_the_client_is_gone_the_server_ends_without_a_word(flat, tmp_path):
    errors = tmp_path / "stderr"
    with errors.open("w") as stderr:
        server = subprocess.Popen(
            [SEMMAP, "mcp"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=stderr,
            env={**os.environ, "SEMMAP_CONNECT": flat.endpoint},
            text=True,
        )
    fields = {
        "protocolVersion": "2025-06-18",
        "capabilities": {},
        "clientInfo": {"name": "x", "version": "1"},
    }
    asked = {"jsonrpc": "2.0", "id": 1, "method": "initialize", "params": fields}
    server.stdin.write(json.dumps(asked) + "\n")
    server.stdin.flush()
    assert server.stdout.readline()
    server.stdout.close()  # its replies are no longer read
    server.stdin.write(json.dumps({**asked, "id": 2, "method": "ping", "params": {}}) + "\n")
    server.stdin.close()
    assert server.wait(30) == 0
    assert errors.read_text() == ""
