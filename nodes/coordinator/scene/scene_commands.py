"""Commands to the scene: move, drive, pause, step, reset, picture."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from typing import TypeVar

from msgspec import structs

from semmap.nodes.coordinator.commands.dispatcher import CommandDispatcher
from semmap.nodes.coordinator.commands.placement import at_room, make_request, placing_of
from semmap.nodes.coordinator.commands.plausibility import find_isolation, require_carry
from semmap.nodes.coordinator.config import Truth
from semmap.nodes.coordinator.reconciler.reconciler import AskSim, Reconciler
from semmap.nodes.coordinator.reconciler.scene_report import describe_ghost
from semmap.nodes.coordinator.scene.completion import Completion
from semmap.nodes.runtime.futures import SingleThreadFuture, and_then, settle, then
from semmap.schemas import commands as c
from semmap.schemas import errors, wording
from semmap.schemas.bridge import LoadOf, Room
from semmap.schemas.calls import Call
from semmap.schemas.entities import Pose, Vector, carried, orientation_from_yaw
from semmap.schemas.replies import Changed, Done, Moved
from semmap.schemas.scenes import (
    BodiesMoved,
    Body,
    DriveBase,
    Driven,
    MoveBodies,
    Picture,
    PictureQuery,
    Placement,
)

R = TypeVar("R")

_LIFTED_M = 0.02


class SceneCommands:
    """Forwards commands to the simulator. Raises NoAnswer if none is running."""

    def __init__(
        self,
        truth: Truth,
        dispatcher: CommandDispatcher,
        reconciler: Reconciler,
        completion: Completion,
        ask: AskSim,
        ask_map: AskSim,
    ) -> None:
        """`ask(call)` calls the simulator, `ask_map(call)` the knowledge base. Neither waits."""
        self._truth = truth
        self._dispatcher = dispatcher
        self._reconciler = reconciler
        self._completion = completion
        self._ask = ask
        self._ask_map = ask_map

    def move(self, command: c.Move) -> Future[Moved]:
        """Move a body manually, with its contents if wanted."""
        require_carry(command)
        if self._truth == "replayed":
            raise errors.Refused("this scene is a replay of the past; nothing in it can be moved")
        if command.name not in self._reconciler.scene.bodies:
            state = self._reconciler.body_state(self._dispatcher.map.entity(command.name))
            if state.status != "pending":
                raise errors.Refused(f"{command.name} has no body to move: {state.detail or state.status}")
        wanted = placing_of(command)
        if wanted is None:
            if command.at is None:
                raise errors.BadRequest("missing position; give one of --at X Y Z, --on, --in and --next-to")
            return self._move_at(command, Pose(position_m=command.at))
        request = make_request(self._dispatcher.map, command, wanted, command.name, None)
        return and_then(self._ask_map(request), lambda room: self._move_to(command, room))

    def _move_at(self, command: c.Move, pose: Pose) -> Future[Moved]:
        """Move a body to a pose of the command; a note tells if it is far away from all other bodies."""
        others = (body.pose for name, body in self._reconciler.scene.bodies.items() if name != command.name)
        doubts = find_isolation(command.name, pose, others)
        placed = self._reconciler.when_placed(command.name, lambda: self._move_body(command))
        if not doubts:
            return placed
        return then(placed, lambda moved: structs.replace(moved, notes=(*moved.notes, *doubts)))

    def _move_to(self, command: c.Move, room: Room) -> Future[Moved]:
        """Move a body to the free pose that was found."""
        placed = self._reconciler.when_placed(command.name, lambda: self._move_body(at_room(command, room)))
        if not room.note:
            return placed
        return then(placed, lambda moved: structs.replace(moved, notes=(room.note, *moved.notes)))

    def _move_body(self, command: c.Move) -> Future[Moved]:
        body = self._reconciler.scene.bodies.get(command.name)
        if body is None:
            entity = self._dispatcher.map.entities.get(command.name)
            state = None if entity is None else self._reconciler.body_state(entity)
            reason = "it was removed" if state is None else state.detail or state.status
            raise errors.Refused(f"{command.name} has no body to move: {reason}")
        if not command.carry:
            return self._place(command, body, ())
        future: Future[Moved] = SingleThreadFuture()
        asked = self._ask_map(LoadOf(name=command.name, leave=command.leave))
        asked.add_done_callback(
            lambda done: settle(future, lambda: self._place(command, body, done.result()))
        )
        return future

    def _place(self, command: c.Move, body: Body, load: Sequence[str]) -> Future[Moved]:
        orientation = body.pose.orientation_wxyz if command.yaw is None else orientation_from_yaw(command.yaw)
        if command.at is None:
            raise errors.InternalError("a body was to be moved without a position")
        pose = Pose(position_m=command.at, orientation_wxyz=orientation)
        bodies = self._reconciler.scene.bodies
        along = {name: carried(bodies[name].pose, body.pose, pose) for name in load if name in bodies}
        order = MoveBodies(
            placements=tuple(Placement(name=n, pose=p) for n, p in {command.name: pose, **along}.items())
        )

        def moved(reply: BodiesMoved) -> Moved | Future[Moved]:
            if command.name in reply.failed:
                raise errors.Refused(reply.failed[command.name])
            self._reconciler.scene.add(reply.bodies)
            carried_along = [name for name in along if name not in reply.failed]
            self._dispatcher.manual_moves.register(command, carried_along)
            load = f"; {wording.carried(command.name, tuple(along), command.leave)}" if command.carry else ""
            text = _describe_release(command.name, pose.position_m, reply.bodies[0])
            immediate = Moved(name=command.name, text=text + load)
            return self._completion.begin(
                command, immediate, lambda rests: _describe_rest(rests) + load, reply, carried_along
            )

        return and_then(self._ask(order), moved)

    def drive(self, command: c.Drive) -> Future[Moved]:
        """Drive a robot's base. Raises Refused if it cannot drive or is blocked."""
        if bool(command.to) is command.stop:
            raise errors.BadRequest("missing target; use --to X Y, or --stop")
        if command.name not in self._reconciler.scene.bodies and self._reconciler.scene.known:
            state = self._reconciler.body_state(self._dispatcher.map.entity(command.name))
            raise errors.Refused(f"{command.name} has no body to drive: {state.detail or state.status}")
        order = DriveBase(
            name=command.name, to=command.to, yaw=command.yaw, speed=command.speed, wait=command.wait
        )
        if not command.to:
            return self._drive(command, order)
        begin = self._drive_there if command.wait else self._drive
        return self._reconciler.when_placed(command.name, lambda: begin(command, order))

    def _drive(self, command: c.Drive, order: DriveBase) -> Future[Moved]:
        """Reply when the drive has begun, or when the robot has stopped."""

        def driven(reply: Driven) -> Moved | Future[Moved]:
            self._dispatcher.manual_moves.register(command)
            text = _describe_drive(reply)
            return self._completion.begin(command, Moved(name=command.name, text=text), lambda _: text, reply)

        return and_then(self._ask_scene(order), driven)

    def _drive_there(self, command: c.Drive, order: DriveBase) -> Future[Moved]:
        """Reply when the drive has ended and the map has followed."""
        asked = self._ask_scene(order)
        self._dispatcher.manual_moves.register(command)
        immediate = Moved(name=command.name, text=f"{command.name} is on its way")
        future: Future[Moved] = SingleThreadFuture()
        settle(future, lambda: self._completion.begin(command, immediate, lambda _: immediate.text, None))

        def ended(done: Future[Driven]) -> None:
            try:
                driven = done.result()
            except errors.SemmapError as error:
                self._completion.fail(command, error)
                return
            try:
                text = _describe_drive(driven)
            except errors.Refused as error:
                self._completion.fail(command, error, driven)
            else:
                self._completion.arrive(command, text, driven)

        asked.add_done_callback(ended)
        return future

    def halt(self, name: str) -> Future[Pose]:
        """End a robot's course; where it is then."""
        return then(self._ask_scene(DriveBase(name=name)), lambda driven: driven.pose)

    def undo(self, command: c.Undo, change: Callable[[c.Undo], Future[Changed]]) -> Future[Changed]:
        """Stop what is under way, or undo a commit by `change(command)`."""
        stopped = self._completion.stop(command, self.halt)
        return change(command) if stopped is None else stopped

    def pause(self, command: c.Pause) -> Future[Done]:
        """Pause or resume simulated time."""

        def paused(done: Done) -> Done:
            if command.off:
                self._completion.resume()
            else:
                self._completion.pause()
            return done

        return then(self._ask_scene(command), paused)

    def step(self, command: c.StepOnce) -> Future[Done]:
        """Advance simulated time by one step."""
        return self._ask_scene(command)

    def reset(self, command: c.Reset) -> Future[Done]:
        """Put every body back to its committed pose or, with `perceived`, to its initial pose."""
        if self._truth == "perceived":
            return self._ask_scene(command)
        return then(
            self._reconciler.place_all(),
            lambda reply: Done(text=f"put back to committed poses: {wording.bodies(len(reply.bodies))}"),
        )

    def render(self, command: c.TakePicture) -> Future[Picture]:
        """Render the image of a camera."""
        if command.camera and command.place:
            raise errors.BadRequest("give either a camera or a place")
        query = PictureQuery(
            camera=command.camera or "",
            box=self._box_of(command.place) if command.place else None,
            labels=command.labels,
            width=command.width,
            height=command.height,
        )
        return self._ask_scene(query)

    def _box_of(self, name: str) -> tuple[Vector, Vector]:
        """Return the lowest and highest corner of a place. Raises UnknownName, or Refused for an object."""
        entity = self._dispatcher.map.entity(name)
        if not entity.place or entity.pose is None or entity.size_m is None:
            raise errors.Refused(f"{entity.name} is not a place with a position and a size")
        (x, y, z), (width, depth, height) = entity.pose.position_m, entity.size_m
        turn = entity.pose.yaw_rad
        across = (abs(width * math.cos(turn)) + abs(depth * math.sin(turn))) / 2
        along = (abs(width * math.sin(turn)) + abs(depth * math.cos(turn))) / 2
        return (x - across, y - along, z), (x + across, y + along, z + height)

    def _ask_scene(self, call: Call[R]) -> Future[R]:
        if not self._reconciler.scene.known:
            raise errors.NoAnswer("no simulator is running")
        return self._ask(call)


