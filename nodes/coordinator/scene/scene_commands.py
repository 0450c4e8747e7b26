"""Commands to the scene: move, pause, step, reset, picture."""

from __future__ import annotations

from concurrent.futures import Future
from typing import TypeVar

from nodes.coordinator.config import Truth
from nodes.coordinator.door import Door
from nodes.coordinator.scene.reconciler import GHOSTLY, AskSim, Keeping
from nodes.runtime.futures import then
from schemas import commands as c
from schemas import errors, wording
from schemas.calls import Call
from schemas.entities import Pose, orientation_from_yaw
from schemas.replies import Done, Moved
from schemas.scenes import BodiesMoved, Body, MoveBodies, Picture, PictureQuery, Placement

R = TypeVar("R")

_LIFTED_M = 0.02


class Running:
    """Passes them on to the simulator. Raises NoAnswer when none runs."""

    def __init__(self, truth: Truth, door: Door, keeping: Keeping, ask: AskSim) -> None:
        """`ask(call)` asks the simulator, without waiting."""
        self._truth = truth
        self._door = door
        self._keeping = keeping
        self._ask = ask

    def move(self, command: c.Move) -> Future[Moved]:
        """Take a body and put it elsewhere, as a hand would."""
        body = self._keeping.scene.bodies.get(command.name)
        if body is None:
            state = self._keeping.body_state(self._door.map.entity(command.name))
            raise errors.Refused(f"{command.name} has no body to move: {state.detail or state.status}")
        orientation = body.pose.orientation_wxyz if command.yaw is None else orientation_from_yaw(command.yaw)
        pose = Pose(position_m=command.at, orientation_wxyz=orientation)
        order = MoveBodies(placements=(Placement(name=command.name, pose=pose),))

        def moved(reply: BodiesMoved) -> Moved:
            if command.name in reply.failed:
                raise errors.Refused(reply.failed[command.name])
            self._door.hands.let_go(command)
            return Moved(name=command.name, text=_let_go(command, reply.bodies[0]))

        return then(self._ask(order), moved)

    def pause(self, command: c.Pause) -> Future[Done]:
        """Stop or start time."""
        return self._ask_scene(command)

    def step(self, command: c.StepOnce) -> Future[Done]:
        """Let a little time pass."""
        return self._ask_scene(command)

    def reset(self, command: c.Reset) -> Future[Done]:
        """Put every body back to where the map says, or, when the map only perceives, to where it began."""
        if self._truth == "perceived":
            return self._ask_scene(command)
        return then(
            self._keeping.place_all(),
            lambda reply: Done(text=f"put back where the map says: {wording.bodies(len(reply.bodies))}"),
        )

    def picture(self, command: c.TakePicture) -> Future[Picture]:
        """What a camera sees."""
        query = PictureQuery(camera=command.camera or "", width=command.width, height=command.height)
        return self._ask_scene(query)

    def _ask_scene(self, call: Call[R]) -> Future[R]:
        if not self._keeping.scene.known:
            raise errors.NoAnswer("no simulator is running")
        return self._ask(call)


def _let_go(command: c.Move, body: Body) -> str:
    """Where the hand let go: where it was told to, or above, where there is room."""
    (x, y, z), room_z_m = command.at, body.pose.position_m[2]
    if body.ghost:
        return f"put {body.name} at ({x:g}, {y:g}, {z:g}), where it {GHOSTLY}"
    if room_z_m - z > _LIFTED_M:
        return (
            f"put {body.name} at ({x:g}, {y:g}, {room_z_m:.2f}), the lowest free place there, and released it"
        )
    return f"put {body.name} at ({x:g}, {y:g}, {z:g}) and released it"
