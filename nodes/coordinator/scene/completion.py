"""Orders to bodies whose result is not committed yet: waiting replies, and orders that undo can stop.

An order (`move`, `open`, `close`, `drive`) is pending until its body rests and the map has followed.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Collection
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Protocol, TypeVar

from msgspec import structs

from semmap.nodes.coordinator.commands.dispatcher import CommandDispatcher
from semmap.nodes.coordinator.config import Truth
from semmap.nodes.coordinator.reconciler.observed_state import ObservedState
from semmap.nodes.coordinator.reconciler.reconciler import Reconciler
from semmap.nodes.runtime.futures import SingleThreadFuture, then
from semmap.schemas import errors
from semmap.schemas.commands import Close, Drive, Move, Open, Undo
from semmap.schemas.entities import LESSER, Entity, Pose
from semmap.schemas.replies import Changed, Moved
from semmap.schemas.scenes import Body

C = TypeVar("C")
Order = Move | Open | Close | Drive
Answer = Moved | errors.SemmapError

WAIT_S = 30.0
"""Longest wait of a reply for a body to rest; a body that rolls on is committed later."""
PAUSED = "time is paused: the map is updated when it runs again (semmap pause --off)"
_DOING = {"move": "the move of", "open": "opening", "close": "closing", "drive": "the drive of"}


class Timed(Protocol):
    """A reply of the simulator."""

    @property
    def paused(self) -> bool: ...  # noqa: D102
    @property
    def stamp_ns(self) -> int: ...  # noqa: D102


@dataclass
class PendingOrder:
    """An order that the simulator has executed or is executing."""

    command: Order
    names: frozenset[str]
    """The body and its carried contents."""
    run: str
    """The id of the simulator's process that has the order."""
    before: int | None
    """The commit of the pose before the order; None for a body that is not in the map."""
    immediate: Moved
    """The immediate reply."""
    tell: Callable[[Body], str]
    """Returns the text of the final reply from the body at rest."""
    until_s: float
    reply: Future[Moved] | None = None
    """The waiting reply, if any."""
    after_ns: int | None = None
    """Earlier poses are ignored. None during a drive, whose end the simulator reports."""
    commit: int | None = None

    @property
    def name(self) -> str:
        """The body of the order."""
        return self.command.name


