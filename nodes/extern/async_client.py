"""The client for an event loop: the same methods as `Client`, as coroutines.

    async with semmap.aio.connect() as client:
        await client.add("Cup", "cup1", at=(1.0, 2.0, 0.75))
        async with client.commits() as commits:
            async for commit in commits:
                print(commit.seq, commit.reason)

Each call waits for its reply on a thread; up to 32 calls can wait at the same time. A call whose task is
cancelled was already sent and may be executed. With an `id` it can be sent again and is executed once.
"""

from __future__ import annotations

import asyncio
import contextlib
import functools
import threading
from collections.abc import AsyncIterator, Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, Final, Literal, TypeVar

from semmap.nodes.extern.client import LONG_S, Client
from semmap.nodes.extern.client import connect as connect_blocking
from semmap.nodes.extern.client_commands import CommandMethods
from semmap.nodes.extern.sparql_client import StandingQuery
from semmap.schemas import errors
from semmap.schemas.backups import Opening
from semmap.schemas.commands import Command
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Source
from semmap.schemas.sparql import RowsChanged

R = TypeVar("R")
T = TypeVar("T")

_CALLS_AT_ONCE: Final = 32


@contextlib.asynccontextmanager
async def connect(
    where: str | None = None,
    *,
    source: Source | None = None,
    agent: str = "",
    namespace: str | None = None,
    identity: str | None = None,
    mode: Literal["peer", "client"] | None = None,
) -> AsyncIterator[AsyncClient]:
    """Connect to the system at `where`; see `semmap.connect`. Raises NoAnswer without a response."""
    threads = ThreadPoolExecutor(_CALLS_AT_ONCE, thread_name_prefix="semmap")
    connection = connect_blocking(
        where, source=source, agent=agent, namespace=namespace, identity=identity, mode=mode
    )
    loop = asyncio.get_running_loop()
    try:
        client = await loop.run_in_executor(threads, connection.__enter__)
        try:
            yield AsyncClient(client, threads)
        finally:
            await loop.run_in_executor(None, connection.__exit__, None, None, None)
    finally:
        threads.shutdown(wait=False, cancel_futures=True)


class AsyncClient(CommandMethods):
    """A client whose methods are coroutines. It is owned by one event loop."""

    def __init__(self, client: Client, threads: ThreadPoolExecutor) -> None:
        self._client = client
        self._threads = threads

    async def send(self, command: Command[R], *, timeout_s: float = LONG_S) -> R:
        """Send any command and return its reply; see `Client.send`."""
        return await self._in_thread(lambda: self._client.send(command, timeout_s=timeout_s))

    async def request(self, make: Callable[[], Command[R]], read: Callable[[R], Any] | None = None) -> Any:
        """Make a command, send it, and return its reply, converted by `read`."""
        return await self._in_thread(lambda: self._client.request(make, read))

    async def backup(self, file: str | Path, *, overwrite: bool = False) -> Opening:
        """Write the map and its history to a local file; see `Client.backup`."""
        return await self._in_thread(lambda: self._client.backup(file, overwrite=overwrite))

    async def publish_pose(self, name: str, at: Sequence[float], **pose: Any) -> None:
        """Publish the current pose of a tracked entity, without waiting; see `Client.publish_pose`."""
        self._client.publish_pose(name, at, **pose)

    async def publish_robot(
        self, name: str, joints: Mapping[str, float], at: Sequence[float], **pose: Any
    ) -> None:
        """Publish the joints and the base of a robot, without waiting; see `Client.publish_robot`."""
        self._client.publish_robot(name, joints, at, **pose)

    async def publish_frame(
        self, name: str, parent: str, at: Sequence[float] = (0.0, 0.0, 0.0), **pose: Any
    ) -> None:
        """Publish the pose of a custom frame, without waiting; see `Client.publish_frame`."""
        self._client.publish_frame(name, parent, at, **pose)

    async def publish_camera(
        self, name: str, rgb: Any, depth_m: Any, intrinsics: Any, map_from_camera: Any,
        *, stamp_ns: int = 0,
    ) -> None:  # fmt: skip
        """Publish one frame of a depth camera, without waiting; see `Client.publish_camera`."""
        self._client.publish_camera(name, rgb, depth_m, intrinsics, map_from_camera, stamp_ns=stamp_ns)

    async def withdraw_frame(self, name: str) -> None:
        """Remove a published frame."""
        self._client.withdraw_frame(name)

    @contextlib.asynccontextmanager
    async def commits(self, *, timeout: float | None = None) -> AsyncIterator[AsyncIterator[Commit]]:
        """Iterate over new commits; see `Client.commits`."""
        async with self._enter_in_thread(self._client.commits()) as commits:
            yield _iterate_in_thread(commits, "no commit received", timeout)

    @contextlib.asynccontextmanager
    async def watch(
        self,
        query: str | None = None,
        *,
        inferred: bool = False,
        class_: str | None = None,
        on: str | None = None,
        in_: str | None = None,
        near: str | None = None,
        within: float | None = None,
    ) -> AsyncIterator[AsyncStandingQuery]:
        """Watch the rows of a SELECT query, or the entities at a location.

            async with client.watch(query) as standing:
                async for change in standing.changes(): ...

        `on`, `in_` and `near` have the meaning that they have in `list`; then each row is the IRI of an
        entity.
        """
        watching = self._client.watch(
            query, inferred=inferred, class_=class_, on=on, in_=in_, near=near, within=within
        )
        async with self._enter_in_thread(watching) as standing:
            yield AsyncStandingQuery(standing)

    @contextlib.asynccontextmanager
    async def _enter_in_thread(self, context: contextlib.AbstractContextManager[T]) -> AsyncIterator[T]:
        """Enter and exit a context manager on a thread, because both may wait for the system."""
        entered = await self._in_thread(context.__enter__)
        try:
            yield entered
        finally:
            await self._in_thread(functools.partial(context.__exit__, None, None, None))

    async def _in_thread(self, function: Callable[[], T]) -> T:
        return await asyncio.get_running_loop().run_in_executor(self._threads, function)


class AsyncStandingQuery:
    """The initial rows of a query, and their changes. It is returned by `AsyncClient.watch`."""

    def __init__(self, standing: StandingQuery) -> None:
        self._standing = standing
        self.variables = standing.variables
        self.rows = standing.rows
        self.seq = standing.seq
        self.notes = standing.notes

    def changes(self, *, timeout: float | None = None) -> AsyncIterator[RowsChanged]:
        """Iterate over the changes until the query is closed; see `StandingQuery.changes`."""
        return _iterate_in_thread(self._standing.changes(), "no rows changed", timeout)


async def _iterate_in_thread(items: Iterator[T], nothing: str, timeout_s: float | None) -> AsyncIterator[T]:
    """Iterate over `items` on a thread. `items` must end when their source is closed."""
    loop = asyncio.get_running_loop()
    received: asyncio.Queue[tuple[T] | Exception | None] = asyncio.Queue()

    def put(item: tuple[T] | Exception | None) -> None:
        with contextlib.suppress(RuntimeError):  # the loop has ended
            loop.call_soon_threadsafe(received.put_nowait, item)

    def iterate() -> None:
        try:
            for item in items:
                put((item,))
            put(None)
        except Exception as error:
            put(error)

    threading.Thread(target=iterate, name="semmap", daemon=True).start()
    while True:
        try:
            item = await asyncio.wait_for(received.get(), timeout_s)
        except TimeoutError:
            raise errors.NoAnswer(f"{nothing} within {timeout_s:g} s") from None
        if item is None:
            return
        if isinstance(item, Exception):
            raise item
        yield item[0]