def _describe_drive(driven: Driven) -> str:
    """Return the result of a drive. Raises Refused if it did not reach its target."""
    x, y, _ = driven.pose.position_m
    where = f"({x:.2f}, {y:.2f})"
    if driven.outcome == "blocked":
        raise errors.Refused(f"{driven.name} is blocked at {where} by an obstacle")
    if driven.outcome == "fallen":
        raise errors.Refused(f"{driven.name} {wording.fallen(driven.name, driven.pose)}")
    predicate = {"driving": "is on its way from", "there": "is at", "stopped": "stopped at"}[driven.outcome]
    return f"{driven.name} {predicate} {where}, facing {round(math.degrees(driven.pose.yaw_rad))}°"


def _describe_rest(body: Body) -> str:
    """Return where a body has come to rest."""
    where = "({:g}, {:g}, {:g})".format(*(round(c, 3) + 0.0 for c in body.pose.position_m))
    return f"moved {body.name} to {where}" + (f", where it {describe_ghost(body)}" if body.ghost else "")


def _describe_release(name: str, at: Vector, body: Body) -> str:
    """Return where a body was released: at the given position, or above it where there is room."""
    (x, y, z), room_z_m = at, body.pose.position_m[2]
    if body.ghost:
        return f"put {body.name} at ({x:g}, {y:g}, {z:g}), where it {describe_ghost(body)}"
    if room_z_m - z > _LIFTED_M:
        return (
            f"put {body.name} at ({x:g}, {y:g}, {room_z_m:.2f}), the lowest free place there, and released it"
        )
    return f"put {body.name} at ({x:g}, {y:g}, {z:g}) and released it"
