"""Attaching and detaching: changes of the map that the scene follows, and of the scene where that owns it."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future

from nodes.coordinator import holding
from nodes.coordinator.config import Truth
from nodes.coordinator.door import Door
from nodes.coordinator.scene.reconciler import AskSim
from nodes.coordinator.scene.scene_view import SceneView
from nodes.runtime.futures import OwnFuture, settle
from schemas import commands as c
from schemas import errors
from schemas.replies import Changed
from schemas.scenes import Grip, GripOrder, Gripped


class Gripping:
    """Executes `attach` and `detach`; the coordinator's thread owns it."""

    def __init__(
        self,
        truth: Truth,
        door: Door,
        scene: SceneView,
        change: Callable[[c.Attach | c.Detach], Future[Changed]],
        ask: AskSim,
    ) -> None:
        """`change` changes the map in its turn, and `ask` asks the simulator; neither waits."""
        self._truth = truth
        self._door = door
        self._scene = scene
        self._change = change
        self._ask = ask

    def attach(self, command: c.Attach) -> Future[Changed]:
        """Have an entity held. Raises Refused where it cannot be."""
        view = self._door.map
        entity, holder = view.entity(command.name), view.entity(holding.named(command.to, view.entities))
        holding.require_graspable(entity, holder, view.entities, view.bodies())
        bodies = view.bodies()
        grip = None
        if command.at is not None or command.yaw is not None:
            is_, by = (bodies[n].pose if n in bodies else view.where(n) for n in (entity.name, holder.name))
            grip = holding.grip(is_, by, command.at, command.yaw)
        return self._by_hand(command, GripOrder(name=entity.name, holder=holder.name, grip=grip))

    def detach(self, command: c.Detach) -> Future[Changed]:
        """Let go of what something holds."""
        return self._by_hand(command, GripOrder(name=self._door.map.entity(command.name).name))

    def _by_hand(self, command: c.Attach | c.Detach, order: GripOrder) -> Future[Changed]:
        """First in the scene, if that does not follow the map, and then in the map."""
        if self._truth == "replayed":
            raise errors.Refused(
                "this scene is a replay of the past, and nothing in it can be taken or let go"
            )
        concerned = {order.name, order.holder or order.name}
        if command.dry_run or self._truth == "map" or not concerned <= self._scene.bodies.keys():
            return self._change(command)

        def gripped(reply: Gripped) -> Future[Changed]:
            if order.name in reply.failed:
                raise errors.Refused(reply.failed[order.name])
            self._scene.add(reply.bodies)
            return self._change(command)

        future: Future[Changed] = OwnFuture()
        asked = self._ask(Grip(orders=(order,)))
        asked.add_done_callback(lambda done: settle(future, lambda: gripped(done.result())))
        return future
