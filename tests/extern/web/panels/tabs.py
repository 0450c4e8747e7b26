"""A tab without a browser, in which panels are drawn, and events as a browser sends them."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator, Callable, Coroutine
from typing import Any

from nicegui import Client, core, ui
from nicegui.page import page


@contextlib.asynccontextmanager
async def _tab() -> AsyncIterator[Client]:
    core.loop = asyncio.get_running_loop()
    client = Client(page("/"), request=None)
    try:
        with client:
            yield client
    finally:
        client.delete()


def in_a_tab(test: Callable[[Client], Coroutine[Any, Any, None]]) -> None:
    """Run `test` in a tab of its own."""

    async def run() -> None:
        async with _tab() as client:
            await test(client)

    asyncio.run(run())


async def send_event(element: ui.element, event: str, *arguments: Any) -> None:
    """Send an event of an element, and let its handlers run."""
    listeners = [one.id for one in element._event_listeners.values() if one.type == event]
    assert listeners
    for listener in listeners:
        message = {"id": element.id, "listener_id": listener, "args": [json.dumps(one) for one in arguments]}
        element.client.handle_event(message)
    for _ in range(5):
        await asyncio.sleep(0)
