"""Executes what `reconcile` decides: orders to the simulator, and changes of the map.

Only one batch of orders is under way at a time. It ends with a new scene snapshot, so the next comparison
never uses a scene that is older than the orders before it.
"""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import Future
from functools import partial
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

from semmap.nodes.coordinator.commands.dispatcher import CommandDispatcher
from semmap.nodes.coordinator.config import CoordinatorConfig
from semmap.nodes.coordinator.reconciler import scene_report
from semmap.nodes.coordinator.reconciler.agreement import (
    Agreement,
    describe_displaced,
    describe_pending,
    find_displaced,
)
from semmap.nodes.coordinator.reconciler.map_updates import ChangeMap, Corrections, MapUpdater
from semmap.nodes.coordinator.reconciler.reconcile import (
    Actions,
    body_order,
    joint_order,
    latest_commit,
    reconcile,
)
from semmap.nodes.coordinator.reconciler.spawn_batches import split_orders
from semmap.nodes.coordinator.reconciler.waiting_orders import WaitingOrders
from semmap.nodes.coordinator.scene.scene_view import SceneView
from semmap.nodes.runtime.futures import then
from semmap.schemas import errors
from semmap.schemas.attachments import holder_of
from semmap.schemas.calls import Call
from semmap.schemas.entities import BodyState, Entity
from semmap.schemas.joints import is_on, openness
from semmap.schemas.scenes import (
    BodiesMoved,
    BodyOrder,
    Delete,
    Grip,
    GripOrder,
    Gripped,
    JointsMoving,
    MoveBodies,
    MoveJoints,
    Placement,
    Poses,
    SceneQuery,
    Spawn,
    Spawned,
)

log = logging.getLogger(__name__)

T = TypeVar("T")


class AskSim(Protocol):
    """`ask(call)` sends a request to the simulator and returns immediately."""

    def __call__(self, call: Call[T], /) -> Future[T]:  # noqa: D102
        ...


class Step(NamedTuple, Generic[T]):
    """A request to the simulator, and the function that handles the reply."""

    call: Call[T]
    handle: Callable[[T], None]


