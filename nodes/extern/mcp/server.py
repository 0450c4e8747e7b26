"""The tools over the Model Context Protocol, by its SDK. Nobody else here knows it."""

from __future__ import annotations

import base64
import logging
from collections.abc import Callable
from functools import partial
from typing import Any, Final, TypeVar

import anyio
import anyio.to_thread
from mcp import types
from mcp.server.context import ServerRequestContext
from mcp.server.lowlevel import Server
from mcp.server.stdio import stdio_server

from nodes.extern.mcp.tools import Page, Tool, Tools, complaint
from nodes.runtime.version import version
from schemas import errors

R = TypeVar("R")
Context = ServerRequestContext[Any, Any]

_AT_ONCE: Final = 8
"""Calls that are at work at the same time."""
_log = logging.getLogger(__name__)


def server(tools: Tools) -> Server[Any]:
    """A server of these tools, for any transport."""
    threads = anyio.CapacityLimiter(_AT_ONCE)

    async def beside(function: Callable[[], R]) -> R:
        return await anyio.to_thread.run_sync(function, limiter=threads, abandon_on_cancel=True)

    async def list_tools(_: Context, __: types.PaginatedRequestParams | None) -> types.ListToolsResult:
        return types.ListToolsResult(tools=[_described(tool) for tool in tools.by_name.values()])

    async def call_tool(_: Context, asked: types.CallToolRequestParams) -> types.CallToolResult:
        try:
            page = await beside(partial(tools.call, asked.name, asked.arguments or {}))
        except errors.SemmapError as error:
            return _refused(error)
        except Exception:  # a fault of ours: told as one, and the server lives on
            _log.exception("the tool %r failed", asked.name)
            return _refused(errors.InternalError("a fault in semmap itself; it has been logged"))
        return types.CallToolResult(content=_contents(page))

    return Server(
        "semmap",
        version=version(),
        title="semmap",
        description="A robot's semantic map.",
        instructions=tools.instructions,
        on_list_tools=list_tools,
        on_call_tool=call_tool,
    )


def run_stdio(tools: Tools) -> None:
    """Serve on stdin and stdout until stdin ends."""

    async def serve() -> None:
        made = server(tools)
        async with stdio_server() as (read, write):
            await made.run(read, write, made.create_initialization_options())

    anyio.run(serve)


def _described(tool: Tool) -> types.Tool:
    return types.Tool(
        name=tool.name,
        description=tool.description,
        input_schema=tool.schema,
        annotations=types.ToolAnnotations(
            read_only_hint=not tool.changes, destructive_hint=tool.changes, open_world_hint=False
        ),
    )


def _contents(page: Page) -> list[types.ContentBlock]:
    text = types.TextContent(text=page.text)
    if not page.png:
        return [text]
    return [types.ImageContent(data=base64.b64encode(page.png).decode(), mime_type="image/png"), text]


def _refused(error: errors.SemmapError) -> types.CallToolResult:
    return types.CallToolResult(content=[types.TextContent(text=complaint(error))], is_error=True)
