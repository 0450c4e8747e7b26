"""Attach and detach: changes of the map that the scene follows, or of the scene if that is the truth."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Future

from semmap.nodes.coordinator.commands import attachment_rules
from semmap.nodes.coordinator.commands.dispatcher import CommandDispatcher
from semmap.nodes.coordinator.commands.plausibility import require_carry
from semmap.nodes.coordinator.config import Truth
from semmap.nodes.coordinator.reconciler.reconciler import AskSim
from semmap.nodes.coordinator.scene.scene_view import SceneView
from semmap.nodes.runtime.futures import and_then
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.bridge import LoadOf
from semmap.schemas.replies import Changed
from semmap.schemas.scenes import Grip, GripOrder, Gripped


class AttachCommands:
    """Executes `attach` and `detach`. Owned by the coordinator's thread."""

    def __init__(
        self,
        truth: Truth,
        dispatcher: CommandDispatcher,
        scene: SceneView,
        change: Callable[[c.Attach | c.Detach], Future[Changed]],
        ask: AskSim,
        ask_map: AskSim,
    ) -> None:
        """`change` changes the map, `ask` calls the simulator, and `ask_map` the knowledge base.

        None of them waits.
        """
        self._truth = truth
        self._dispatcher = dispatcher
        self._scene = scene
        self._change = change
        self._ask = ask
        self._ask_map = ask_map

    def attach(self, command: c.Attach) -> Future[Changed]:
        """Attach an entity. Raises Refused if that is not possible."""
        require_carry(command)
        view = self._dispatcher.map
        entity, holder = (
            view.entity(command.name),
            view.entity(attachment_rules.resolve_name(command.to, view.entities)),
        )
        bodies = view.bodies()
        attachment_rules.require_attachable(entity, holder, view.entities, bodies)
        if command.at is None and not command.force:
            attachment_rules.require_in_reach(entity, holder, view.pose_of, bodies)
        grip = None
        if command.at is not None or command.yaw is not None:
            is_, by = (bodies[n].pose if n in bodies else view.pose_of(n) for n in (entity.name, holder.name))
            grip = attachment_rules.compute_grip(is_, by, command.at, command.yaw)
        order = GripOrder(name=entity.name, holder=holder.name, grip=grip)
        if not command.carry or not self._must_change_scene_first(command, (entity.name, holder.name)):
            return self._attach_in_scene(command, (order,))

        def with_load(supported: Sequence[str]) -> Future[Changed]:
            load = attachment_rules.find_load(supported, entity, holder, view.entities, bodies)
            along = [GripOrder(name=name, holder=entity.name) for name in load if name in bodies]
            return self._attach_in_scene(command, (*along, order))

        return and_then(self._ask_map(LoadOf(name=entity.name, leave=command.leave)), with_load)

    def detach(self, command: c.Detach) -> Future[Changed]:
        """Detach an entity, and what was attached together with it."""
        view = self._dispatcher.map
        entity = view.entity(command.name)
        along = attachment_rules.find_attached_with(entity, view.held)
        return self._attach_in_scene(command, tuple(GripOrder(name=name) for name in (entity.name, *along)))

    def _must_change_scene_first(self, command: c.Attach | c.Detach, concerned: Iterable[str]) -> bool:
        """Return whether the scene is changed first, because the map follows it."""
        return not command.dry_run and self._truth != "map" and self._scene.bodies.keys() >= set(concerned)

    def _attach_in_scene(
        self, command: c.Attach | c.Detach, orders: tuple[GripOrder, ...]
    ) -> Future[Changed]:
        """Change the scene first if it does not follow the map, then the map."""
        if self._truth == "replayed":
            raise errors.Refused(
                "this scene is a replay of the past; nothing in it can be attached or detached"
            )
        concerned = {name for order in orders for name in (order.name, order.holder or order.name)}
        if not self._must_change_scene_first(command, concerned):
            return self._change(command)

        def gripped(reply: Gripped) -> Future[Changed]:
            for why in reply.failed.values():
                raise errors.Refused(why)
            self._scene.add(reply.bodies)
            return self._change(command)

        return and_then(self._ask(Grip(orders=orders)), gripped)
