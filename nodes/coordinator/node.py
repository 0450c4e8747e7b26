"""The coordinator's Zenoh interface: `semmap/cmd/<verb>` comes in, transactions and orders go out."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from typing import Any, TypeVar

from msgspec import structs

from semmap.nodes.coordinator.access import admission, authority
from semmap.nodes.coordinator.access.approvals import Approvals
from semmap.nodes.coordinator.commands.dispatcher import CommandDispatcher
from semmap.nodes.coordinator.commands.entity_changes import require_removable
from semmap.nodes.coordinator.commands.joint_state import reserve_for_scene
from semmap.nodes.coordinator.commands.registration import HANDLERS
from semmap.nodes.coordinator.config import CoordinatorConfig
from semmap.nodes.coordinator.early_commands import EarlyCommands
from semmap.nodes.coordinator.exemplar_commands import ExemplarCommands
from semmap.nodes.coordinator.frames.feed import Frames
from semmap.nodes.coordinator.health_view import HealthView
from semmap.nodes.coordinator.kb_client import KbClient
from semmap.nodes.coordinator.kb_coroutines import run_async
from semmap.nodes.coordinator.live.feed import LiveFeed
from semmap.nodes.coordinator.local_queries import LocalQueries
from semmap.nodes.coordinator.reconciler.observed_state import ObservedState
from semmap.nodes.coordinator.reconciler.reconciler import Reconciler
from semmap.nodes.coordinator.scene.attach_commands import AttachCommands
from semmap.nodes.coordinator.scene.completion import Completion
from semmap.nodes.coordinator.scene.joint_commands import JointCommands
from semmap.nodes.coordinator.scene.scene_commands import SceneCommands
from semmap.nodes.coordinator.scene.wall_queries import WallQueries
from semmap.nodes.coordinator.scheduler import Change, Results, Scheduler
from semmap.nodes.runtime import memory
from semmap.nodes.runtime.class_names import ClassNames
from semmap.nodes.runtime.futures import SingleThreadFuture, settle, then
from semmap.nodes.runtime.loop import HasGone, Node, open_node
from semmap.nodes.runtime.map_follower import Follower, SnapshotLoaded
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
"""Largest number of scheduled commands. Further ones wait in the node's queue, which is bounded."""
_LARGE_FILE = 16 << 20
"""Bytes."""


