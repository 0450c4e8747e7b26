import asyncio
import contextlib
import json
import os
import sys
from pathlib import Path

import pytest
from mcp import Client
from mcp.client.stdio import StdioServerParameters

SEMMAP = str(Path(sys.executable).parent / "semmap")


@pytest.fixture(scope="module")
def flat(flat_map):
    """The flat, without a simulator: what is asked of it does not move."""
    return flat_map


class Agent:
    """What an agent's host does: calls of tools, one after another."""

    def __init__(self, client):
        self.client = client

    async def tools(self):
        return [tool.name for tool in (await self.client.list_tools()).tools]

    async def raw(self, tool, **arguments):
        fields = {name.rstrip("_"): value for name, value in arguments.items()}
        return await self.client.call_tool(tool, fields)

    async def __call__(self, tool, **arguments):
        """What the tool answers, as JSON; it must not refuse."""
        found = await self.raw(tool, **arguments)
        assert not found.is_error, found.content[-1].text
        return json.loads(found.content[-1].text)

    async def refused(self, tool, **arguments):
        """The sentence with which it refuses."""
        found = await self.raw(tool, **arguments)
        assert found.is_error, found.content[-1].text
        return json.loads(found.content[-1].text)["text"]


@contextlib.asynccontextmanager
async def by_stdio(endpoint, *words, **variables):
    """An agent that talks to `semmap mcp WORDS`, a process of its own."""
    server = StdioServerParameters(
        command=SEMMAP, args=["mcp", *words], env={**os.environ, "SEMMAP_CONNECT": endpoint, **variables}
    )
    async with Client(server) as client:
        yield Agent(client)


@contextlib.asynccontextmanager
async def in_memory(made):
    """An agent that talks to a server in this process."""
    async with Client(made) as client:
        yield Agent(client)


def run(coroutine):
    """Run it, and end what hangs."""
    return asyncio.run(asyncio.wait_for(coroutine, 120))
