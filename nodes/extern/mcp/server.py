"""The tools over the Model Context Protocol. Only this module and `http.py` use the SDK of the protocol."""

from __future__ import annotations

import asyncio
import base64
import logging
import os
import sys
import threading
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from functools import partial
from typing import Any, Final, TypeVar

import anyio
import anyio.to_thread
from mcp import types
from mcp.server.context import ServerRequestContext
from mcp.server.lowlevel import Server
from mcp.server.session import ServerSession
from mcp.server.stdio import stdio_server
from mcp.server.subscriptions import InMemorySubscriptionBus, ListenHandler, ResourceUpdated
from mcp.shared.exceptions import MCPError

from semmap.nodes.extern.mcp import resources
from semmap.nodes.extern.mcp.approval import CANCELLED
from semmap.nodes.extern.mcp.resources import Subscriptions
from semmap.nodes.extern.mcp.tools import Page, Tool, Tools, error_text
from semmap.nodes.runtime.version import version
from semmap.schemas import errors

R = TypeVar("R")
Context = ServerRequestContext[Any, Any]

MOST_LISTENERS: Final = 64
"""The maximum number of notification streams of one server."""
_AT_ONCE: Final = 8
"""The maximum number of concurrent calls."""
_log = logging.getLogger(__name__)


def server(tools: Tools) -> Server[Any]:
    """Return a server of these tools and of the resources, for any transport."""
    threads = anyio.CapacityLimiter(_AT_ONCE)
    bus = InMemorySubscriptionBus()
    listen = ListenHandler(bus, max_subscriptions=MOST_LISTENERS)
    sessions: dict[str, set[ServerSession]] = {}  # with the protocol before 2026-07-28, by subscribed URI

    async def beside(function: Callable[[], R]) -> R:
        return await anyio.to_thread.run_sync(function, limiter=threads, abandon_on_cancel=True)

    async def list_tools(_: Context, __: types.PaginatedRequestParams | None) -> types.ListToolsResult:
        return types.ListToolsResult(tools=[_described(tool) for tool in tools.by_name.values()])

    async def call_tool(_: Context, request: types.CallToolRequestParams) -> types.CallToolResult:
        cancelled = threading.Event()
        CANCELLED.set(cancelled)  # the thread of the call has a copy of this context
        try:
            page = await beside(partial(tools.call, request.name, request.arguments or {}))
        except anyio.get_cancelled_exc_class():
            cancelled.set()
            raise
        except errors.SemmapError as error:
            return _refused(error)
        except Exception:  # a bug: report it, and keep the server running
            _log.exception("the tool %r failed", request.name)
            return _refused(errors.InternalError("internal error of semmap; see its log"))
        return types.CallToolResult(content=_contents(page))

    @asynccontextmanager
    async def lifespan(_: Server[Any]) -> AsyncIterator[Subscriptions]:
        loop = asyncio.get_running_loop()
        tasks: set[asyncio.Task[None]] = set()

        async def tell(uri: str) -> None:
            await bus.publish(ResourceUpdated(uri))
            for session in tuple(sessions.get(uri, ())):
                try:
                    await session.send_resource_updated(uri)
                except Exception:  # the session has ended
                    sessions[uri].discard(session)

        def begin(uri: str) -> None:
            task = loop.create_task(tell(uri))
            tasks.add(task)
            task.add_done_callback(tasks.discard)

        def changed(uri: str) -> None:
            with suppress(RuntimeError):  # the loop has ended
                loop.call_soon_threadsafe(begin, uri)

        subscriptions = tools.subscriptions(changed)
        try:
            yield subscriptions
        finally:
            subscriptions.close()

    async def list_resources(
        _: Context, __: types.PaginatedRequestParams | None
    ) -> types.ListResourcesResult:
        return types.ListResourcesResult(resources=list(_RESOURCES))

    async def list_templates(
        _: Context, __: types.PaginatedRequestParams | None
    ) -> types.ListResourceTemplatesResult:
        return types.ListResourceTemplatesResult(resource_templates=list(_TEMPLATES))

    async def read_resource(_: Context, request: types.ReadResourceRequestParams) -> types.ReadResourceResult:
        text = await _answered(beside(partial(tools.read, request.uri)))
        contents = types.TextResourceContents(uri=request.uri, text=text, mime_type="application/json")
        return types.ReadResourceResult(contents=[contents])

    async def subscribe(context: Context, request: types.SubscribeRequestParams) -> types.EmptyResult:
        subscriptions: Subscriptions = context.lifespan_context
        if context.session not in sessions.get(request.uri, ()):
            await _answered(beside(partial(subscriptions.subscribe, request.uri)))
            sessions.setdefault(request.uri, set()).add(context.session)
        return types.EmptyResult()

    async def unsubscribe(context: Context, request: types.UnsubscribeRequestParams) -> types.EmptyResult:
        subscriptions: Subscriptions = context.lifespan_context
        if context.session in sessions.get(request.uri, ()):
            sessions[request.uri].discard(context.session)
            await beside(partial(subscriptions.unsubscribe, request.uri))
        return types.EmptyResult()

    async def listen_to(
        context: Context, request: types.SubscriptionsListenRequestParams
    ) -> types.SubscriptionsListenResult:
        subscriptions: Subscriptions = context.lifespan_context
        followed: list[str] = []
        try:
            for uri in request.notifications.resource_subscriptions or ():
                await _answered(beside(partial(subscriptions.subscribe, uri)))
                followed.append(uri)
            return await listen(context, request)
        finally:
            with anyio.CancelScope(shield=True):
                for uri in followed:
                    await beside(partial(subscriptions.unsubscribe, uri))

    return Server(
        "semmap",
        version=version(),
        title="semmap",
        description="A robot's semantic map.",
        instructions=tools.instructions,
        on_list_tools=list_tools,
        on_call_tool=call_tool,
        on_list_resources=list_resources,
        on_list_resource_templates=list_templates,
        on_read_resource=read_resource,
        on_subscribe_resource=subscribe,
        on_unsubscribe_resource=unsubscribe,
        on_subscriptions_listen=listen_to,
        lifespan=lifespan,
    )


