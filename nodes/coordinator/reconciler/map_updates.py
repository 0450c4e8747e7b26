"""Changes of the map that follow the scene: poses, joint positions, attachments, sizes, and new entities.

If the map rejects a change, the scene is corrected instead (`Corrections`).
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection, Iterator, Sequence
from concurrent.futures import Future
from functools import partial
from typing import NamedTuple, Protocol

from semmap.nodes.coordinator.commands.dispatcher import CommandDispatcher
from semmap.nodes.coordinator.config import Thresholds
from semmap.nodes.coordinator.reconciler.contents import find_contents
from semmap.nodes.coordinator.reconciler.observed_state import ObservedState, joint_statements
from semmap.nodes.coordinator.reconciler.reconcile import (
    Actions,
    grip_order,
    joint_order,
    joints_differ_from_model,
)
from semmap.nodes.coordinator.reconciler.rest_waits import RestWaits
from semmap.nodes.coordinator.scene.scene_view import SceneView
from semmap.schemas import errors, wording
from semmap.schemas.attachments import holder_of
from semmap.schemas.commands import Add
from semmap.schemas.entities import rounded
from semmap.schemas.joints import is_on, openness
from semmap.schemas.replies import Changed
from semmap.schemas.scenes import Body, GripOrder, JointOrder, Placement

log = logging.getLogger(__name__)

_PART_OF = "isDirectPartOf"


class ChangeMap(Protocol):
    """`change(change)` schedules a change of the map and returns immediately."""

    def __call__(self, change: Add | ObservedState, /) -> Future[Changed]:  # noqa: D102
        ...


class Corrections(NamedTuple):
    """Orders that restore the committed state of bodies after the map has rejected their new state."""

    placements: tuple[Placement, ...]
    joints: tuple[JointOrder, ...]
    grips: tuple[GripOrder, ...]


class MapUpdater:
    """Commits what has changed in the scene. Owned by the coordinator's thread."""

    def __init__(
        self,
        dispatcher: CommandDispatcher,
        scene: SceneView,
        thresholds: Thresholds,
        wanted: Callable[[Collection[str]], Actions],
        change: ChangeMap,
        report: Callable[[str], None],
        revisit: set[str],
    ) -> None:
        """`wanted(names)` returns the remaining differences of these entities and bodies.

        The names of bodies that have to be compared again are added to `revisit`.
        """
        self._dispatcher = dispatcher
        self._scene = scene
        self._thresholds = thresholds
        self._wanted = wanted
        self._change = change
        self._report = report
        self._revisit = revisit
        self.rejected: dict[str, str] = {}
        """Scene bodies that cannot become entities, with the reason."""
        self.without_state: set[str] = set()
        """Bodies whose joints or attachments the map cannot store: its TBox has no property for them."""
        self._kept_sizes: set[str] = set()
        """Bodies whose new size the map has rejected."""
        self._in_flight: set[str] = set()
        """Bodies with a commit under way."""
        self._placements: dict[str, Placement] = {}
        self._joints: dict[str, JointOrder] = {}
        self._grips: dict[str, GripOrder] = {}
        self._waits = RestWaits()

    def update(self, actions: Actions) -> None:
        """Begin the changes of the map that `actions` asks for."""
        actions = self._follow_contents(self._follow_robots(actions))
        for group in self._groups(actions.follow):
            self._follow(group)
        for name in actions.opened:
            if self._may_follow_joints(name):
                self._follow((), name)
        self._follow_grips(actions.gripped)
        self._follow_sizes(actions.resized)
        for body in actions.adopt:
            self._adopt(body)

    def forget_waits(self) -> None:
        """Forget the waits for bodies that are gone or move again."""
        self._waits.forget_moving(self._scene.bodies)

    def take_corrections(self) -> Corrections:
        """Return the corrections that are due, and forget them."""
        due = Corrections(
            tuple(self._placements.values()), tuple(self._joints.values()), tuple(self._grips.values())
        )
        self._placements, self._joints, self._grips = {}, {}, {}
        return due

    def is_following(self, names: Collection[str]) -> bool:
        """Return whether a commit about one of these bodies is under way."""
        return not self._in_flight.isdisjoint(names)

    def suspend(self, names: Collection[str]) -> Callable[[], None]:
        """Commit nothing about these bodies until the returned function is called."""
        self._in_flight.update(names)

        def resume() -> None:
            self._in_flight.difference_update(names)
            self._revisit.update(names)

        return resume

    def whole_of(self, body: Body) -> str:
        """Return the nearest body that it is part of and that can be an entity, or "" if there is none."""
        whole = body.part_of
        while whole in self.rejected and whole in self._scene.bodies:
            whole = self._scene.bodies[whole].part_of
        return whole

    def _follow_robots(self, actions: Actions) -> Actions:
        """Follow a robot and its parts in one commit, once all of them rest; return the remaining actions.

        If the first part at rest were committed alone, the map would have an inconsistent robot until the
        others rest.
        """
        bodies = self._scene.bodies
        done: set[str] = set()
        for name in (*(placement.name for placement in actions.follow), *actions.opened):
            if name in done or not bodies[name].robot or self._dispatcher.manual_moves.group_of(name):
                continue
            whole, group = self._robot_of(name)
            done |= group
            if self.is_following(group):
                continue  # it is compared again when that commit is done
            wanted = self._wanted(group)
            if not all(bodies[part].resting for part in group) and self._waits.must_wait(
                whole, _names_due(wanted), self._scene.sim_time_s
            ):
                self._revisit.update(group)
                continue
            self._waits.end(whole)
            opened = next(filter(self._may_follow_joints, wanted.opened), "")  # the others come later
            if wanted.follow or opened:
                self._follow(wanted.follow, opened)
        return _without(actions, done)

    def _robot_of(self, name: str) -> tuple[str, set[str]]:
        """Return the robot that a body is or is part of, and the names of it and of all its parts."""
        bodies = self._scene.bodies

        def whole_of(part: str) -> str:
            while (above := bodies[part].part_of) in bodies:
                part = above
            return part

        whole = whole_of(name)
        return whole, {part for part, body in bodies.items() if body.robot and whole_of(part) == whole}

    def _follow_contents(self, actions: Actions) -> Actions:
        """Follow joints and the contents that they moved in one commit, once all of them rest.

        Returns the remaining actions.
        """
        bodies = self._scene.bodies
        follow = {
            placement.name: placement
            for placement in actions.follow
            if placement.name not in self._in_flight
            and not self._dispatcher.manual_moves.group_of(placement.name)
        }
        opened = [name for name in actions.opened if self._may_follow_joints(name)]
        moved_bodies = [bodies[name] for name in follow]
        around = (
            name
            for name, body in bodies.items()
            if moved_bodies and body.joints and name not in opened and find_contents(body, moved_bodies)
        )
        done: set[str] = set()
        for whole in (*opened, *around):
            contents = find_contents(bodies[whole], bodies.values())
            moved = [name for name in contents if name in follow and name not in done]
            group = [*([whole] if whole in opened else ()), *moved]
            moves = not all(bodies[name].resting for name in (whole, *contents))
            if not group or not (moves or len(group) > 1):
                self._waits.end(whole)
                continue
            done.update(group)
            if moves and self._waits.must_wait(whole, group, self._scene.sim_time_s):
                self._revisit.update(group)
                continue
            self._waits.end(whole)
            self._follow([follow[name] for name in moved], whole if whole in opened else "")
        return _without(actions, done)

    def _may_follow_joints(self, name: str) -> bool:
        return not (name in self._in_flight or name in self.without_state or name in self._joints)

    def _groups(self, placements: Sequence[Placement]) -> Iterator[tuple[Placement, ...]]:
        """Yield the placements to commit together: bodies that were carried together, once all rest."""
        done: set[str] = set()
        for placement in placements:
            if placement.name in done or placement.name in self._in_flight:
                continue
            group = self._dispatcher.manual_moves.group_of(placement.name)
            done |= group
            if not group:
                yield (placement,)
            elif all(self._scene.bodies[name].resting for name in group if name in self._scene.bodies):
                yield self._wanted(sorted(group)).follow

    def _follow(self, placements: Sequence[Placement], opened: str = "") -> None:
        """Commit new poses, and the joints of the body `opened`; restore them if the map rejects that."""
        poses = {placement.name: rounded(placement.pose) for placement in placements}
        if any(name in self._placements for name in poses):
            return

        def failed(error: BaseException) -> None:
            if opened:
                self._joints_not_followed(opened, error)
            if not poses:
                return
            if not isinstance(error, errors.Refused):
                self._report(f"{wording.few(poses)}: the new pose is not committed yet: {error}")
                return
            new_pose = "its new pose" if len(poses) == 1 else "their new poses"
            were = "was" if len(poses) == 1 else "were"
            self._report(
                f"{wording.few(poses)} {were} put back, because the map rejected {new_pose}: {error}"
            )
            for name in poses:
                entity = self._dispatcher.map.entities.get(name)
                if entity is not None and entity.pose is not None:
                    commit = entity.pose_provenance.commit
                    self._placements[name] = Placement(name=name, pose=entity.pose, commit=commit)

        joints = {opened: self._scene.bodies[opened].joints} if opened else {}
        observed = ObservedState.of(self._dispatcher.map.entities, poses, joints)
        self._change_about(observed.names, observed, failed)

    def _joints_not_followed(self, name: str, error: BaseException) -> None:
        if isinstance(error, errors.BadRequest):  # a TBox without these properties
            self.without_state.add(name)
            log.warning("%s: joint positions are not stored: %s", name, error)
        elif not isinstance(error, errors.Refused):
            self._report(f"{name}: joint positions are not committed yet: {error}")
        elif (entity := self._dispatcher.map.entities.get(name)) is not None:
            self._report(f"the joints of {name} were moved back, because the map rejected them: {error}")
            self._joints[name] = joint_order(entity, self._scene.bodies[name])

    def _follow_grips(self, names: Sequence[str]) -> None:
        """Commit to what these bodies are attached, and where they were attached or detached."""
        entities = self._dispatcher.map.entities
        for name in names:
            body = self._scene.bodies[name]
            if name in self._in_flight or name in self.without_state or name in self._grips:
                continue
            if body.held_by and body.held_by not in entities:
                continue  # its holder is not an entity yet
            what = (
                f"was attached to {body.held_by}"
                if body.held_by
                else f"was detached from {holder_of(entities[name])}"
            )
            observed = ObservedState.of(
                entities,
                {name: rounded(body.pose)},
                reason=f"{name} {what} in the scene",
                grips={name: (body.held_by, body.grip)},
            )
            self._change_about((name,), observed, partial(self._grip_not_followed, name))

    def _follow_sizes(self, names: Sequence[str]) -> None:
        """Commit the sizes of bodies that the world file has changed."""
        for name in names:
            if name in self._in_flight or name in self._kept_sizes:
                continue
            observed = ObservedState.of(
                self._dispatcher.map.entities,
                {},
                reason=f"{name} has another size in the scene",
                sizes_m={name: self._scene.bodies[name].size_m},
            )
            self._change_about((name,), observed, partial(self._size_not_followed, name))

    def _size_not_followed(self, name: str, error: BaseException) -> None:
        if isinstance(error, (errors.Refused, errors.BadRequest)):
            self._kept_sizes.add(name)
        self._report(f"{name}: its new size is not committed: {error}")

    def _grip_not_followed(self, name: str, error: BaseException) -> None:
        if isinstance(error, errors.BadRequest):  # a TBox without these properties
            self.without_state.add(name)
            log.warning("%s: attachments are not stored: %s", name, error)
        elif not isinstance(error, errors.Refused):
            self._report(f"{name}: the attachment is not committed yet: {error}")
        elif (entity := self._dispatcher.map.entities.get(name)) is not None:
            self._report(f"the attachment of {name} was restored, because the map rejected the new: {error}")
            self._grips[name] = grip_order(entity)

    def _adopt(self, body: Body) -> None:
        """Add a scene body to the map as an entity, once it rests."""
        name = body.name
        if name in self.rejected or name in self._in_flight or not body.resting:
            return
        whole = self.whole_of(body)
        if whole in self._scene.bodies and whole not in self._dispatcher.map.entities:
            return  # the whole is added first
        if body.robot and not self._rests_with_parts(name):
            return
        joints = () if name in self.without_state else self._joint_assignments(body)

        def failed(error: BaseException) -> None:
            if joints and isinstance(error, errors.BadRequest):  # a TBox without these properties
                self.without_state.add(name)
            elif isinstance(error, (errors.Refused, errors.BadRequest)):
                self.rejected[name] = f"a scene body without a map entity: {error}"
                log.warning("%s did not become an entity: %s", name, error)
            else:
                self._report(f"{name} cannot become an entity yet: {error}")

        if body.class_ is None:
            failed(errors.UnknownClass("unknown class; name it like chair_3, or start with --class-map FILE"))
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
            ref=body.label or None,
            track="sim" if body.robot else None,
            set=(*((f"{_PART_OF}={whole}",) if whole else ()), *joints),
        )
        self._change_about((name,), add, failed)

    def _rests_with_parts(self, name: str) -> bool:
        """Return whether a robot and all its parts rest, or have been waited for long enough."""
        whole, group = self._robot_of(name)
        if all(self._scene.bodies[part].resting for part in group):
            self._waits.end(whole)
            return True
        return not self._waits.must_wait(whole, (name,), self._scene.sim_time_s)

    def _joint_assignments(self, body: Body) -> tuple[str, ...]:
        """Return the joint positions of a new entity as assignments.

        Those of a robot are stated if they differ from its model, because the arm sinks under its own weight
        when the simulation begins. Others are stated if they open or switch something, so that the contents
        of a closed cupboard are known to be hidden.
        """
        states_something = openness(body.joints) is not None or is_on(body.joints) is not None
        if not (joints_differ_from_model(body, self._thresholds) if body.robot else states_something):
            return ()
        return tuple(f"{one.property}={one.values[0]}" for one in joint_statements(body.joints))

    def _change_about(
        self, names: Collection[str], change: Add | ObservedState, failed: Callable[[BaseException], None]
    ) -> None:
        """Schedule a change of the map; the bodies `names` are compared again when it is done."""
        resume = self.suspend(names)

        def on_done(done: Future[Changed]) -> None:
            resume()
            if (error := done.exception()) is not None:
                failed(error)

        self._change(change).add_done_callback(on_done)


def _without(actions: Actions, done: Collection[str]) -> Actions:
    return actions._replace(
        follow=tuple(placement for placement in actions.follow if placement.name not in done),
        opened=tuple(name for name in actions.opened if name not in done),
    )


def _names_due(wanted: Actions) -> tuple[str, ...]:
    """Return the bodies that the map would follow now."""
    return (*(placement.name for placement in wanted.follow), *wanted.opened)
