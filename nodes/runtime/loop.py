"""The event loop of every node: one thread that owns the node's state, and the queues that feed it.

Callbacks on Zenoh's threads only queue. Requests go to a bounded queue that is fair between clients; if it is
full, the reply is Busy. All other events follow from requests or are bounded by themselves, and come first.

An exception in a handler is caught here and nowhere else: it is logged, sent as the reply, shown in the
heartbeat, and the node keeps running.
"""

from __future__ import annotations

import heapq
import logging
import math
import queue
import signal
import threading
import time
from collections import deque
from collections.abc import Callable, Container, Iterator, Mapping
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from functools import partial
from itertools import count
from typing import Any, TypeVar

from semmap.nodes import bus
from semmap.nodes.runtime.fair_queue import FairQueue
from semmap.nodes.runtime.heartbeat import Heartbeat
from semmap.nodes.runtime.requests_in_work import RequestsInWork, is_counted
from semmap.schemas import errors, keys
from semmap.schemas.calls import Call, Handler, Relay, largest, reply_type

log = logging.getLogger(__name__)

_RETRY_S = 0.05
_MAX_WAITING = 20_000
"""Largest number of waiting publications of a topic; then the oldest are dropped."""

R = TypeVar("R")

HasGone = Callable[[], bool]
"""Returns whether all clients that wait for a reply have gone."""


def never() -> bool:
    """Return that a client has not gone, or is not known."""
    return False


Handlers = Mapping[str, tuple[Any, Callable[[Any], Any]]]
"""Maps a verb to the type of its message and a function, which may return a Future or a Relay.

They are made by `calls.by_verb(Get.answered_by(function), ...)`, so that mypy checks the types of the
functions.
"""

_Work = Callable[[], None]

Admit = Callable[[str, Any], Any]
"""Returns the message to handle, given the client ("" if the key does not name it) and the message."""