def run_stdio(tools: Tools) -> None:
    """Serve on stdin and stdout until stdin ends or stdout is closed."""

    async def serve() -> None:
        made = server(tools)
        async with stdio_server() as (read, write):
            await made.run(read, write, made.create_initialization_options())

    try:
        anyio.run(serve)
    except* BrokenPipeError:  # the client has ended; discard the remaining output
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


_RESOURCES: Final = (
    types.Resource(
        uri=resources.SCHEMA,
        name="schema",
        description="For queries: the prefixes, and the URIs of the classes and properties.",
        mime_type="application/json",
    ),
    types.Resource(
        uri=resources.CLASSES,
        name="classes",
        description="The classes with their parents, in pages.",
        mime_type="application/json",
    ),
    types.Resource(
        uri=resources.PROPERTIES,
        name="properties",
        description="The properties that can be set, with domain and range, in pages.",
        mime_type="application/json",
    ),
)
_TEMPLATES: Final = tuple(
    types.ResourceTemplate(
        uri_template=f"{resources.WATCH}{kind}/{{{word}}}",
        name=f"watch {kind}",
        description=f"{what}; subscribe to be notified of changes.",
        mime_type="application/json",
    )
    for kind, word, what in (
        ("in", "place", "The entities in a place or container"),
        ("on", "name", "The entities on another one"),
        ("near", "name", "The entities near another one"),
        ("class", "class", "The entities of a class"),
        ("query", "select", "The rows of a SPARQL SELECT, percent-encoded"),
    )
)


async def _answered(waiting: Awaitable[R]) -> R:
    """Return the result; raise a SemmapError as an error of the protocol."""
    try:
        return await waiting
    except errors.SemmapError as error:
        code = types.INTERNAL_ERROR if isinstance(error, errors.NoAnswer) else types.INVALID_PARAMS
        raise MCPError(code=code, message=errors.shortened(error.text, 1000)) from None


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
    return types.CallToolResult(content=[types.TextContent(text=error_text(error))], is_error=True)
