"""A client that disconnects."""

import json
import os
import subprocess

from tests.extern.mcp.conftest import SEMMAP


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
