"""The coordinator on the wire: `semmap/cmd/<verb>` in, transactions and orders out."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from typing import Any, TypeVar

from msgspec import structs

from semmap.nodes.coordinator import admission, authority
from semmap.nodes.coordinator.approvals import Approvals
from semmap.nodes.coordinator.config import CoordinatorConfig
from semmap.nodes.coordinator.current_answers import Answers
from semmap.nodes.coordinator.dialogues import hold_later
from semmap.nodes.coordinator.door import Door
from semmap.nodes.coordinator.early_commands import EarlyCommands
from semmap.nodes.coordinator.frames.feed import Frames
from semmap.nodes.coordinator.health_view import HealthView
from semmap.nodes.coordinator.kb_client import Bridge
from semmap.nodes.coordinator.live.feed import LiveFeed
from semmap.nodes.coordinator.scene.among_walls import AmongWalls
from semmap.nodes.coordinator.scene.completion import Completion
from semmap.nodes.coordinator.scene.gripping import Gripping
from semmap.nodes.coordinator.scene.opening import Opening
from semmap.nodes.coordinator.scene.reconciler import Keeping
from semmap.nodes.coordinator.scene.scene_commands import Running
from semmap.nodes.coordinator.scene.settled import Settled
from semmap.nodes.coordinator.teaching import Teaching
from semmap.nodes.coordinator.turns import Change, Results, Turns
from semmap.nodes.runtime import heap
from semmap.nodes.runtime.class_names import ClassNames
from semmap.nodes.runtime.following import Begun, Follower
from semmap.nodes.runtime.futures import OwnFuture, settle, then
from semmap.nodes.runtime.loop import Node, open_node
from semmap.schemas import calls, keys, wording
from semmap.schemas import commands as c
from semmap.schemas.entities import BodyState
from semmap.schemas.health import Health
from semmap.schemas.replies import Changed
from semmap.schemas.scenes import DriveBase, Poses

R = TypeVar("R")

_WAIT_S = 20.0
_SIM_TIMEOUT_S = 120.0
_DRIVE_TIMEOUT_S = 3600.0
_URGENT = frozenset({c.Status.VERB})
_ROOM = 64
"""Commands that wait for their turn at most: more wait in the node's queue, which is fair and bounded."""
_LARGE_FILE = 16 << 20
"""Bytes."""


