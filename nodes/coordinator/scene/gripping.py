"""Attaching and detaching: changes of the map that the scene follows, and of the scene where that owns it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Future

from semmap.nodes.coordinator import holding
from semmap.nodes.coordinator.config import Truth
from semmap.nodes.coordinator.door import Door
from semmap.nodes.coordinator.plausibility import require_carrying
from semmap.nodes.coordinator.scene.reconciler import AskSim
from semmap.nodes.coordinator.scene.scene_view import SceneView
from semmap.nodes.runtime.futures import and_then
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.bridge import LoadOf
from semmap.schemas.replies import Changed
from semmap.schemas.scenes import Grip, GripOrder, Gripped


class Gripping:
    """Executes `attach` and `detach`; the coordinator's thread owns it."""

    def __init__(
        self,
        truth: Truth,
        door: Door,
        scene: SceneView,
        change: Callable[[c.Attach | c.Detach], Future[Changed]],
        ask: AskSim,
        ask_map: AskSim,
    ) -> None:
        """`change` changes the map in its turn, `ask` asks the simulator, and `ask_map` the knowledge base.

        None of them waits.
        """
        self._truth = truth
        self._door = door
        self._scene = scene
        self._change = change
        self._ask = ask
        self._ask_map = ask_map

    def attach(self, command: c.Attach) -> Future[Changed]:
        """Have an entity held. Raises Refused where it cannot be."""
        require_carrying(command)
        view = self._door.map
        entity, holder = view.entity(command.name), view.entity(holding.named(command.to, view.entities))
        bodies = view.bodies()
        holding.require_graspable(entity, holder, view.entities, bodies)
        grip = None
        if command.at is not None or command.yaw is not None:
            is_, by = (bodies[n].pose if n in bodies else view.where(n) for n in (entity.name, holder.name))
            grip = holding.grip(is_, by, command.at, command.yaw)
        order = GripOrder(name=entity.name, holder=holder.name, grip=grip)
        if not command.carry or not self._is_by_hand(command, (entity.name, holder.name)):
            return self._by_hand(command, (order,))

        def with_load(borne: Sequence[str]) -> Future[Changed]:
            load = holding.load(borne, entity, holder, view.entities, bodies)
            along = [GripOrder(name=name, holder=entity.name) for name in load if name in bodies]
            return self._by_hand(command, (*along, order))

        return and_then(self._ask_map(LoadOf(name=entity.name, leave=command.leave)), with_load)

    def detach(self, command: c.Detach) -> Future[Changed]:
        """Let go of what something holds, and of what was taken with it."""
        view = self._door.map
        entity = view.entity(command.name)
        along = holding.taken_with(entity, view.held)
        return self._by_hand(command, tuple(GripOrder(name=name) for name in (entity.name, *along)))

    def _is_by_hand(self, command: c.Attach | c.Detach, concerned: Iterable[str]) -> bool:
        """Whether it is done in the scene first, because the map follows that."""
        return not command.dry_run and self._truth != "map" and self._scene.bodies.keys() >= set(concerned)

    def _by_hand(self, command: c.Attach | c.Detach, orders: tuple[GripOrder, ...]) -> Future[Changed]:
        """First in the scene, if that does not follow the map, and then in the map."""
        if self._truth == "replayed":
            raise errors.Refused(
                "this scene is a replay of the past, and nothing in it can be taken or let go"
            )
        concerned = {name for order in orders for name in (order.name, order.holder or order.name)}
        if not self._is_by_hand(command, concerned):
            return self._change(command)

        def gripped(reply: Gripped) -> Future[Changed]:
            for why in reply.failed.values():
                raise errors.Refused(why)
            self._scene.add(reply.bodies)
            return self._change(command)

        return and_then(self._ask(Grip(orders=orders)), gripped)
