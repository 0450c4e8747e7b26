"""Commands that open and close: they move joints, and replies may wait until the joints rest."""

from __future__ import annotations

from concurrent.futures import Future

from semmap.nodes.coordinator.commands.dispatcher import CommandDispatcher
from semmap.nodes.coordinator.commands.joint_state import explain_endless_joint
from semmap.nodes.coordinator.reconciler.reconciler import AskSim, Reconciler
from semmap.nodes.coordinator.scene.completion import Completion
from semmap.nodes.runtime.futures import and_then
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.joints import Joint, in_words
from semmap.schemas.replies import Moved
from semmap.schemas.scenes import Body, JointOrder, JointsMoving, MoveJoints

_THERE = 0.02
"""Fraction of the range: a joint this close to its target has arrived."""


class JointCommands:
    """Executes `open` and `close`. Owned by the coordinator's thread."""

    def __init__(
        self, dispatcher: CommandDispatcher, reconciler: Reconciler, completion: Completion, ask: AskSim
    ) -> None:
        """`ask(call)` sends a request to the simulator and does not wait."""
        self._dispatcher = dispatcher
        self._reconciler = reconciler
        self._completion = completion
        self._ask = ask

    def move(self, command: c.Open | c.Close) -> Future[Moved]:
        """Move the joints of a body. Raises Refused if it has none; NoAnswer without a simulator."""
        body = self._reconciler.scene.bodies.get(command.name)
        if body is None:
            entity = self._dispatcher.map.entity(command.name)
            state = self._reconciler.body_state(entity)
            if not self._reconciler.scene.known:
                raise errors.NoAnswer(
                    f"no simulator is running; to change only the map: semmap set {entity.name} isOpen"
                    f" {_is_open(command)}"
                )
            if state.status == "pending":
                return self._reconciler.when_placed(entity.name, lambda: self.move(command))
            raise errors.Refused(
                f"{entity.name} has no body to {command.VERB}: {state.detail or state.status}"
            )
        _require_joints(command, body)
        named = (joint.name for joint in body.joints if joint.switches and joint.name == command.joint)
        switch = next(named, "")
        order = JointOrder(name=command.name, joint=command.joint or "", openness=_share(command))

        def moving(reply: JointsMoving) -> Moved | Future[Moved]:
            if command.name in reply.failed:
                raise errors.Refused(reply.failed[command.name])
            self._reconciler.scene.add(reply.bodies)
            self._dispatcher.manual_moves.register(
                command, reason=f"{switch} of {body.name} was turned by hand" if switch else ""
            )
            immediate = Moved(name=command.name, text=_on_its_way(command, switch))
            return self._completion.begin(command, immediate, lambda rests: _arrived(command, rests), reply)

        def execute() -> Future[Moved]:
            return and_then(self._ask(MoveJoints(orders=(order,))), moving)

        return self._reconciler.when_placed(command.name, execute)


def _share(command: c.Open | c.Close) -> float:
    return command.to if isinstance(command, c.Open) else 0.0


def _is_open(command: c.Open | c.Close) -> str:
    return str(isinstance(command, c.Open)).lower()


def _moves(command: c.Open | c.Close, joint: Joint) -> bool:
    """Return whether a command moves this joint; switches are moved only by name."""
    return joint.name == command.joint if command.joint else joint.opens


def _require_joints(command: c.Open | c.Close, body: Body) -> None:
    """Raise Refused if no joint opens anything."""
    opening = [joint.name for joint in body.joints if joint.opens]
    switches = [joint.name for joint in body.joints if joint.switches]
    if not opening and command.joint not in switches:
        why = explain_endless_joint(body.joints)
        if switches:  # by its joint: the map alone does not change it if the scene is the source of truth
            why = f"; to switch it: semmap {command.VERB} {body.name} --joint {switches[0]}"
        raise errors.Refused(f"{body.name} has no door, lid or drawer to {command.VERB}{why}")
    if command.joint and command.joint not in (*opening, *switches):
        there = [*opening, *switches]
        hint = errors.did_you_mean(command.joint, there) or f"; it has: {', '.join(there)}"
        raise errors.Refused(f"{body.name} has no joint '{command.joint}' to {command.VERB}{hint}")


def _on_its_way(command: c.Open | c.Close, switch: str) -> str:
    if switch:
        return f"turning {switch} of {command.name} to {_share(command):.0%}"
    if isinstance(command, c.Close):
        return f"closing {command.name}"
    return f"opening {command.name}{'' if command.to == 1.0 else f' to {command.to:.0%}'}"


def _arrived(command: c.Open | c.Close, body: Body) -> str:
    """Return the positions of the moved joints, and which of them did not reach their target."""
    moved = [joint for joint in body.joints if _moves(command, joint)]
    text = f"{body.name}: {', '.join(map(in_words, moved))}"
    short = [joint.name for joint in moved if abs((joint.share or 0.0) - _share(command)) > _THERE]
    return f"{text}; something stops {' and '.join(short)}" if short else text