class Coordinator:
    """Binds the door and the keeper to the wire."""

    def __init__(self, node: Node, config: CoordinatorConfig) -> None:
        self._node = node
        self._config = config
        self._bridge = Bridge(node)
        self._door = Door(self._bridge.ask)
        self._turns = Turns(self._change_together)
        self._keeping = Keeping(config, self._door, self._follow, self._ask_sim, node.report)
        self._completion = Completion(config.truth, self._door, self._keeping)
        self._watched = self._completion.watching(self._turns.change)
        self._health = HealthView()
        self._has_map = False
        self._early = EarlyCommands(lambda: node.is_there("kb_node"))
        self._waiting: list[tuple[str, float, Changed, Future[Changed]]] = []
        door = self._door
        self._live = LiveFeed(node, config, door.map, self._keeping.scene, self._turns.change)
        stale_s, scene = config.live.stale_s, self._keeping.scene
        frames = Frames(node, stale_s, door.map, self._live, scene, self._ask_sim, self._bridge, self._turns)
        answers = Answers(config.truth, door, self._keeping, self._health, self._bridge, self._live, frames)
        among_walls = AmongWalls(self._keeping, self._ask_sim, self._bridge.ask_later)
        completion = self._completion
        running = Running(
            config.truth, door, self._keeping, completion, self._ask_sim, self._bridge.ask_later
        )
        opening = Opening(door, self._keeping, completion, self._ask_sim)
        scene = self._keeping.scene
        self._gripping = Gripping(
            config.truth, door, scene, self._turns.change, self._ask_sim, self._bridge.ask_later
        )
        teaching = Teaching(door, lambda: self._health.alive("perception_node"))
        door.map.where, door.map.bodies = self._live.where, lambda: scene.bodies
        relay = self._bridge.relay
        of_the_map = calls.by_verb(
            c.Add.answered_by(frames.placed(self._with_body)),
            c.Update.answered_by(frames.placed(self._with_body)),
            c.Set.answered_by(self._turns.change),
            c.Unset.answered_by(self._turns.change),
            c.Batch.answered_by(self._noted),
            c.Track.answered_by(self._track),
            c.Remove.answered_by(self._noted),
            c.Clear.answered_by(self._noted),
            c.Load.answered_by(self._load),
            c.Undo.answered_by(lambda command: running.undo(command, self._turns.change)),
            c.List.answered_by(frames.placed(answers.list)),
            c.Get.answered_by(frames.placed(answers.get)),
            c.ListFrames.answered_by(frames.list),
            c.Move.answered_by(frames.placed(running.move)),
            c.Attach.answered_by(self._gripping.attach),
            c.Detach.answered_by(self._gripping.detach),
            c.Open.answered_by(opening.move),
            c.Close.answered_by(opening.move),
            c.Drive.answered_by(frames.placed(running.drive)),
            c.Pause.answered_by(running.pause),
            c.StepOnce.answered_by(running.step),
            c.Reset.answered_by(running.reset),
            c.TakePicture.answered_by(running.picture),
            c.Learn.answered_by(teaching.learn),
            c.Learned.answered_by(teaching.relay),
            c.Forget.answered_by(teaching.relay),
            c.History.answered_by(relay),
            c.LastSeen.answered_by(relay),
            c.Check.answered_by(relay),
            c.Infer.answered_by(relay),
            c.Explain.answered_by(relay),
            c.Could.answered_by(relay),
            c.Relations.answered_by(relay),
            c.Understand.answered_by(relay),
            c.Tell.answered_by(relay),
            c.Find.answered_by(relay),
            c.Diff.answered_by(relay),
            c.WasWhen.answered_by(relay),
            c.Export.answered_by(relay),
            c.PlanFloor.answered_by(among_walls.plan),
            c.FindWay.answered_by(among_walls.route),
            c.Classes.answered_by(relay),
            c.Properties.answered_by(relay),
            c.Sparql.answered_by(relay),
            c.Watch.answered_by(relay),
            c.Renew.answered_by(relay),
            c.Backup.answered_by(relay),
            c.Compact.answered_by(relay),
        )
        approvals = Approvals()
        handlers = {
            **{verb: (kind, self._with_map(function)) for verb, (kind, function) in of_the_map.items()},
            **calls.by_verb(
                c.Status.answered_by(answers.status),
                c.Submit.answered_by(approvals.submit),
                c.Approve.answered_by(approvals.approve),
            ),
        }
        Follower(node, door.map, keys.COMMIT_EFFECTS, heard=lambda commit, known: None, begun=self._on_map)
        node.follow_newest(keys.POSES, self._on_poses)
        node.follow(keys.HEALTH, self._on_health)
        left = self._is_left_to_the_map
        node.serve(keys.CMD, handlers, puts=True, leave=left, admit=admission.claimed, urgent=_URGENT)
        if config.keys is not None:
            proved = admission.Admission(config.keys).proved
            node.serve(keys.commands_as(), handlers, leave=left, admit=proved, urgent=_URGENT)
        node.while_there_is_room(self._has_room)
        node.every(0.2, self._tick)
        node.when_idle(self._catch_up)

    def _is_left_to_the_map(self, verb: str) -> bool:
        """Does the knowledge base answer such queries itself just now?"""
        return verb in keys.OF_THE_MAP and self._node.is_there("kb_node")

    def _has_room(self) -> bool:
        return len(self._turns) + len(self._early) < _ROOM

    # Following

    def _on_map(self, begun: Begun) -> None:
        self._door.map.classes = ClassNames(begun.classes)
        self._has_map = True
        gc.freeze()  # most of the map stays as it is: the collector need not look through it again
        self._node.ready(wording.entities(len(self._door.map.entities)))
        self._keep()

    def _on_poses(self, poses: Poses) -> None:
        if self._has_map:
            self._live.on_scene()
            self._keeping.on_poses(poses)
            self._answer_waiting()

    def _on_health(self, health: Health) -> None:
        self._health.take(health)

    def _tick(self) -> None:
        if not self._health.alive("sim_node"):
            self._keeping.lose_scene()
        self._early.go_on(has_map=self._has_map)
        self._turns.go_on()  # however busy the node is
        self._keep()

    def _keep(self) -> None:
        if self._has_map:
            self._keeping.keep()
            self._answer_waiting()
            scene = self._keeping.scene
            bodies = f", {wording.bodies(len(scene.bodies))}" if scene.known else ""
            self._node.describe(f"{wording.entities(len(self._door.map.entities))}{bodies}")

    def _catch_up(self) -> None:
        """Begin the changes that wait, and look at what commits changed; all the rest at each tick."""
        self._turns.go_on()
        if names := self._door.map.touched:
            self._door.map.touched = set()
            self._keeping.keep(names)
            self._answer_waiting()

    # Changing

    def _with_body(self, command: c.Add | c.Update) -> Future[Changed]:
        """The reply waits for the body if that is wanted."""
        made = self._noted(command)
        if not command.wait or command.dry_run:
            return made
        future: Future[Changed] = OwnFuture()
        made.add_done_callback(lambda done: settle(future, lambda: self._once_there_is_a_body(done.result())))
        return future

    def _follow(self, change: c.Add | Settled) -> Future[Changed]:
        """The map follows the scene; those who wait for that are told."""
        return self._watched(change)

    def _track(self, command: c.Track) -> Future[Changed]:
        """What is not tracked any more stays where it was last, by a commit of its own."""
        settled = self._live.settle(command.name) if command.off and not command.dry_run else None
        if settled is None:
            return self._turns.change(command)
        future: Future[Changed] = OwnFuture()
        settled.add_done_callback(lambda _: settle(future, lambda: self._turns.change(command)))
        return future

    def _load(self, command: c.Load) -> Future[Changed]:
        made = self._turns.change(command)
        if len(command.content) > _LARGE_FILE:
            made.add_done_callback(lambda _: self._node.soon(_tidy))
        return made

    def _change_together(self, changes: Sequence[Change]) -> Future[Results]:
        nobody_waits = len(changes) == 1 and not len(self._turns)
        ask = self._bridge.change if nobody_waits else self._bridge.change_later
        return hold_later(self._door.together(changes), ask)

    def _once_there_is_a_body(self, changed: Changed) -> Future[Changed]:
        future: Future[Changed] = OwnFuture()
        if not changed.names:  # the id is that of an earlier change, which named nothing
            future.set_result(changed)
            return future
        self._waiting.append((changed.names[0], time.monotonic() + _WAIT_S, changed, future))
        return future

    def _answer_waiting(self) -> None:
        self._completion.answer_waiting()
        if not self._waiting:
            return
        still = []
        undecided = {"pending"}
        if self._health.may_be_there("sim_node"):
            undecided.add("unknown")  # its scene is still to come
        for name, deadline, changed, future in self._waiting:
            entity = self._door.map.entities.get(name)
            state = self._keeping.body_state(entity) if entity is not None else None
            if state is not None and state.status in undecided and time.monotonic() < deadline:
                still.append((name, deadline, changed, future))
                continue
            status = _spoken(state) if state is not None else "removed meanwhile"
            future.set_result(structs.replace(changed, text=f"{changed.text}; body: {status}"))
        self._waiting = still

    def _noted(self, command: c.Add | c.Update | c.Batch | c.Remove | c.Clear) -> Future[Changed]:
        """With a word on what will become of it where the map does not own what it changes."""
        made, note = self._turns.change(command), authority.note(command, self._config.truth)
        if note is None:
            return made
        return then(made, lambda changed: structs.replace(changed, notes=(*changed.notes, note)))

    def _with_map(self, handle: Callable[[Any], Any]) -> Callable[[Any], Any]:
        def guarded(command: Any) -> Any:
            if not self._has_map:
                return self._early.wait(lambda: guarded(command))
            if isinstance(command, Change):
                return handle(command)
            return self._turns.after(lambda: handle(command))

        return guarded

    def _ask_sim(self, call: calls.Call[R]) -> Future[R]:
        timeout_s = _DRIVE_TIMEOUT_S if isinstance(call, DriveBase) else _SIM_TIMEOUT_S
        return self._node.ask_later(keys.SIM, call, timeout_s=timeout_s)


def _tidy() -> None:
    """Part with a large file: the dialogue over it is a cycle, which would not be found for long."""
    gc.collect()
    heap.trim()
    gc.freeze()


def _spoken(state: BodyState) -> str:
    return f"{state.status}: {state.detail}" if state.detail else state.status


def run(config: CoordinatorConfig) -> None:
    """Serve until stopped."""
    with open_node("coordinator", config.network) as node:
        Coordinator(node, config)
        node.run()