class Node:
    """A running node: register handlers, then call `run`. Created by `open_node`."""

    def __init__(self, name: str, session: bus.Session, commands: str = keys.CMD) -> None:
        """`commands` is the prefix of the commands that it sends."""
        self.name = name
        self.session = session
        self._commands = commands
        self._events: queue.SimpleQueue[_Work] = queue.SimpleQueue()
        self._requests: FairQueue[_Work] = FairQueue()
        self._has_room: Callable[[], bool] = lambda: True
        self._current: bus.Request | None = None
        self._in_work = RequestsInWork.of(name)
        self._has_failed = False
        self._departures: bus.DepartureMonitor | None = None
        self._is_immediate = False
        """An immediate request is among the events."""
        self._timers: list[tuple[float, int, Callable[[], None]]] = []
        self._timer_numbers = count()
        self._idle: list[Callable[[], None]] = []
        self._afterwards: list[Callable[[], None]] = []
        self._stopping = False
        self._heartbeat = Heartbeat(name, session)
        self._liveliness = bus.LivelinessMonitor(session)

    @property
    def asker(self) -> str:
        """The client of the request that is being handled, as far as it can be identified."""
        return "" if self._current is None else self._current.asker

    def monitor_departures(self) -> None:
        """Do not forward a request again if its client has gone; call this before `serve`."""
        self._departures = bus.DepartureMonitor(self.session)

    def has_gone(self) -> HasGone:
        """Return a function that returns whether the client of the current request has gone.

        A client that sent a put does not wait, so it never counts as gone.
        """
        return never if self._current is None else self._departure_of(self._current)

    def _departure_of(self, request: bus.Request) -> HasGone:
        client, departures = request.waits, self._departures
        if not client or departures is None:
            return never
        return lambda: departures.has_gone(client)

    def serve(
        self,
        prefix: str,
        handlers: Handlers,
        *,
        puts: bool = False,
        leave: Callable[[str], bool] = lambda verb: False,
        admit: Admit = lambda who, message: message,
        urgent: Container[str] = (),
    ) -> None:
        """Serve queries on `prefix/<verb>` and, with `puts`, execute puts too.

        A query with `leave(verb)` is left to another node; `leave` is called on a thread of Zenoh.
        `admit(who, message)` returns the message to handle, or raises. The `urgent` verbs must be quick, and
        come before all others.
        """

        def receive(request: bus.Request) -> None:
            self._queue(
                request, lambda: self._handle(request, handlers, admit), urgent=request.verb in urgent
            )

        def receive_query(request: bus.Request) -> None:
            if not leave(request.verb):
                receive(request)

        bus.serve(
            self.session,
            prefix,
            receive_query,
            most=lambda verb: largest(handlers[verb][0]) if verb in handlers else 0,
        )
        if puts:
            bus.serve_puts(self.session, prefix, receive)

    def serve_one(self, prefix: str, handler: Handler) -> None:
        """Serve queries on `prefix/<verb>` of a single verb; another node serves the rest of the prefix.

        `prefix` may be a pattern for all clients: `semmap/as/*/cmd`.
        """
        verb = handler.kind.VERB

        def receive(request: bus.Request) -> None:
            if request.verb == verb:  # not a query to all verbs
                self._queue(request, lambda: self._handle(request, {verb: handler}))

        bus.serve(self.session, prefix, receive, verb=verb, most=lambda _: largest(handler.kind))

    def while_there_is_room(self, has_room: Callable[[], bool]) -> None:
        """Hold requests back while `has_room()` is false, except urgent ones; events continue."""
        self._has_room = has_room

    def _queue(self, request: bus.Request, handle: _Work, *, urgent: bool = False) -> None:
        """Queue a request, or reply Busy; on a thread of Zenoh. If none waits, it becomes an event."""
        if not self._is_immediate and not len(self._requests) and self._has_room():
            self._is_immediate = True
            self._events.put(partial(self._handle_immediate, handle))
            return
        size = min(len(request.payload), bus.FRAGMENT_BYTES)  # fragmented requests have their own limit
        again_s = self._requests.put(request.asker, handle, size=size, urgent=urgent)
        if again_s is None:
            self._events.put(_wake)
        else:
            request.refuse(
                errors.Busy(
                    f"{self.name} is busy: {len(self._requests):,} requests are waiting;"
                    f" try again in {again_s:.1f} s",
                    again_s=again_s,
                )
            )

    def follow(self, topic: keys.Topic, handle: Callable[[Any], None]) -> None:
        """Call `handle(message)` for each publication, unless too many wait and the oldest are dropped."""
        self._follow(topic, handle, _MAX_WAITING)

    def follow_newest(self, topic: keys.Topic, handle: Callable[[Any], None]) -> None:
        """Call `handle(message)` for publications; a busy node gets only the newest of the waiting ones."""
        self._follow(topic, handle, 1)

    def _follow(self, topic: keys.Topic, handle: Callable[[Any], None], most: int) -> None:
        waiting: deque[Any] = deque(maxlen=most)
        lock = threading.Lock()

        def take() -> None:
            with lock:
                message = waiting.popleft()
            handle(message)

        def keep(key: str, message: Any) -> None:
            if topic == keys.HEALTH and key != keys.health_key(message.node):
                self._heartbeat.ignore()  # forged: a heartbeat under the key of another node
                return
            with lock:
                is_full = len(waiting) == most
                waiting.append(message)
            if not is_full:  # otherwise the event of the dropped message handles this one
                self._events.put(take)

        bus.follow(self.session, topic, keep, self._heartbeat.ignore)

    def every(self, period_s: float, handle: Callable[[], None]) -> Callable[[float], None]:
        """Call `handle()` every `period_s`, as far as the load allows.

        The returned function changes the period from now on.
        """
        due_s, number = time.monotonic(), 0

        def plan() -> None:
            nonlocal number
            number += 1
            self._at(due_s, partial(repeat, number))

        def repeat(planned: int) -> None:
            nonlocal due_s
            if planned != number:  # the period has been changed since
                return
            due_s = max(due_s + period_s, time.monotonic())
            plan()
            handle()

        def change(other_s: float) -> None:
            nonlocal due_s, period_s
            if other_s != period_s:
                due_s, period_s = time.monotonic() + other_s, other_s
                plan()

        plan()
        return change

    def later(self, delay_s: float, handle: Callable[[], None]) -> None:
        """Call `handle()` once after a delay, as far as the load allows."""
        self._at(time.monotonic() + delay_s, handle)

    def _at(self, due_s: float, handle: Callable[[], None]) -> None:
        heapq.heappush(self._timers, (due_s, next(self._timer_numbers), handle))

    def when_idle(self, handle: Callable[[], None]) -> None:
        """Call `handle()` whenever no event waits, to do deferred work."""
        self._idle.append(handle)

    def ask(
        self,
        prefix: str,
        call: Call[R],
        *,
        timeout_s: float,
        patience_s: float = bus.PATIENCE_S,
        beating: bool = False,
    ) -> R:
        """Call `bus.ask` on this node's session; heartbeats pause, or continue (slower) if `beating`."""
        on_wait = self.beat if beating else None
        answer: R = bus.ask(
            self.session,
            self._prefix(prefix),
            call.VERB,
            call,
            reply_type(type(call)),
            timeout_s=timeout_s,
            patience_s=patience_s,
            on_wait=on_wait,
            liveliness=self._liveliness,
        )
        return answer

    def ask_later(
        self,
        prefix: str,
        call: Call[R],
        *,
        timeout_s: float = bus.TIMEOUT_S,
        patience_s: float = 0.0,
        has_gone: HasGone = never,
    ) -> Future[R]:
        """Like `ask`, without waiting; the future is resolved on this node's own thread.

        The query is repeated while no node serves the key, for up to `patience_s`, unless the client
        `has_gone`.
        """
        return self._ask_later(
            prefix, call, timeout_s=timeout_s, patience_s=patience_s, decoded=True, has_gone=has_gone
        )

    def _ask_later(
        self,
        prefix: str,
        call: Call[Any],
        *,
        timeout_s: float,
        patience_s: float,
        decoded: bool,
        has_gone: HasGone = never,
        asked_by: bus.Request | None = None,
    ) -> Future[Any]:
        """Send a query; the result is the message or, unless `decoded`, its encoded form.

        With `asked_by`, the query is forwarded in the name of that client, which itself repeats it if a node
        is busy.
        """
        future: Future[Any] = Future()
        patience: list[bus.BusyBackoff] = []
        deadline_s = time.monotonic() + patience_s
        round_s = bus.first_round_s(call, timeout_s)

        def send(ask_all: bool = False) -> None:
            try:
                bus.ask_later(
                    self.session,
                    self._prefix(prefix),
                    call.VERB,
                    call,
                    reply_type(type(call)),
                    answer,
                    timeout_s=round_s,
                    liveliness=self._liveliness,
                    ask_all=ask_all,
                    source=None if asked_by is None else asked_by.source,
                )
            except Exception as error:  # otherwise the future would never be resolved
                future.set_exception(error)

        def answer(read: Callable[[], bus.Encoded]) -> None:
            self._events.put(lambda: take(read))

        def take(read: Callable[[], bus.Encoded]) -> None:
            nonlocal round_s
            try:
                reply = read()
                future.set_result(reply.decode() if decoded else reply)
            except bus.ForeignReply as error:
                if time.monotonic() > deadline_s + bus.PATIENCE_S:
                    future.set_exception(error)
                    return
                self.report(error.text)
                self._at(time.monotonic() + _RETRY_S, partial(send, ask_all=True))
            except errors.Busy as error:
                if asked_by is not None:
                    future.set_exception(error)
                    return
                if not patience:
                    patience.append(bus.BusyBackoff())
                try:
                    self._at(time.monotonic() + patience[0].pause_s(error), send)
                except errors.Busy:
                    future.set_exception(error)
            except bus.TimedOut as error:
                if round_s == timeout_s:
                    future.set_exception(error)
                else:
                    round_s = timeout_s
                    send()
            except errors.NoAnswer as error:
                if (now_s := time.monotonic()) < deadline_s and not has_gone():
                    self._at(now_s + _RETRY_S, send)
                else:
                    future.set_exception(error)
            except Exception as error:
                future.set_exception(error)

        send()
        return future

    def _prefix(self, prefix: str) -> str:
        return self._commands if prefix == keys.CMD else prefix

    def is_there(self, node: str) -> bool:
        """Return whether a process of another node is ready. Any thread may call this."""
        return self._liveliness.is_there(node)

    def afterwards(self, handle: Callable[[], None]) -> None:
        """Call `handle()` after the current handler has replied, and before any other event."""
        self._afterwards.append(handle)

    def soon(self, handle: Callable[[], None]) -> None:
        """Call `handle()` on this node's own thread; used by other threads to deliver their results."""
        self._events.put(handle)

    def beat(self) -> None:
        """Send the heartbeat if it is due. Long work calls this between its steps."""
        self._heartbeat.beat()

    def ready(self, detail: str) -> None:
        """Mark the node as ready by its liveliness token and the next heartbeat."""
        self._heartbeat.ready(detail)

    def describe(self, detail: str | Callable[[], str]) -> None:
        """Set the detail of the heartbeats, from the next one on; a function is called for each."""
        self._heartbeat.describe(detail)

    def head(self, head: Callable[[], tuple[int, str]]) -> None:
        """Add the number and digest of the last commit to the heartbeats."""
        self._heartbeat.head(head)

    def note_shapes(self) -> None:
        """Let subscribers fetch the map again, because relations have changed without a commit."""
        self._heartbeat.note_shapes()

    def note(self, notes: tuple[str, ...]) -> None:
        """Set the notes of the node in the heartbeats, from now on."""
        self._heartbeat.note(notes)

    def drop(self, text: str) -> None:
        """Count a publication as ignored, and show once in the heartbeats why."""
        self._heartbeat.drop(text)

    def report(self, text: str) -> None:
        """Log an error and show it in the heartbeats with the time of day, for an hour."""
        self._heartbeat.report(text)

    def stop(self) -> None:
        """End `run` after the current event."""
        self._events.put(self._stop)

    def stop_failed(self) -> None:
        """End `run` after the current event, and count the current request as one that ends the node."""
        self._has_failed = True
        self.stop()

    def tick(self) -> None:
        """Run due timers and the heartbeat. Work that takes seconds calls this regularly."""
        now = time.monotonic()
        while self._timers and self._timers[0][0] <= now:
            self._guard(heapq.heappop(self._timers)[-1])
        self._heartbeat.beat()

    def run(self) -> None:
        """Handle events until stopped, and one request between every two events."""
        while not self._stopping:
            self._step()

    def wait(self, pause_s: float) -> bool:
        """Handle events for `pause_s`, and return whether the node is to go on; for waits before `ready`."""
        until_s = time.monotonic() + pause_s
        self.later(pause_s, _wake)
        while not self._stopping and time.monotonic() < until_s:
            self._step()
        return not self._stopping

    def _step(self) -> None:
        self.tick()
        if self._take_request():
            if not self._events.empty():
                self._guard(self._events.get())
            return
        if self._events.empty():
            for handle in self._idle:
                self._guard(handle)
            if len(self._requests) and not self._is_immediate and self._has_room():
                return
        due_s = min(self._heartbeat.due_s, self._timers[0][0] if self._timers else math.inf)
        wait_s = max(0.0, due_s - time.monotonic())
        with suppress(queue.Empty):
            self._guard(self._events.get(timeout=wait_s))

    def _handle_immediate(self, handle: _Work) -> None:
        self._is_immediate = False
        handle()

    def _take_request(self) -> bool:
        """Handle the next request, if there is one and room for it. Returns whether there was one."""
        if self._is_immediate or self._requests.is_empty:  # the immediate request came first
            return False
        handle = self._requests.take(urgent_only=not self._has_room())
        if handle is not None:
            self._guard(handle)
        return handle is not None

    def _stop(self) -> None:
        self._stopping = True

    def _guard(self, handle: Callable[[], None]) -> None:
        try:
            handle()
        except errors.SemmapError as error:
            self.report(error.text)
        except Exception as error:
            log.exception("internal error in %s", self.name)
            self.report(f"{type(error).__name__}: {error}")
        while self._afterwards:
            self._guard(self._afterwards.pop(0))

    def _handle(
        self, request: bus.Request, handlers: Handlers, admit: Admit = lambda who, message: message
    ) -> None:
        self._current = request
        try:
            result = self._execute(request, handlers, admit)
        except Exception as error:
            self._refuse(request, error)
            return
        finally:
            self._current = None
        if isinstance(result, Future):
            result.add_done_callback(lambda future: self._answer_later(request, future))
        else:
            self._answer(request, result)

    def _execute(self, request: bus.Request, handlers: Handlers, admit: Admit) -> Any:
        """Return the result of a request's handler. Raises its error."""
        if request.verb not in handlers:
            raise errors.UnknownVerb(
                f"unknown command '{request.verb}'; available: {', '.join(sorted(handlers))}"
            )
        kind, function = handlers[request.verb]
        if is_counted(kind):
            self._in_work.begin(request.asker, request.verb, request.payload)
        try:
            return function(admit(request.who, request.read(kind)))
        finally:
            if not self._has_failed:
                self._in_work.end()

    def _answer(self, request: bus.Request, result: Any) -> None:
        if isinstance(result, Relay):
            self._relay(request, result)
        else:
            request.reply(result)

    def _relay(self, request: bus.Request, relay: Relay[Any]) -> None:
        """Forward a request and its reply without decoding, also to a node that is being restarted."""
        future = self._ask_later(
            relay.prefix,
            relay.call,
            timeout_s=relay.timeout_s,
            patience_s=bus.RESTART_S,
            decoded=not request.plain,
            has_gone=self._departure_of(request),
            asked_by=request,
        )
        future.add_done_callback(lambda done: self._answer_later(request, done))

    def _answer_later(self, request: bus.Request, future: Future[Any]) -> None:
        error = future.exception()
        if error is None:
            self._answer(request, future.result())
        else:
            self._refuse(request, error)

    def _refuse(self, request: bus.Request, error: BaseException) -> None:
        if not isinstance(error, errors.SemmapError):
            log.error("internal error in %s", request.verb, exc_info=error)
            self.report(f"{request.verb}: {type(error).__name__}: {error}")
            error = errors.InternalError(
                f"internal error in {self.name}, which keeps running: {type(error).__name__}: {error}"
            )
        request.refuse(error)


def _wake() -> None:
    """An event that only wakes the loop."""


@contextmanager
def open_node(name: str, network: bus.Network) -> Iterator[Node]:
    """Open a node's session; the node stops on SIGTERM and SIGINT."""
    bus.set_reader_threads()
    with bus.open_session(network) as session:
        node = Node(name, session, network.commands)
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, lambda *_: node.stop())
        yield node
