"""Orders to bodies that the map has yet to follow: replies that wait for the commit, and what undo stops.

An order (`move`, `open`, `close`, `drive`) is under way until its body rests and the map has followed.
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
"""So long a reply waits for a body to rest: what rolls or swings on is committed later."""
PAUSED = "time is paused: the map follows when it runs again (semmap pause --off)"
_DOING = {"move": "the move of", "open": "opening", "close": "closing", "drive": "the drive of"}


class Timed(Protocol):
    """A reply of the simulator."""

    @property
    def paused(self) -> bool: ...  # noqa: D102
    @property
    def stamp_ns(self) -> int: ...  # noqa: D102


@dataclass
class PendingOrder:
    """An order that the simulator has carried out, or is carrying out."""

    command: Order
    names: frozenset[str]
    """The body and what is carried with it."""
    run: str
    """Which simulator has the order."""
    before: int | None
    """The commit that the pose is from when the order came; None for what is not in the map."""
    immediate: Moved
    """The reply to those who do not wait."""
    tell: Callable[[Body], str]
    """The reply to those who wait, given the body at rest."""
    until_s: float
    reply: Future[Moved] | None = None
    """For those who wait."""
    after_ns: int | None = None
    """Earlier poses do not count; None while a course is driven, whose end the simulator reports."""
    commit: int | None = None

    @property
    def name(self) -> str:
        """The body that the order is about."""
        return self.command.name


class Completion:
    """Owned by the coordinator's thread, which calls `answer_waiting` whenever scene or map have changed."""

    def __init__(self, truth: Truth, dispatcher: CommandDispatcher, reconciler: Reconciler) -> None:
        """Nothing is under way."""
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
        """Reply to an order once the map has followed, or at once if nobody waits or time is paused.

        `done` is the simulator's reply, None while a course is driven: `arrive` follows then.
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
        """Note that a course has ended: `text` says how, and the reply waits for the commit."""
        if (order := self._find(command)) is None:
            return
        order.after_ns, order.until_s = done.stamp_ns, time.monotonic() + WAIT_S
        order.immediate, order.tell = Moved(name=order.name, text=text), lambda _: text
        self._paused = done.paused
        if done.paused:
            self._answer(order, _paused(order.immediate))

    def fail(self, command: Drive, error: errors.SemmapError, done: Timed | None = None) -> None:
        """Answer an order that the simulator did not carry out; with `done` the body may have moved."""
        if (order := self._find(command)) is None:
            return
        self._answer(order, error)
        if done is not None:
            order.after_ns, order.until_s = done.stamp_ns, time.monotonic() + WAIT_S
        else:
            self._end(order)

    def watch(self, change: Callable[[C], Future[Changed]]) -> Callable[[C], Future[Changed]]:
        """Return `change`, such that the commits by which the map follows a body are noticed."""

        def watched(wanted: C) -> Future[Changed]:
            made = change(wanted)
            if isinstance(wanted, ObservedState):
                orders = [order for order in self._pending if self._is_about(order, wanted)]
                made.add_done_callback(lambda done: self._on_change(orders, done))
            return made

        return watched

    def answer_waiting(self) -> None:
        """Answer those whose body rests and whose map has followed; forget what has ended."""
        for order in [*self._pending]:
            if (answer := self._judge(order)) is None:
                continue
            self._answer(order, answer)
            self._end(order)

    def pause(self) -> None:
        """Answer those who wait for what does not happen while time stands still."""
        self._paused = True
        for order in self._pending:
            if order.after_ns is not None:  # the simulator itself answers those who wait for a course
                self._answer(order, _paused(order.immediate))

    def resume(self) -> None:
        """Give all that is under way as long as ever from now on."""
        self._paused = False
        self._dispatcher.manual_moves.renew()
        for order in self._pending:
            order.until_s = time.monotonic() + WAIT_S

    def stop(self, command: Undo, halt: Callable[[str], Future[Pose]]) -> Future[Changed] | None:
        """Stop the newest order that has yet to be committed; None if an undo is about commits.

        `halt(name)` ends a robot's course. Bodies go back to where the map has them.
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
            text, returned = f"{what}: it goes back to where the map has it", self._reconciler.return_bodies
        else:
            text, returned = (
                f"{what}: its joints go back to where the map has them",
                self._reconciler.return_joints,
            )
        return then(returned(order.names), lambda _: self._note(command, order, text))

    def _note(self, command: Undo, order: PendingOrder, text: str) -> Changed:
        changed = Changed(commit=None, text=text, names=(order.name,))
        if command.id:
            self._stopped = command.id, changed
        return changed

    def _newest(self, command: Undo) -> PendingOrder | None:
        """The newest order that this undo may stop: what is being committed is undone by a commit."""
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
        """Is it this order that the map follows? Poses from before it are not its own."""
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
        """The answer to an order as things are; None as long as it has to be waited for."""
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
            moving = f"no commit yet: {name} is still moving; the map follows when it rests"
            held_up = f"no commit yet: {name} rests, and the map has still to follow"
            notes = () if order.commit is not None else (held_up if is_new and body.resting else moving,)
            return structs.replace(order.immediate, commit=order.commit, notes=notes)
        return None

    def _why_none(self, order: PendingOrder, entity: Entity | None) -> str:
        name = order.name
        if entity is None:
            return f"no commit: {name} is not in the map"
        if entity.tracked == "stream":
            return f"no commit: the map has {name} where its live poses are"
        if self._truth == "perceived" and entity.tracked != "sim":
            return "no commit: the map is updated by perception only"
        if (since := _posed_by(entity)) != order.before:
            return f"no commit: commit {since} has changed the position of {name} since"
        return f"no commit: {name} rests where the map has it"

    def _answer(self, order: PendingOrder, answer: Answer) -> None:
        reply, order.reply = order.reply, None
        if reply is None:
            return
        if isinstance(answer, errors.SemmapError):
            reply.set_exception(answer)
        else:
            reply.set_result(answer)

    def _end(self, order: PendingOrder) -> None:
        """What rests is no longer in the hand; what moves on still is, and so are reasons for its commit."""
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