class Coordinator:
    """Connects the command dispatcher and the reconciler to Zenoh."""

    def __init__(self, node: Node, config: CoordinatorConfig) -> None:
        self._node = node
        self._config = config
        self._kb = KbClient(node)
        self._dispatcher = CommandDispatcher(self._kb.ask)
        self._scheduler = Scheduler(
            self._change_together, node.has_gone, lambda word: word in self._dispatcher.map.entities
        )
        self._reconciler = Reconciler(config, self._dispatcher, self._follow, self._ask_sim, node.report)
        self._completion = Completion(config.truth, self._dispatcher, self._reconciler)
        self._watched = self._completion.watch(self._scheduler.change)
        self._health = HealthView()
        self._has_map = False
        self._early = EarlyCommands(lambda: node.is_there("kb_node"))
        self._waiting: list[tuple[str, float, Changed, Future[Changed]]] = []
        dispatcher = self._dispatcher
        self._live = LiveFeed(node, config, dispatcher.map, self._reconciler.scene, self._scheduler.change)
        stale_s, scene = config.live.stale_s, self._reconciler.scene
        frames = Frames(
            node, stale_s, dispatcher.map, self._live, scene, self._ask_sim, self._kb, self._scheduler
        )
        local_queries = LocalQueries(
            config.truth, dispatcher, self._reconciler, self._health, self._kb, self._live, frames
        )
        wall_queries = WallQueries(self._reconciler, self._ask_sim, self._kb.ask_later)
        completion = self._completion
        scene_commands = SceneCommands(
            config.truth, dispatcher, self._reconciler, completion, self._ask_sim, self._kb.ask_later
        )
        joint_commands = JointCommands(dispatcher, self._reconciler, completion, self._ask_sim)
        scene = self._reconciler.scene
        self._attach_commands = AttachCommands(
            config.truth, dispatcher, scene, self._scheduler.change, self._ask_sim, self._kb.ask_later
        )
        exemplars = ExemplarCommands(dispatcher, lambda: self._health.alive("perception_node"))
        dispatcher.map.pose_of, dispatcher.map.bodies = self._live.pose_of, lambda: scene.bodies
        if config.truth == "scene":
            dispatcher.map.reserve = lambda transaction: reserve_for_scene(transaction, scene.bodies)
        relay = self._kb.relay
        of_the_map = calls.by_verb(
            *(kind.answered_by(self._scheduler.change) for kind in HANDLERS),  # unless it has a row below
            c.Add.answered_by(frames.in_map_frame(self._change_and_wait_for_body)),
            c.Update.answered_by(frames.in_map_frame(self._change_and_wait_for_body)),
            c.Batch.answered_by(self._change_with_note),
            c.Set.answered_by(self._change_with_note),
            c.Unset.answered_by(self._change_with_note),
            c.Track.answered_by(self._track),
            c.Remove.answered_by(self._change_with_note),
            c.Clear.answered_by(self._change_with_note),
            c.Load.answered_by(self._load),
            c.Undo.answered_by(lambda command: scene_commands.undo(command, self._change_with_note)),
            c.List.answered_by(frames.in_map_frame(local_queries.list)),
            c.Get.answered_by(frames.in_map_frame(local_queries.get)),
            c.ListFrames.answered_by(frames.list),
            c.Move.answered_by(frames.in_map_frame(scene_commands.move)),
            c.Attach.answered_by(self._attach_commands.attach),
            c.Detach.answered_by(self._attach_commands.detach),
            c.Open.answered_by(joint_commands.move),
            c.Close.answered_by(joint_commands.move),
            c.Drive.answered_by(frames.in_map_frame(scene_commands.drive)),
            c.Pause.answered_by(scene_commands.pause),
            c.StepOnce.answered_by(scene_commands.step),
            c.Reset.answered_by(scene_commands.reset),
            c.TakePicture.answered_by(scene_commands.render),
            c.Learn.answered_by(exemplars.learn),
            c.Learned.answered_by(exemplars.relay),
            c.Forget.answered_by(exemplars.relay),
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
            c.FindTrail.answered_by(relay),
            c.Export.answered_by(relay),
            c.PlanFloor.answered_by(wall_queries.plan),
            c.FindWay.answered_by(wall_queries.route),
            c.Classes.answered_by(relay),
            c.Properties.answered_by(relay),
            c.Rules.answered_by(relay),
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
                c.Status.answered_by(local_queries.status),
                c.Submit.answered_by(approvals.submit),
                c.Approve.answered_by(approvals.approve),
            ),
        }
        Follower(
            node,
            dispatcher.map,
            keys.COMMIT_EFFECTS,
            on_commit=lambda commit, known: None,
            on_snapshot=self._on_map,
        )
        node.follow_newest(keys.POSES, self._on_poses)
        node.follow(keys.HEALTH, self._on_health)
        node.monitor_departures()
        left = self._is_answered_by_kb
        node.serve(keys.CMD, handlers, puts=True, leave=left, admit=admission.admit_claimed, urgent=_URGENT)
        if config.keys is not None:
            proved = admission.Admission(config.keys).admit_certified
            node.serve(keys.commands_as(), handlers, leave=left, admit=proved, urgent=_URGENT)
        node.while_there_is_room(self._has_room)
        node.every(0.2, self._tick)
        node.when_idle(self._catch_up)

    def _is_answered_by_kb(self, verb: str) -> bool:
        """Return whether the knowledge base currently answers queries of this command itself."""
        return verb in keys.OF_THE_MAP and self._node.is_there("kb_node")

    def _has_room(self) -> bool:
        return len(self._scheduler) + len(self._early) < _ROOM

    # Following

    def _on_map(self, begun: SnapshotLoaded) -> None:
        self._dispatcher.map.classes = ClassNames(begun.classes)
        self._has_map = True
        gc.freeze()  # most of the map stays as it is, so the collector does not have to visit it again
        self._node.ready(wording.entities(len(self._dispatcher.map.entities)))
        self._reconcile()

    def _on_poses(self, poses: Poses) -> None:
        if self._has_map:
            self._live.on_scene()
            self._reconciler.on_poses(poses)
            self._answer_waiting()

    def _on_health(self, health: Health) -> None:
        self._health.take(health)

    def _tick(self) -> None:
        if not self._health.alive("sim_node"):
            self._reconciler.lose_scene()
        self._early.retry(has_map=self._has_map)
        self._scheduler.run_ready()  # however busy the node is
        self._reconcile()

    def _reconcile(self) -> None:
        if self._has_map:
            self._reconciler.reconcile()
            self._answer_waiting()
            scene = self._reconciler.scene
            bodies = f", {wording.bodies(len(scene.bodies))}" if scene.known else ""
            self._node.describe(f"{wording.entities(len(self._dispatcher.map.entities))}{bodies}")

    def _catch_up(self) -> None:
        """Begin the scheduled changes, and reconcile what commits have changed."""
        self._scheduler.run_ready()
        if names := self._dispatcher.map.touched:
            self._dispatcher.map.touched = set()
            self._reconciler.reconcile(names)
            self._answer_waiting()

    # Changing

    def _change_and_wait_for_body(self, command: c.Add | c.Update) -> Future[Changed]:
        """Add or update an entity; the reply waits for its body if the command asks for that."""
        made = self._change_with_note(command)
        if not command.wait or command.dry_run:
            return made
        future: Future[Changed] = SingleThreadFuture()
        made.add_done_callback(lambda done: settle(future, lambda: self._wait_for_body(done.result())))
        return future

    def _follow(self, change: c.Add | ObservedState) -> Future[Changed]:
        """Change the map after the scene, and notify the replies that wait for this commit."""
        return self._watched(change)

    def _track(self, command: c.Track) -> Future[Changed]:
        """Change the tracking of an entity. If it ends, the last live pose is committed first."""
        settled = self._live.commit_pose(command.name) if command.off and not command.dry_run else None
        if settled is None:
            return self._scheduler.change(command)
        future: Future[Changed] = SingleThreadFuture()
        settled.add_done_callback(lambda _: settle(future, lambda: self._scheduler.change(command)))
        return future

    def _load(self, command: c.Load) -> Future[Changed]:
        made = self._scheduler.change(command)
        if len(command.content) > _LARGE_FILE:
            made.add_done_callback(lambda _: self._node.soon(_release_memory))
        return made

    def _change_together(self, changes: Sequence[Change], has_gone: HasGone) -> Future[Results]:
        is_alone = len(changes) == 1 and not len(self._scheduler)
        ask = self._kb.change if is_alone else self._kb.change_later
        return run_async(self._dispatcher.run_together(changes), lambda call: ask(call, has_gone))

    def _wait_for_body(self, changed: Changed) -> Future[Changed]:
        future: Future[Changed] = SingleThreadFuture()
        if not changed.names:  # the id belongs to an earlier change without names
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
        if self._health.may_be_alive("sim_node"):
            undecided.add("unknown")  # its scene has not arrived yet
        for name, deadline, changed, future in self._waiting:
            entity = self._dispatcher.map.entities.get(name)
            state = self._reconciler.body_state(entity) if entity is not None else None
            if state is not None and state.status in undecided and time.monotonic() < deadline:
                still.append((name, deadline, changed, future))
                continue
            status = _describe_body(state) if state is not None else "removed in the meantime"
            future.set_result(structs.replace(changed, text=f"{changed.text}; body: {status}"))
        self._waiting = still

    def _change_with_note(
        self, command: c.Add | c.Update | c.Batch | c.Set | c.Unset | c.Remove | c.Clear | c.Undo
    ) -> Future[Changed]:
        """Change the map, and add a note if the scene or perception will override the change."""
        if isinstance(command, c.Remove) and self._config.truth != "replayed":
            require_removable(command.names, self._reconciler.scene.bodies)
        made, note = self._scheduler.change(command), authority.describe_override(command, self._config.truth)
        if note is None:
            return made
        return then(made, lambda changed: structs.replace(changed, notes=(*changed.notes, note)))

    def _with_map(self, handle: Callable[[Any], Any]) -> Callable[[Any], Any]:
        def guarded(command: Any) -> Any:
            if not self._has_map:
                return self._early.wait(lambda: guarded(command))
            command = self._dispatcher.map.with_primary_names(command)
            if type(command) in HANDLERS:
                return handle(command)
            return self._scheduler.run_after(lambda: handle(command))

        return guarded

    def _ask_sim(self, call: calls.Call[R]) -> Future[R]:
        timeout_s = _DRIVE_TIMEOUT_S if isinstance(call, DriveBase) else _SIM_TIMEOUT_S
        return self._node.ask_later(keys.SIM, call, timeout_s=timeout_s)


def _release_memory() -> None:
    """Free the memory of a large file: its coroutine is a reference cycle, which is collected late."""
    gc.collect()
    memory.trim()
    gc.freeze()


def _describe_body(state: BodyState) -> str:
    return f"{state.status}: {state.detail}" if state.detail else state.status


def run(config: CoordinatorConfig) -> None:
    """Serve until stopped."""
    with open_node("coordinator", config.network) as node:
        Coordinator(node, config)
        node.run()