class Completion:
    """Owned by the coordinator's thread, which calls `answer_waiting` when scene or map have changed."""

    def __init__(self, truth: Truth, dispatcher: CommandDispatcher, reconciler: Reconciler) -> None:
        """Start without pending orders."""
        self._truth = truth
        self._dispatcher = dispatcher
        self._reconciler = reconciler
        self._pending: list[PendingOrder] = []
        self._paused = False
        self._stopped: tuple[str, Changed] | None = None

    def begin(
        self,
        command: Order,
        immediate: Moved,
        tell: Callable[[Body], str],
        done: Timed | None,
        load: Collection[str] = (),
    ) -> Moved | Future[Moved]:
        """Reply to an order when the map has followed, or immediately if time is paused or no wait is wanted.

        `done` is the simulator's reply. It is None during a drive, for which `arrive` is called later.
        """
        order = self._register(command, immediate, tell, load)
        if done is not None:
            order.after_ns, self._paused = done.stamp_ns, done.paused
        if not command.wait:
            return immediate
        if done is not None and done.paused:
            return _paused(immediate)
        order.reply = SingleThreadFuture()
        return order.reply

    def arrive(self, command: Drive, text: str, done: Timed) -> None:
        """Note that a drive has ended; the reply waits for the commit and has the text `text`."""
        if (order := self._find(command)) is None:
            return
        order.after_ns, order.until_s = done.stamp_ns, time.monotonic() + WAIT_S
        order.immediate, order.tell = Moved(name=order.name, text=text), lambda _: text
        self._paused = done.paused
        if done.paused:
            self._answer(order, _paused(order.immediate))

    def fail(self, command: Drive, error: errors.SemmapError, done: Timed | None = None) -> None:
        """Fail an order that the simulator did not execute; with `done`, the body may have moved."""
        if (order := self._find(command)) is None:
            return
        self._answer(order, error)
        if done is not None:
            order.after_ns, order.until_s = done.stamp_ns, time.monotonic() + WAIT_S
        else:
            self._end(order)

    def watch(self, change: Callable[[C], Future[Changed]]) -> Callable[[C], Future[Changed]]:
        """Wrap `change` to notice the commits by which the map follows a body."""

        def watched(wanted: C) -> Future[Changed]:
            made = change(wanted)
            if isinstance(wanted, ObservedState):
                orders = [order for order in self._pending if self._is_about(order, wanted)]
                made.add_done_callback(lambda done: self._on_change(orders, done))
            return made

        return watched

    def answer_waiting(self) -> None:
        """Reply to the orders whose body rests and whose map has followed, and remove ended orders."""
        for order in [*self._pending]:
            if (answer := self._judge(order)) is None:
                continue
            self._answer(order, answer)
            self._end(order)

    def pause(self) -> None:
        """Reply to orders that cannot complete while time is paused."""
        self._paused = True
        for order in self._pending:
            if order.after_ns is not None:  # the simulator itself replies to drives
                self._answer(order, _paused(order.immediate))

    def resume(self) -> None:
        """Renew the deadlines of all orders when time runs again."""
        self._paused = False
        self._dispatcher.manual_moves.renew()
        for order in self._pending:
            order.until_s = time.monotonic() + WAIT_S

    def stop(self, command: Undo, halt: Callable[[str], Future[Pose]]) -> Future[Changed] | None:
        """Stop the newest order that is not committed yet; None if the undo is about commits.

        `halt(name)` stops a drive. Other bodies return to their committed state.
        """
        if command.id and self._stopped is not None and self._stopped[0] == command.id:
            again: Future[Changed] = SingleThreadFuture()
            again.set_result(self._stopped[1])
            return again
        if command.commit is not None or command.dry_run or (order := self._newest(command)) is None:
            return None
        what = f"stopped {_DOING[order.command.VERB]} {order.name}"
        if isinstance(order.command, Drive):
            return then(halt(order.name), lambda pose: self._note(command, order, f"{what} at {_at(pose)}"))
        self._answer(order, errors.Refused(f"{what}: an undo came before it was committed"))
        self._end(order)
        self._dispatcher.manual_moves.forget(order.names)
        if isinstance(order.command, Move):
            text, returned = f"{what}: it returns to its committed pose", self._reconciler.return_bodies
        else:
            text, returned = (
                f"{what}: its joints return to their committed positions",
                self._reconciler.return_joints,
            )
        return then(returned(order.names), lambda _: self._note(command, order, text))

    def _note(self, command: Undo, order: PendingOrder, text: str) -> Changed:
        changed = Changed(commit=None, text=text, names=(order.name,))
        if command.id:
            self._stopped = command.id, changed
        return changed

    def _newest(self, command: Undo) -> PendingOrder | None:
        """Return the newest order that this undo may stop; one that is being committed is not among them."""
        for order in reversed(self._pending):
            is_lesser = command.source in LESSER and order.command.source not in LESSER
            is_known = order.commit is not None or self._reconciler.is_following(order.names)
            if not (is_lesser or is_known or self._is_over(order)):
                return order
        return None

    def _is_over(self, order: PendingOrder) -> bool:
        return order.after_ns is not None and self._judge(order) is not None

    def _register(
        self, command: Order, immediate: Moved, tell: Callable[[Body], str], load: Collection[str]
    ) -> PendingOrder:
        names = frozenset((command.name, *load))
        for order in [*self._pending]:
            order.names -= names
            if order.name in names:
                text = f"{order.name} was moved again before the map had followed"
                self._answer(order, Moved(name=order.name, text=text, commit=order.commit))
                self._pending.remove(order)
        entity = self._dispatcher.map.entities.get(command.name)
        made = PendingOrder(
            command=command,
            names=names,
            run=self._reconciler.scene.run,
            before=None if entity is None else _posed_by(entity),
            immediate=immediate,
            tell=tell,
            until_s=time.monotonic() + WAIT_S,
        )
        self._pending.append(made)
        return made

    def _find(self, command: Order) -> PendingOrder | None:
        return next((order for order in self._pending if order.command is command), None)

    def _is_about(self, order: PendingOrder, observed: ObservedState) -> bool:
        """Return whether an observed change is the result of this order; older poses are not."""
        is_newer = order.after_ns is not None and self._reconciler.scene.stamp_ns >= order.after_ns
        return is_newer and not order.names.isdisjoint(observed.names)

    def _on_change(self, orders: Collection[PendingOrder], done: Future[Changed]) -> None:
        error = done.exception()
        for order in orders:
            if error is None:
                order.commit = done.result().commit or order.commit
            elif isinstance(error, errors.Refused):
                text = f"{order.name} was put back, because the map rejected its new state: {error}"
                self._answer(order, type(error)(text, explanation=error.explanation))

    def _judge(self, order: PendingOrder) -> Answer | None:
        """Return the reply to an order in the current state; None while it has to wait."""
        if order.after_ns is None:
            return None
        scene, name = self._reconciler.scene, order.name
        body, entity = scene.bodies.get(name), self._dispatcher.map.entities.get(name)
        if order.before is not None and entity is None:
            return errors.Refused(f"{name} was removed before it came to rest")
        if not scene.known or scene.run != order.run:
            return errors.NoAnswer(f"the simulator ended before {name} came to rest; see: semmap get {name}")
        if body is None:
            return errors.Refused(f"{name} lost its body before it came to rest")
        is_late = time.monotonic() > order.until_s and not self._paused
        is_new = scene.stamp_ns >= order.after_ns
        if is_new and body.resting and self._reconciler.is_followed(name):
            notes = () if order.commit is not None else (self._why_none(order, entity),)
            return Moved(name=name, text=order.tell(body), commit=order.commit, notes=notes)
        if is_late:
            moving = f"no commit yet: {name} is still moving; the map is updated when it rests"
            held_up = f"no commit yet: {name} rests, but the map is not updated yet"
            notes = () if order.commit is not None else (held_up if is_new and body.resting else moving,)
            return structs.replace(order.immediate, commit=order.commit, notes=notes)
        return None

    def _why_none(self, order: PendingOrder, entity: Entity | None) -> str:
        name = order.name
        if entity is None:
            return f"no commit: {name} is not in the map"
        if entity.tracked == "stream":
            return f"no commit: the pose of {name} in the map comes from its live poses"
        if self._truth == "perceived" and entity.tracked != "sim":
            return "no commit: the map is updated by perception only"
        if (since := _posed_by(entity)) != order.before:
            return f"no commit: commit {since} has changed the position of {name} since"
        return f"no commit: {name} rests at its committed pose"

    def _answer(self, order: PendingOrder, answer: Answer) -> None:
        reply, order.reply = order.reply, None
        if reply is None:
            return
        if isinstance(answer, errors.SemmapError):
            reply.set_exception(answer)
        else:
            reply.set_result(answer)

    def _end(self, order: PendingOrder) -> None:
        """Remove an order. A body that still moves keeps its attribution for the later commit."""
        if order in self._pending:
            self._pending.remove(order)
        body = self._reconciler.scene.bodies.get(order.name)
        if body is None or body.resting or order.run != self._reconciler.scene.run:
            self._dispatcher.manual_moves.forget(order.names)


def _paused(immediate: Moved) -> Moved:
    return structs.replace(immediate, notes=(*immediate.notes, PAUSED))


def _posed_by(entity: Entity) -> int:
    return entity.pose_provenance.commit if entity.pose is not None else -1


def _at(pose: Pose) -> str:
    x, y, _ = pose.position_m
    return f"({x:.2f}, {y:.2f})"
