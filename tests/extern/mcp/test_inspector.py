"""The protocol with an independent client: the command line of `@modelcontextprotocol/inspector`."""

import json
import os
import shutil
import subprocess

import pytest

from semmap.nodes.extern.mcp.tools import READ_TOOLS
from tests.extern.mcp.conftest import SEMMAP

INSPECTOR = "@modelcontextprotocol/inspector"


@pytest.fixture(scope="module")
def inspect(flat, tmp_path_factory):
    """`inspect(words...)`: what the inspector prints, as JSON."""
    if shutil.which("npx") is None:
        pytest.skip("npx is not installed; the inspector runs on node")
    folder = tmp_path_factory.mktemp("inspector")
    environment = {**os.environ, "SEMMAP_CONNECT": flat.endpoint, "npm_config_update_notifier": "false"}

    def run(*words):
        command = ["npx", "--yes", INSPECTOR, "--cli", SEMMAP, "mcp", *words]
        return subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, timeout=240, check=False
        )

    got = subprocess.run(
        ["npx", "--yes", "--package", INSPECTOR, "node", "--version"],
        cwd=folder, env=environment, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    if got.returncode:
        pytest.skip(f"npm could not fetch the inspector: {got.stderr[-200:]}")

    def printed(*words):
        ended = run(*words)
        assert ended.returncode == 0, ended.stderr
        return json.loads(ended.stdout)

    return printed


@pytest.mark.long
def test_the_inspector_lists_and_calls_the_tools(inspect):
    tools = inspect("--method", "tools/list")["tools"]
    assert [tool["name"] for tool in tools] == [tool.name for tool in READ_TOOLS]
    called = inspect("--method", "tools/call", "--tool-name", "get", "--tool-arg", "name=cup1")
    assert json.loads(called["content"][0]["text"])["name"] == "cup1"
    resources = inspect("--method", "resources/list")["resources"]
    assert "semmap://schema" in [resource["uri"] for resource in resources]
