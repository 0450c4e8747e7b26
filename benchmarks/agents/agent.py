"""A scripted agent that calls the tools of `semmap mcp` over stdio and counts what it reads."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import sys
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

from mcp import Client
from mcp.client.stdio import StdioServerParameters

SEMMAP = str(Path(sys.executable).parent / "semmap")


class RefusedCallError(Exception):
    """A tool call was rejected; the text is the tool's error."""


class Agent:
    """Calls tools; `calls` and `characters` count from the last `begin`."""

    def __init__(
        self, client: Client, tell: Callable[[str, dict[str, Any], str], None] | None = None
    ) -> None:
        self.client = client
        self._tell = tell
        self.begin()

    def begin(self) -> None:
        """Reset the counters."""
        self.calls = self.characters = 0

    async def __call__(self, tool: str, **fields: Any) -> dict[str, Any]:
        """Return a tool's reply. Raises RefusedCallError; rate-limited calls are retried, uncounted."""
        arguments = {name.rstrip("_"): value for name, value in fields.items()}
        while True:
            found = await self.client.call_tool(tool, arguments)
            text = found.content[-1].text  # type: ignore[union-attr]
            answer: dict[str, Any] = json.loads(text)
            if not (found.is_error and answer["error"] == "busy"):
                break
            await asyncio.sleep(answer["again_s"])
        self.calls += 1
        self.characters += len(text)
        if self._tell is not None:
            self._tell(tool, arguments, text)
        if found.is_error:
            raise RefusedCallError(answer["text"])
        return answer

    async def refused(self, tool: str, **fields: Any) -> str:
        """Return the error of a rejected tool call, or an empty text."""
        try:
            await self(tool, **fields)
        except RefusedCallError as error:
            return str(error)
        return ""

    async def committed(self, **fields: Any) -> dict[str, Any]:
        """Propose and commit a change."""
        proposed = await self("propose", **fields)
        return await self("commit", token=proposed["token"])


@contextlib.asynccontextmanager
async def talking(
    endpoint: str, *words: str, tell: Callable[[str, dict[str, Any], str], None] | None = None
) -> AsyncIterator[Agent]:
    """Start an agent with a process of `semmap mcp WORDS`."""
    environment = {**os.environ, "SEMMAP_CONNECT": endpoint}
    server = StdioServerParameters(command=SEMMAP, args=["mcp", *words], env=environment)
    async with Client(server) as client:
        yield Agent(client, tell)
