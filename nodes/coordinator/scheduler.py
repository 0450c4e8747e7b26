"""The scheduler of commands keeps the order of dependent commands and groups independent changes.

Changes of different entities are independent. Those that wait are sent to the knowledge base as one group,
and the next group is sent while one is under way.

All other commands wait until the commands before them are done, and the commands after a change wait for it.
This includes entities without a name or a position, because both depend on the other entities, and entities
that are given by a label or a class, because they may be those of other changes.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from itertools import islice
from typing import Any, NamedTuple

from semmap.nodes.coordinator.reconciler.observed_state import ObservedState
from semmap.nodes.runtime.futures import SingleThreadFuture, settle
from semmap.nodes.runtime.loop import HasGone, never
from semmap.schemas.commands import Add, Command, Set, Track, Unset, Update
from semmap.schemas.replies import Changed

MAX_GROUP_SIZE = 16
"""Largest number of changes in a group: two groups are as many as a busy client has in flight."""
MAX_GROUPS = 2
"""Largest number of groups under way: the knowledge base works on one while the other waits there."""

Change = Command[Changed] | ObservedState
"""A command with a handler in `commands/`, or the state of bodies."""
Results = list[Changed | Exception]


class _Waiting(NamedTuple):
    """A change, or another command, in the queue."""

    change: Change | None
    execute: Callable[[], Any]
    future: Future[Any]
    has_gone: HasGone


Group = frozenset[str | None]
"""The entities that a group of changes is about; None for a change that is sent alone."""


class Scheduler:
    """Owned by the coordinator's thread, which calls `run_ready` when it has nothing else to do."""

    def __init__(
        self,
        together: Callable[[Sequence[Change], HasGone], Future[Results]],
        client: Callable[[], HasGone] = lambda: never,
        is_name: Callable[[str], bool] = lambda _: True,
    ) -> None:
        """`together(changes, has_gone)` executes a group of changes, or one that is sent alone.

        `has_gone()` returns whether all their clients have gone. `client()` returns that function for the
        client of the change that is being scheduled. `is_name(word)` returns whether an entity has this name.
        """
        self._together = together
        self._client = client
        self._is_name = is_name
        self._waiting: deque[_Waiting] = deque()
        self._under_way: list[Group] = []

    def __len__(self) -> int:
        """Return the number of waiting commands."""
        return len(self._waiting)

    def change(self, change: Change) -> Future[Changed]:
        """Schedule a change and return its future result."""
        future: Future[Changed] = SingleThreadFuture()
        self._waiting.append(_Waiting(change, lambda: None, future, self._client()))
        if len(self._waiting) >= MAX_GROUP_SIZE:
            self.run_ready()
        return future

    def run_after(self, execute: Callable[[], Any]) -> Any:
        """Return the result of `execute()`, or a future of it if earlier commands are not done."""
        if not self._waiting and not self._under_way:
            return execute()
        future: Future[Any] = SingleThreadFuture()
        self._waiting.append(_Waiting(None, execute, future, never))
        return future

    def run_ready(self) -> None:
        """Begin all commands that can begin."""
        while self._waiting:
            if self._waiting[0].change is not None:
                members = self._next_group()
                if not members:
                    return
                self._begin([self._waiting.popleft() for _ in members])
            elif self._under_way:
                return
            else:
                waiting = self._waiting.popleft()
                settle(waiting.future, waiting.execute)

    def _next_group(self) -> list[Change]:
        """Return the changes at the front that depend neither on one another nor on a group under way.

        None of them begin beside a larger group, because more changes will have arrived when that is done.
        """
        if not self._under_way and len(self._waiting) == 1:  # the usual case
            return [waiting.change for waiting in self._waiting if waiting.change is not None]
        if len(self._under_way) == MAX_GROUPS or any(None in group for group in self._under_way):
            return []
        names = {name for group in self._under_way for name in group}
        members: list[Change] = []
        for waiting in islice(self._waiting, MAX_GROUP_SIZE):
            change = waiting.change
            name = None if change is None else self._entity(change)
            if change is not None and name is None and not members and not self._under_way:
                return [change]
            if change is None or name is None or name in names:
                break
            names.add(name)
            members.append(change)
        return members if all(len(members) >= len(group) for group in self._under_way) else []

    def _begin(self, members: Sequence[_Waiting]) -> None:
        changes = [member.change for member in members if member.change is not None]
        group = frozenset(map(self._entity, changes))
        self._under_way.append(group)

        def on_done(done: Future[Results]) -> None:
            self._under_way.remove(group)
            for i, member in enumerate(members):
                settle(member.future, lambda i=i: _result(done.result()[i]))  # type: ignore[misc]

        try:
            results = self._together(changes, lambda: all(member.has_gone() for member in members))
        except Exception as error:  # any error goes to those who wait
            results = SingleThreadFuture()
            results.set_exception(error)
        results.add_done_callback(on_done)

    def _entity(self, change: Change) -> str | None:
        """Return the entity that a change is about; None if it depends on others or is sent alone."""
        if isinstance(change, ObservedState):
            return change.names[0] if len(change.names) == 1 else None
        if isinstance(change, Add):
            return change.name if change.at is not None and not change.dry_run else None
        if isinstance(change, Update) and not (change.on is change.in_ is change.next_to is None):
            return None
        if isinstance(change, (Update, Set, Unset, Track)) and not change.dry_run:
            return change.name if self._is_name(change.name) else None
        return None


def _result(result: Changed | Exception) -> Changed:
    if isinstance(result, Exception):
        raise result
    return result
