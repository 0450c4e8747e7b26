"""Executes what `reconcile` decides: orders to the simulator, and changes of the map.

One batch of orders is under way at a time, and ends with a fresh snapshot; so the next look at the scene is
never older than the orders before it.
"""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from concurrent.futures import Future
from functools import partial
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

from semmap.nodes.coordinator.config import CoordinatorConfig
from semmap.nodes.coordinator.door import Door
from semmap.nodes.coordinator.scene.agreement import (
    Agreement,
    describe_displaced,
    describe_pending,
    find_displaced,
)
from semmap.nodes.coordinator.scene.contents import inside
from semmap.nodes.coordinator.scene.reconcile import (
    Actions,
    grip_order,
    joint_order,
    joints_differ_from_model,
    latest,
    order,
    reconcile,
)
from semmap.nodes.coordinator.scene.rest_waits import RestWaits
from semmap.nodes.coordinator.scene.scene_view import SceneView
from semmap.nodes.coordinator.scene.settled import Settled, statements
from semmap.nodes.coordinator.scene.spawn_batches import batches
from semmap.nodes.runtime.futures import OwnFuture, settle, then
from semmap.schemas import errors, wording
from semmap.schemas.attachments import holder_of
from semmap.schemas.calls import Call
from semmap.schemas.commands import Add
from semmap.schemas.entities import BodyState, Entity, rounded
from semmap.schemas.joints import is_on, openness
from semmap.schemas.replies import Changed
from semmap.schemas.scenes import (
    BodiesMoved,
    Body,
    BodyOrder,
    Delete,
    Grip,
    GripOrder,
    Gripped,
    JointOrder,
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
_PART_OF = "isDirectPartOf"


class AskSim(Protocol):
    """`ask(call)` asks the simulator, without waiting."""

    def __call__(self, call: Call[T], /) -> Future[T]:  # noqa: D102
        ...


class ChangeMap(Protocol):
    """`change(change)` changes the map in its turn, without waiting."""

    def __call__(self, change: Add | Settled, /) -> Future[Changed]:  # noqa: D102
        ...


class Step(NamedTuple, Generic[T]):
    """What is asked of the simulator, and what is done with the answer."""

    call: Call[T]
    handle: Callable[[T], None]


class Keeping:
    """Keeps the scene and the door's map the same. Owned by the coordinator's thread."""

    def __init__(
        self,
        config: CoordinatorConfig,
        door: Door,
        change: ChangeMap,
        ask: AskSim,
        report: Callable[[str], None],
    ) -> None:
        """`change` changes the map, and `ask` asks the simulator; neither waits."""
        self._config = config
        self._door = door
        self._change = change
        self._ask = ask
        self._report = report
        self.scene = SceneView()
        self._failed: dict[str, tuple[int, str]] = {}
        self._foreign: dict[str, str] = {}
        self._steps: deque[Step[Any]] = deque()
        self._busy = False
        self._later: set[str] = set()  # what changed while orders were under way
        self._following: set[str] = set()  # bodies that the map is about to follow, or to take in
        self._put_back: dict[str, Placement] = {}  # bodies that the map did not follow
        self._shut_again: dict[str, JointOrder] = {}  # those whose joints it did not follow
        self._regrip: dict[str, GripOrder] = {}  # those whose holder it did not take over
        self._ungripped: dict[str, tuple[int, str]] = {}  # what the scene could not have held, and why
        self._waits = RestWaits()
        self._unsaid: set[str] = set()  # bodies of whose joints the map has no way to speak
        self._held: list[tuple[str, Callable[[], None]]] = []  # orders to bodies that are yet to be placed

    def on_poses(self, poses: Poses) -> None:
        """New poses from the simulator."""
        changed = self.scene.update(poses)
        if changed is not None:
            self._later |= changed
            self._keep_rest()
        elif not self._busy:
            self._start([])
        self._release()

    def lose_scene(self) -> None:
        """The simulator is silent: forget the scene, unless it is silent over orders of ours."""
        if self.scene.known and not self._busy:
            self.scene.forget()
            self._release()

    def keep(self, names: Collection[str] | None = None) -> None:
        """Do what must be done (about these entities and bodies), later if orders are under way already."""
        if self._busy:
            self._later.update(names or ())
        if self._busy or not self.scene.known:
            return
        self._waits.forget_moving(self.scene.bodies)
        actions = self._follow_contents(self._follow_robots(self.wanted(names)))
        for group in self._to_follow(actions.follow):
            self._follow(group)
        self._follow_joints(actions.opened)
        self._follow_grips(actions.gripped)
        for body in actions.adopt:
            self._adopt(body)
        refused, self._put_back = self._put_back, {}
        shut, self._shut_again = self._shut_again, {}
        grips, self._regrip = self._regrip, {}
        steps = self._orders(actions, [*refused.values()], [*shut.values()], [*grips.values()])
        if steps:
            self._start(steps)

    def _keep_rest(self) -> None:
        """Do what must be done about those that had to wait."""
        if self._later and not self._busy:
            names, self._later = self._later, set()
            self.keep(names)

    def wanted(self, names: Collection[str] | None = None) -> Actions:
        """What map and scene still differ in: all of it, or what concerns these entities and bodies."""
        failed = {name: commit for name, (commit, _) in self._failed.items()}
        entities, bodies = self._door.map.entities, self.scene.bodies
        if names is not None:
            entities, bodies = _only(names, entities), _only(names, bodies)
        there = self.scene.bodies
        wanted = reconcile(entities, bodies, self._config.truth, self._config.thresholds, failed, there)
        if self._ungripped:
            tried = {name: commit for name, (commit, _) in self._ungripped.items()}
            wanted = wanted._replace(
                grips=tuple(order for order in wanted.grips if tried.get(order.name) != order.commit)
            )
        return wanted

    def agreement(self, names: Collection[str] | None = None) -> Agreement:
        """Return whether map and scene are the same, and what they differ in.

        With `names`, what concerns these entities and bodies: what others do is no matter then. Raises
        UnknownName for one that is neither in the map nor in the scene.
        """
        entities, bodies, thresholds = self._door.map.entities, self.scene.bodies, self._config.thresholds
        if names is not None:
            for name in names:
                if name not in bodies:
                    self._door.map.entity(name)
            entities, bodies = _only(names, entities), _only(names, bodies)
        there = find_displaced(entities, bodies, self._config.truth, thresholds, self._unsaid)
        displaced = tuple(describe_displaced(entities[name], bodies[name], thresholds) for name in there)
        if not self.scene.known or self._config.truth == "perceived":
            return Agreement(None, displaced=displaced)
        wanted = self.wanted(names)
        pending = describe_pending(wanted, {*self._foreign, *self._unsaid})
        settled = self._door.map.is_confirmed and not (names is None and self._busy)
        return Agreement(
            settled and not (pending or displaced or wanted.missing), pending=pending, displaced=displaced
        )

    def is_followed(self, name: str) -> bool:
        """Whether the map says of an entity what its body does, or never will; nothing of it is under way."""
        wanted = self.wanted((name,))
        said = () if name in self._unsaid else (*wanted.opened, *wanted.gripped)
        return name not in self._following and not (wanted.follow or said or wanted.joints or wanted.grips)

    def is_following(self, names: Collection[str]) -> bool:
        """Return whether a commit about one of these is under way."""
        return not self._following.isdisjoint(names)

    def return_bodies(self, names: Collection[str]) -> Future[None]:
        """Put bodies back to where the map has them; it does not follow them before."""
        there = _only(names, self._door.map.entities).values()
        placements = tuple(
            Placement(name=e.name, pose=e.pose, commit=e.pose_provenance.commit)
            for e in there
            if e.pose is not None and e.name in self.scene.bodies and not holder_of(e)
        )
        return self._return(names, MoveBodies(placements=placements))

    def return_joints(self, names: Collection[str]) -> Future[None]:
        """Move the joints of bodies back to where the map has them; it does not follow them before."""
        entities, bodies = self._door.map.entities, self.scene.bodies
        there = [name for name in names if name in entities and name in bodies]
        return self._return(
            names, MoveJoints(orders=tuple(joint_order(entities[n], bodies[n]) for n in there))
        )

    def _return(self, names: Collection[str], call: Call[BodiesMoved] | Call[JointsMoving]) -> Future[None]:
        self._following.update(names)

        def on_done(_: Future[Any]) -> None:
            self._following.difference_update(names)
            self._later.update(names)

        asked: Future[BodiesMoved | JointsMoving] = self._ask(call)  # type: ignore[arg-type]
        asked.add_done_callback(on_done)
        return then(asked, lambda reply: self.scene.add(reply.bodies))

    def when_placed(self, name: str, execute: Callable[[], Future[T]]) -> Future[T]:
        """Return what `execute()` returns, which is called once the scene has carried out the map's order.

        An order by hand that came before would be lost: the body is put where an earlier commit has it.
        """
        if not self._is_to_be_placed(name):
            return execute()
        future: Future[T] = OwnFuture()
        self._held.append((name, lambda: settle(future, execute)))
        return future

    def _is_to_be_placed(self, name: str) -> bool:
        return self.scene.known and bool(self.wanted((name,)).place)

    def _release(self) -> None:
        """Let the orders go whose bodies have been placed; those of one body keep their order."""
        held, self._held = self._held, []
        for name, execute in held:
            if self._is_to_be_placed(name):
                self._held.append((name, execute))
            else:
                execute()

    def place_all(self) -> Future[Any]:
        """Put every body back where the map says it stands; those that could not be made are tried again.

        Raises NoAnswer while no simulator runs.
        """
        if not self.scene.known:
            raise errors.NoAnswer("no simulator is running")
        self._failed.clear()
        self.keep()
        placements = tuple(
            Placement(name=e.name, pose=e.pose, commit=e.pose_provenance.commit)
            for e in self._door.map.entities.values()
            if e.pose is not None and e.name in self.scene.bodies
            if not (holder_of(e) or self.scene.bodies[e.name].held_by)
        )
        bodies, entities = self.scene.bodies, self._door.map.entities
        jointed = [name for name, body in bodies.items() if body.joints and name in entities]
        orders = tuple(joint_order(entities[name], bodies[name]) for name in jointed)
        if orders:
            self._ask(MoveJoints(orders=orders))
        return self._ask(MoveBodies(placements=placements))

    def body_state(self, entity: Entity) -> BodyState:
        """What has become of the body of `entity`."""
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
                detail=ghostly(body) if body.ghost else "",
                model=body.model,
                joints=body.joints,
                openness=openness(body.joints),
                switched_on=is_on(body.joints),
            )
        if entity.name in self._failed and self._failed[entity.name][0] == latest(entity):
            return BodyState(status="failed", detail=self._failed[entity.name][1], model=entity.model)
        if self._config.truth == "scene":
            return BodyState(status="missing", detail="it is not in the scene", model=entity.model)
        detail = "" if entity.pose is not None else "it has no position"
        return BodyState(status="pending", detail=detail, model=entity.model)

    def problems(self) -> list[str]:
        """What is amiss between map and scene, one sentence each."""
        entities = self._door.map.entities.values()
        may_lack_bodies = self.scene.known and self._config.truth != "perceived"
        states = ((e.name, self.body_state(e)) for e in entities) if may_lack_bodies else ()
        amiss = sorted(
            f"{name}: {state.status}{': ' if state.detail else ''}{state.detail}"
            for name, state in states
            if state.status in ("failed", "ghost", "missing") or (state.status == "pending" and state.detail)
        )
        seen = sorted(f"{e.name}: perception: {e.conflict}" for e in entities if e.conflict)
        foreign = sorted((name, why) for name, why in self._foreign.items() if name in self.scene.bodies)
        amiss += sorted(
            f"{name}: is not held in the scene as the map says: {reason}"
            for name, (commit, reason) in self._ungripped.items()
            if (e := self._door.map.entities.get(name)) is not None and grip_order(e).commit == commit
        )
        lying = [
            f"{b.name} {wording.fallen(b.name, b.pose)}" for b in self.scene.bodies.values() if b.has_fallen
        ]
        return (
            amiss
            + lying
            + seen
            + [f"{name}: {why}" for name, why in foreign]
            + self._awaited()
            + self._of_the_world()
        )

    def _awaited(self) -> list[str]:
        """Which bodies are to become entities, and what they wait for."""
        if self._config.truth != "scene":
            return []
        entities, bodies = self._door.map.entities, self.scene.bodies
        waiting = [b for b in bodies.values() if b.name not in entities and b.name not in self._foreign]
        moving = [body for body in waiting if not body.resting]
        parts = [body for body in waiting if body.resting and self._whole_of(body) not in {"", *entities}]
        return [
            *(f"{body.name}: a scene body that becomes an entity when it comes to rest" for body in moving),
            *(f"{body.name}: a part of {self._whole_of(body)}, which is no entity yet" for body in parts),
        ]

    def _of_the_world(self) -> list[str]:
        """Which bodies of the world are no entities, though the scene is the truth."""
        names = self.scene.left_out if self._config.truth == "scene" else ()
        if not names:
            return []
        only_parts = "is only a part of another" if len(names) == 1 else "are only parts of others"
        return [
            f"{wording.bodies(len(names))} of the world {only_parts}: {', '.join(names)}"
            ' (to have one, add <text name="semmap:BODY" data="CLASS"/>)'
        ]

    def _orders(
        self, actions: Actions, refused: list[Placement], shut: list[JointOrder], regrip: list[GripOrder]
    ) -> list[Step[Any]]:
        steps: list[Step[Any]] = []
        if actions.delete:
            steps.append(Step(Delete(names=actions.delete), lambda _: None))
        steps.extend(self._spawning(batch) for batch in batches(actions.spawn))
        grips = (*actions.grips, *regrip)
        if grips:
            steps.append(Step(Grip(orders=grips), partial(self._was_gripped, grips)))
        placements = (*actions.place, *refused)
        if placements:
            steps.append(Step(MoveBodies(placements=placements), self._placed))
        joints = (*actions.joints, *shut)
        if joints:
            steps.append(Step(MoveJoints(orders=joints), lambda _: None))
        return steps

    def _spawning(self, batch: tuple[BodyOrder, ...]) -> Step[Spawned]:
        tried = {order.name: order.commit for order in batch}
        return Step(Spawn(bodies=batch), partial(self._spawned, tried))

    def _was_gripped(self, orders: Sequence[GripOrder], reply: Gripped) -> None:
        for asked in orders:
            self._ungripped.pop(asked.name, None)
            if asked.name in reply.failed and asked.commit is not None:
                self._ungripped[asked.name] = (asked.commit, reply.failed[asked.name])

    def _start(self, steps: list[Step[Any]]) -> None:
        self._busy = True
        self._steps = deque([*steps, Step(SceneQuery(), self.scene.take)])
        self._next()

    def _next(self) -> None:
        if not self._steps:
            self._busy = False
            self._keep_rest()
            self._release()
            return
        call, handle = self._steps.popleft()

        def on_done(future: Future[Any]) -> None:
            try:
                handle(future.result())
            except Exception as error:  # whatever it is, it is tried again at the next look
                self._busy = False
                self._report(f"the simulator failed to {call.VERB}: {error}")
            else:
                self._next()

        self._ask(call).add_done_callback(on_done)

    def _spawned(self, tried: dict[str, int], reply: Spawned) -> None:
        for name in tried:
            self._failed.pop(name, None)
        self.scene.add(reply.bodies)
        for name, reason in reply.failed.items():
            self._failed[name] = (tried[name], reason)
            log.warning("%s has no body: %s", name, reason)  # `problems` says so as long as it is true

    def _placed(self, reply: BodiesMoved) -> None:
        """A body that cannot be put where the map says is made anew there, or there is a reason why not.

        The world's own are not: what these are held by does not let them go, and the map follows them.
        """
        entities, bodies = self._door.map.entities, self.scene.bodies
        anew = tuple(
            order(entity, entity.pose)
            for name in reply.failed
            if (entity := entities.get(name)) is not None and entity.pose is not None
            if name not in bodies or bodies[name].entity
        )
        if anew:
            gone = Delete(names=tuple(order.name for order in anew))
            self._steps.extendleft([self._spawning(anew), Step(gone, lambda _: None)])

    def _follow_robots(self, actions: Actions) -> Actions:
        """Follow a robot and its parts in one commit, once all of it rests.

        Gives what is left to be done. Were what rests first followed alone, the rest would be where it was,
        and nothing would be left to do as long as it moves.
        """
        bodies = self.scene.bodies
        done: set[str] = set()
        for name in (*(placement.name for placement in actions.follow), *actions.opened):
            if name in done or not bodies[name].robot or self._door.hands.party_of(name):
                continue
            whole, party = self._robot_of(name)
            done |= party
            if not self._following.isdisjoint(party):
                continue  # it is looked at again when that is done
            wanted = self.wanted(party)
            if not all(bodies[part].resting for part in party) and self._waits.must_wait(
                whole, _due(wanted), self.scene.sim_time_s
            ):
                self._later.update(party)
                continue
            self._waits.end(whole)
            opened = next(filter(self._may_follow_joints, wanted.opened), "")  # others in their turn
            if wanted.follow or opened:
                self._follow(wanted.follow, opened)
        return actions._replace(
            follow=tuple(placement for placement in actions.follow if placement.name not in done),
            opened=tuple(name for name in actions.opened if name not in done),
        )

    def _robot_of(self, name: str) -> tuple[str, set[str]]:
        """The robot that a body is or is part of, and the names of it and of all its parts."""
        bodies = self.scene.bodies

        def whole_of(part: str) -> str:
            while (above := bodies[part].part_of) in bodies:
                part = above
            return part

        whole = whole_of(name)
        return whole, {part for part, body in bodies.items() if body.robot and whole_of(part) == whole}

    def _follow_contents(self, actions: Actions) -> Actions:
        """Follow in one commit how joints stand and what they took along, once all of it rests.

        Gives what is left to be done: what is alone is followed like everything else.
        """
        bodies = self.scene.bodies
        follow = {
            placement.name: placement
            for placement in actions.follow
            if placement.name not in self._following and not self._door.hands.party_of(placement.name)
        }
        opened = [name for name in actions.opened if self._may_follow_joints(name)]
        gone = [bodies[name] for name in follow]
        around = (n for n, b in bodies.items() if gone and b.joints and n not in opened and inside(b, gone))
        done: set[str] = set()
        for whole in (*opened, *around):
            content = inside(bodies[whole], bodies.values())
            moved = [name for name in content if name in follow and name not in done]
            party = [*([whole] if whole in opened else ()), *moved]
            moves = not all(bodies[name].resting for name in (whole, *content))
            if not party or not (moves or len(party) > 1):
                self._waits.end(whole)
                continue
            done.update(party)
            if moves and self._waits.must_wait(whole, party, self.scene.sim_time_s):
                self._later.update(party)
                continue
            self._waits.end(whole)
            self._follow([follow[name] for name in moved], whole if whole in opened else "")
        return actions._replace(
            follow=tuple(placement for placement in actions.follow if placement.name not in done),
            opened=tuple(name for name in actions.opened if name not in done),
        )

    def _may_follow_joints(self, name: str) -> bool:
        return not (name in self._following or name in self._unsaid or name in self._shut_again)

    def _to_follow(self, placements: Sequence[Placement]) -> Iterator[tuple[Placement, ...]]:
        """Each by itself, or together with what a hand carried along with it, once all of that rests."""
        done: set[str] = set()
        for placement in placements:
            if placement.name in done or placement.name in self._following:
                continue
            party = self._door.hands.party_of(placement.name)
            done |= party
            there = _only(party, self.scene.bodies).values()
            if not party:
                yield (placement,)
            elif all(body.resting for body in there):
                yield self.wanted(sorted(party)).follow

    def _follow(self, placements: Sequence[Placement], opened: str = "") -> None:
        """Let the map follow bodies, and how the joints of one stand; if it refuses, they have to go back."""
        poses = {placement.name: rounded(placement.pose) for placement in placements}
        if any(name in self._put_back for name in poses):
            return

        def failed(error: BaseException) -> None:
            if opened:
                self._not_followed(opened, error)
            if not poses:
                return
            if not isinstance(error, errors.Refused):
                self._report(f"the map cannot follow {wording.few(poses)} yet: {error}")
                return
            told = "its new pose" if len(poses) == 1 else "their new poses"
            were = "was" if len(poses) == 1 else "were"
            self._report(f"{wording.few(poses)} {were} put back, because the map rejected {told}: {error}")
            for name in poses:
                entity = self._door.map.entities.get(name)
                if entity is not None and entity.pose is not None:
                    commit = entity.pose_provenance.commit
                    self._put_back[name] = Placement(name=name, pose=entity.pose, commit=commit)

        joints = {opened: self.scene.bodies[opened].joints} if opened else {}
        settled = Settled.of(self._door.map.entities, poses, joints)
        self._change_about(settled.names, settled, failed)

    def _follow_joints(self, names: Sequence[str]) -> None:
        """Let the map take over how joints stand; if the map refuses, they have to go back."""
        for name in names:
            if self._may_follow_joints(name):
                self._follow((), name)

    def _not_followed(self, name: str, error: BaseException) -> None:
        if isinstance(error, errors.BadRequest):  # a TBox without these properties
            self._unsaid.add(name)
            log.warning("the map does not say how %s stands: %s", name, error)
        elif not isinstance(error, errors.Refused):
            self._report(f"the map cannot take over how {name} stands yet: {error}")
        elif (entity := self._door.map.entities.get(name)) is not None:
            self._report(f"{name} was put back as it stood, because the map rejected how it stands: {error}")
            self._shut_again[name] = joint_order(entity, self.scene.bodies[name])

    def _follow_grips(self, names: Sequence[str]) -> None:
        """Let the map take over who holds bodies, and where they were taken or put."""
        entities = self._door.map.entities
        for name in names:
            body = self.scene.bodies[name]
            if name in self._following or name in self._unsaid or name in self._regrip:
                continue
            if body.held_by and body.held_by not in entities:
                continue  # what holds it is no entity yet
            told = (
                f"was taken by {body.held_by}"
                if body.held_by
                else f"was let go by {holder_of(entities[name])}"
            )
            settled = Settled.of(
                entities,
                {name: rounded(body.pose)},
                reason=f"{name} {told} in the scene",
                grips={name: (body.held_by, body.grip)},
            )
            self._change_about((name,), settled, partial(self._grip_not_followed, name))

    def _grip_not_followed(self, name: str, error: BaseException) -> None:
        if isinstance(error, errors.BadRequest):  # a TBox without these properties
            self._unsaid.add(name)
            log.warning("the map does not say what holds %s: %s", name, error)
        elif not isinstance(error, errors.Refused):
            self._report(f"the map cannot take over what holds {name} yet: {error}")
        elif (entity := self._door.map.entities.get(name)) is not None:
            self._report(f"{name} is held as before, because the map rejected what holds it: {error}")
            self._regrip[name] = grip_order(entity)

    def _adopt(self, body: Body) -> None:
        """Let a body of the scene become an entity."""
        name = body.name
        if name in self._foreign or name in self._following or not body.resting:
            return
        whole = self._whole_of(body)
        if whole in self.scene.bodies and whole not in self._door.map.entities:
            return  # what it is part of comes first
        if body.robot and not self._rests_whole(name):
            return
        joints = () if name in self._unsaid else self._assignments(body)

        def adopted(error: BaseException) -> None:
            if joints and isinstance(error, errors.BadRequest):  # a TBox without these properties
                self._unsaid.add(name)
            elif isinstance(error, (errors.Refused, errors.BadRequest)):
                self._foreign[name] = f"a scene body without a map entity: {error}"
                log.warning("%s did not become an entity: %s", name, error)
            else:
                self._report(f"{name} cannot become an entity yet: {error}")

        if body.class_ is None:
            adopted(
                errors.UnknownClass(
                    'unknown class; name it like chair_3, or add <text name="semmap:BODY" data="CLASS"/>'
                )
            )
            return
        pose = rounded(body.pose)
        x, y, z = pose.position_m
        add = Add(
            source="scene",
            reason=f"{name} stands in the scene",
            class_=body.class_,
            name=name,
            at=(x, y, z),
            orientation=pose.orientation_wxyz,
            size=body.size_m,
            track="sim" if body.robot else None,
            set=(*((f"{_PART_OF}={whole}",) if whole else ()), *joints),
        )
        self._change_about((name,), add, adopted)

    def _rests_whole(self, name: str) -> bool:
        """Return whether a robot and all its parts rest, or have not come to rest for long enough."""
        whole, party = self._robot_of(name)
        if all(self.scene.bodies[part].resting for part in party):
            self._waits.end(whole)
            return True
        return not self._waits.must_wait(whole, (name,), self.scene.sim_time_s)

    def _assignments(self, body: Body) -> tuple[str, ...]:
        """Return how the joints of a robot stand, as assignments, if they are not as its model has them.

        Its arm sinks under its own weight when the simulation begins. In the commit that adds the robot, this
        needs no commit of its own, which would come before or after those that add the parts.
        """
        if not (body.robot and joints_differ_from_model(body, self._config.thresholds)):
            return ()
        return tuple(f"{said.property}={said.values[0]}" for said in statements(body.joints))

    def _whole_of(self, body: Body) -> str:
        """The nearest body that it is part of and that is an entity or may become one; "" for none."""
        whole = body.part_of
        while whole in self._foreign and whole in self.scene.bodies:
            whole = self.scene.bodies[whole].part_of
        return whole

    def _change_about(
        self, names: Collection[str], change: Add | Settled, failed: Callable[[BaseException], None]
    ) -> None:
        """Change the map in its turn; what concerns these bodies is looked at again when that is done."""
        self._following.update(names)

        def on_done(done: Future[Changed]) -> None:
            self._following.difference_update(names)
            self._later.update(names)
            if (error := done.exception()) is not None:
                failed(error)

        self._change(change).add_done_callback(on_done)


def ghostly(body: Body) -> str:
    """What is said of a ghost."""
    return f"overlaps {body.in_the_way or 'another body'}, so it does not collide until there is room"


def _only(names: Collection[str], of: Mapping[str, T]) -> dict[str, T]:
    return {name: of[name] for name in names if name in of}


def _due(wanted: Actions) -> tuple[str, ...]:
    """The bodies that the map would follow now."""
    return (*(placement.name for placement in wanted.follow), *wanted.opened)