class Reconciler:
    """Keeps the scene and the map in agreement. Owned by the coordinator's thread."""

    def __init__(
        self,
        config: CoordinatorConfig,
        dispatcher: CommandDispatcher,
        change: ChangeMap,
        ask: AskSim,
        report: Callable[[str], None],
    ) -> None:
        """`change` changes the map, and `ask` sends requests to the simulator. Neither of them waits."""
        self._config = config
        self._dispatcher = dispatcher
        self._ask = ask
        self._report = report
        self.scene = SceneView()
        self._failed_bodies: dict[str, tuple[int, str]] = {}
        self._failed_grips: dict[str, tuple[int, str]] = {}
        self._steps: deque[Step[Any]] = deque()
        self._busy = False
        self._revisit: set[str] = set()
        """Bodies that have to be compared again when the orders under way are done."""
        self._waiting = WaitingOrders(self._is_to_be_placed)
        self._updater = MapUpdater(
            dispatcher, self.scene, config.thresholds, self.wanted, change, report, self._revisit
        )

    def on_poses(self, poses: Poses) -> None:
        """Update the scene by new poses from the simulator, and reconcile the bodies that changed."""
        changed = self.scene.update(poses)
        if changed is not None:
            self._revisit |= changed
            self._reconcile_rest()
        elif not self._busy:
            self._start([])
        self._waiting.release()

    def lose_scene(self) -> None:
        """Forget the scene of a silent simulator, unless it is still executing orders."""
        if self.scene.known and not self._busy:
            self.scene.forget()
            self._waiting.release()

    def reconcile(self, names: Collection[str] | None = None) -> None:
        """Begin the actions for all, or for these, entities and bodies; later if orders are under way."""
        if self._busy:
            self._revisit.update(names or ())
        if self._busy or not self.scene.known:
            return
        self._updater.forget_waits()
        actions = self.wanted(names)
        self._updater.update(actions)
        if steps := self._orders(actions, self._updater.take_corrections()):
            self._start(steps)

    def _reconcile_rest(self) -> None:
        """Reconcile the bodies that had to wait."""
        if self._revisit and not self._busy:
            names = {*self._revisit}
            self._revisit.clear()
            self.reconcile(names)

    def wanted(self, names: Collection[str] | None = None) -> Actions:
        """Return the remaining differences of map and scene: all, or those of these entities and bodies."""
        failed = {name: commit for name, (commit, _) in self._failed_bodies.items()}
        entities, bodies = self._dispatcher.map.entities, self.scene.bodies
        if names is not None:
            entities, bodies = _only(names, entities), _only(names, bodies)
        there = self.scene.bodies
        wanted = reconcile(entities, bodies, self._config.truth, self._config.thresholds, failed, there)
        if self._failed_grips:
            tried = {name: commit for name, (commit, _) in self._failed_grips.items()}
            wanted = wanted._replace(
                grips=tuple(order for order in wanted.grips if tried.get(order.name) != order.commit)
            )
        return wanted

    def agreement(self, names: Collection[str] | None = None) -> Agreement:
        """Return whether map and scene agree, and their differences.

        With `names`, only these entities and bodies are compared. Raises UnknownName for a name that is
        neither in the map nor in the scene.
        """
        entities, bodies = self._dispatcher.map.entities, self.scene.bodies
        thresholds = self._config.thresholds
        if names is not None:
            for name in names:
                if name not in bodies:
                    self._dispatcher.map.entity(name)
            entities, bodies = _only(names, entities), _only(names, bodies)
        without_state = self._updater.without_state
        found = find_displaced(entities, bodies, self._config.truth, thresholds, without_state)
        displaced = tuple(describe_displaced(entities[name], bodies[name], thresholds) for name in found)
        if not self.scene.known or self._config.truth == "perceived":
            return Agreement(None, displaced=displaced)
        wanted = self.wanted(names)
        pending = describe_pending(wanted, {*self._updater.rejected, *without_state})
        settled = self._dispatcher.map.is_confirmed and not (names is None and self._busy)
        return Agreement(
            settled and not (pending or displaced or wanted.missing), pending=pending, displaced=displaced
        )

    def is_followed(self, name: str) -> bool:
        """Return whether the map has committed the state of a body, or never will."""
        wanted = self.wanted((name,))
        state = () if name in self._updater.without_state else (*wanted.opened, *wanted.gripped)
        return not (
            self._updater.is_following((name,)) or wanted.follow or state or wanted.joints or wanted.grips
        )

    def is_following(self, names: Collection[str]) -> bool:
        """Return whether a commit about one of these bodies is under way."""
        return self._updater.is_following(names)

    def return_bodies(self, names: Collection[str]) -> Future[None]:
        """Put bodies back to their committed poses; the map does not follow them before."""
        there = _only(names, self._dispatcher.map.entities).values()
        placements = tuple(
            Placement(name=e.name, pose=e.pose, commit=e.pose_provenance.commit)
            for e in there
            if e.pose is not None and e.name in self.scene.bodies and not holder_of(e)
        )
        return self._return(names, MoveBodies(placements=placements))

    def return_joints(self, names: Collection[str]) -> Future[None]:
        """Move joints back to their committed positions; the map does not follow them before."""
        entities, bodies = self._dispatcher.map.entities, self.scene.bodies
        there = [name for name in names if name in entities and name in bodies]
        return self._return(
            names, MoveJoints(orders=tuple(joint_order(entities[n], bodies[n]) for n in there))
        )

    def _return(self, names: Collection[str], call: Call[BodiesMoved] | Call[JointsMoving]) -> Future[None]:
        resume = self._updater.suspend(names)
        reply: Future[BodiesMoved | JointsMoving] = self._ask(call)  # type: ignore[arg-type]
        reply.add_done_callback(lambda _: resume())
        return then(reply, lambda moved: self.scene.add(moved.bodies))

    def when_placed(self, name: str, execute: Callable[[], Future[T]]) -> Future[T]:
        """Return the result of `execute()`, called once the body is there as the map orders it."""
        return self._waiting.run(name, execute)

    def _is_to_be_placed(self, name: str) -> bool:
        if not self.scene.known:
            return False
        entity = self._dispatcher.map.entities.get(name)
        if entity is not None and self.body_state(entity).status == "pending":
            return True
        wanted = self.wanted((name,))
        return bool(wanted.place or wanted.joints)

    def place_all(self) -> Future[Any]:
        """Put every body back to its committed pose, and try again to create failed bodies.

        Raises NoAnswer while no simulator runs.
        """
        if not self.scene.known:
            raise errors.NoAnswer("no simulator is running")
        self._failed_bodies.clear()
        self.reconcile()
        placements = tuple(
            Placement(name=e.name, pose=e.pose, commit=e.pose_provenance.commit)
            for e in self._dispatcher.map.entities.values()
            if e.pose is not None and e.name in self.scene.bodies
            if not (holder_of(e) or self.scene.bodies[e.name].held_by)
        )
        bodies, entities = self.scene.bodies, self._dispatcher.map.entities
        jointed = [name for name, body in bodies.items() if body.joints and name in entities]
        orders = tuple(joint_order(entities[name], bodies[name]) for name in jointed)
        if orders:
            self._ask(MoveJoints(orders=orders))
        return self._ask(MoveBodies(placements=placements))

    def body_state(self, entity: Entity) -> BodyState:
        """Return the state of the body of `entity`."""
        body = self.scene.bodies.get(entity.name)
        if entity.place:
            return BodyState(status="none", detail="a place has no body")
        if self._config.truth == "perceived":
            return BodyState(
                status="none", detail="the map is updated by perception only", model=entity.model
            )
        if not self.scene.known:
            return BodyState(status="unknown", detail="no simulator is running", model=entity.model)
        if body is not None:
            return BodyState(
                status="ghost" if body.ghost else "present",
                detail=scene_report.describe_ghost(body) if body.ghost else "",
                model=body.model,
                body=body.body,
                joints=body.joints,
                openness=openness(body.joints),
                switched_on=is_on(body.joints),
            )
        commit, reason = self._failed_bodies.get(entity.name, (None, ""))
        if commit == latest_commit(entity):
            return BodyState(status="failed", detail=reason, model=entity.model)
        if self._config.truth == "scene":
            return BodyState(status="missing", detail="it is not in the scene", model=entity.model)
        if entity.pose is None:
            way = (
                "publish live poses" if entity.tracked else f"set one: semmap update {entity.name} --at X Y Z"
            )
            return BodyState(status="none", detail=f"it has no position; {way}", model=entity.model)
        return BodyState(status="pending", model=entity.model)

    def problems(self) -> list[str]:
        """Return the problems of map and scene, one sentence each."""
        entities, bodies = self._dispatcher.map.entities, self.scene.bodies
        need_bodies = self.scene.known and self._config.truth != "perceived"
        rejected, is_truth = self._updater.rejected, self._config.truth == "scene"
        return [
            *scene_report.entity_problems(entities.values(), self.body_state if need_bodies else None),
            *scene_report.failed_attachments(self._failed_grips, entities),
            *scene_report.fallen_robots(bodies.values()),
            *scene_report.unstable_bodies(self.scene.unstable),
            *scene_report.perception_conflicts(entities.values()),
            *scene_report.names_like_text(entities.values()),
            *(f"{name}: {why}" for name, why in sorted(rejected.items()) if name in bodies),
            *(
                scene_report.bodies_to_adopt(bodies.values(), entities, rejected, self._updater.whole_of)
                if is_truth
                else ()
            ),
            *scene_report.bodies_left_out(self.scene.left_out if is_truth else ()),
        ]

    def _orders(self, actions: Actions, corrections: Corrections) -> list[Step[Any]]:
        steps: list[Step[Any]] = []
        if actions.delete:
            steps.append(Step(Delete(names=actions.delete), lambda _: None))
        steps.extend(self._spawning(batch) for batch in split_orders(actions.spawn))
        if grips := (*actions.grips, *corrections.grips):
            steps.append(Step(Grip(orders=grips), partial(self._on_gripped, grips)))
        if placements := (*actions.place, *corrections.placements):
            steps.append(Step(MoveBodies(placements=placements), self._on_placed))
        if joints := (*actions.joints, *corrections.joints):
            steps.append(Step(MoveJoints(orders=joints), lambda _: None))
        return steps

    def _spawning(self, batch: tuple[BodyOrder, ...]) -> Step[Spawned]:
        tried = {order.name: order.commit for order in batch}
        return Step(Spawn(bodies=batch), partial(self._on_spawned, tried))

    def _start(self, steps: list[Step[Any]]) -> None:
        self._busy = True
        self._steps = deque([*steps, Step(SceneQuery(), self.scene.take)])
        self._next()

    def _next(self) -> None:
        if not self._steps:
            self._busy = False
            self._reconcile_rest()
            self._waiting.release()
            return
        call, handle = self._steps.popleft()

        def on_done(future: Future[Any]) -> None:
            try:
                handle(future.result())
            except Exception as error:  # any error: the orders are tried again at the next comparison
                self._busy = False
                self._report(f"the simulator failed to {call.VERB}: {error}")
            else:
                self._next()

        self._ask(call).add_done_callback(on_done)

    def _on_gripped(self, orders: Sequence[GripOrder], reply: Gripped) -> None:
        for order in orders:
            self._failed_grips.pop(order.name, None)
            if order.name in reply.failed and order.commit is not None:
                self._failed_grips[order.name] = (order.commit, reply.failed[order.name])

    def _on_spawned(self, tried: dict[str, int], reply: Spawned) -> None:
        for name in tried:
            self._failed_bodies.pop(name, None)
        self.scene.add(reply.bodies)
        for name, reason in reply.failed.items():
            self._failed_bodies[name] = (tried[name], reason)
            log.warning("%s has no body: %s", name, reason)  # `problems` lists it as long as it is true

    def _on_placed(self, reply: BodiesMoved) -> None:
        """Create bodies again that could not be placed; if that fails, there is a reason for it.

        The bodies of the world file are not created again: they may be attached, and the map follows them.
        """
        entities, bodies = self._dispatcher.map.entities, self.scene.bodies
        again = tuple(
            body_order(entity, entity.pose)
            for name in reply.failed
            if (entity := entities.get(name)) is not None and entity.pose is not None
            if name not in bodies or bodies[name].entity
        )
        if again:
            delete = Delete(names=tuple(order.name for order in again))
            self._steps.extendleft([self._spawning(again), Step(delete, lambda _: None)])


def _only(names: Collection[str], mapping: Mapping[str, T]) -> dict[str, T]:
    return {name: mapping[name] for name in names if name in mapping}
