"""Attach and detach change the map, or first the scene if the map follows it."""

from __future__ import annotations

from concurrent.futures import Future
from types import SimpleNamespace

import pytest
from msgspec import structs

from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.scene.attach_commands import AttachCommands
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.bridge import LoadOf
from semmap.schemas.entities import Pose
from semmap.schemas.scenes import Grip, GripOrder, Gripped
from tests.coordinator.commands.test_attachment_rules import thing
from tests.coordinator.reconciler.test_reconcile import at, body, provenance

GRIPPED = structs.replace(body("cup1", at(1.0, 2.0)), held_by="hand1")


class World:
    """A cup with a sugar lump in it beside a hand: what is requested of the scene and of the map."""

    def __init__(self, truth="scene", entities=(), *, bodies=("cup1", "hand1", "sugar1"), failed=None):
        view = MapView()
        view.entities = {one.name: one for one in (thing("cup1"), thing("hand1"), thing("sugar1"), *entities)}
        view.held = {name: one for name, one in view.entities.items() if one.grip_provenance is not None}
        self.bodies = {name: body(name, at(1.0, 2.0)) for name in bodies}
        view.bodies = lambda: self.bodies
        self.requests, self.added = [], []
        reply = Gripped(bodies=(GRIPPED,), failed=failed or {})
        self.commands = AttachCommands(
            truth,
            SimpleNamespace(map=view),
            SimpleNamespace(bodies=self.bodies, add=self.added.extend),
            lambda command: self._asked(command, "committed"),
            lambda call: self._asked(call, reply),
            lambda call: self._asked(call, ("sugar1",)),
        )

    def _asked(self, request, reply) -> Future:
        self.requests.append(request)
        future: Future = Future()
        future.set_result(reply)
        return future


ATTACH = c.Attach(name="cup1", to="hand1")


@pytest.mark.parametrize("truth", ["scene", "shared"])
def test_a_scene_that_the_map_follows_is_changed_first(truth):
    world = World(truth)
    assert world.commands.attach(ATTACH).result() == "committed"
    assert world.requests == [Grip(orders=(GripOrder(name="cup1", holder="hand1"),)), ATTACH]
    assert world.added == [GRIPPED]


@pytest.mark.parametrize(
    ("truth", "command", "bodies"),
    [
        ("map", ATTACH, ("cup1", "hand1")),
        ("scene", structs.replace(ATTACH, dry_run=True), ("cup1", "hand1")),
        ("scene", ATTACH, ("cup1",)),
        ("scene", structs.replace(ATTACH, carry=True), ("hand1",)),
    ],
    ids=["the scene follows the map", "dry run", "holder without body", "cup without body"],
)
def test_otherwise_only_the_map_is_changed(truth, command, bodies):
    world = World(truth, bodies=bodies)
    assert world.commands.attach(command).result() == "committed"
    assert world.requests == [command]


def test_contents_are_attached_to_the_entity_before_it_is():
    world = World()
    command = structs.replace(ATTACH, carry=True, leave=("spoon1",))
    world.commands.attach(command).result()
    orders = (GripOrder(name="sugar1", holder="cup1"), GripOrder(name="cup1", holder="hand1"))
    assert world.requests == [LoadOf(name="cup1", leave=("spoon1",)), Grip(orders=orders), command]


def test_contents_without_a_body_are_left_to_the_map():
    world = World(bodies=("cup1", "hand1"))
    world.commands.attach(structs.replace(ATTACH, carry=True)).result()
    assert world.requests[1] == Grip(orders=(GripOrder(name="cup1", holder="hand1"),))


def test_a_position_in_the_holder_s_frame_is_ordered():
    world = World()
    world.commands.attach(structs.replace(ATTACH, at=(0.0, 0.0, 0.3))).result()
    (order,) = world.requests[0].orders
    assert order.grip == Pose(position_m=(0.0, 0.0, 0.3))


def test_a_reason_of_the_simulator_leaves_the_map_as_it_is():
    world = World(failed={"cup1": "cup1 would overlap fridge1"})
    with pytest.raises(errors.Refused, match=r"^cup1 would overlap fridge1$"):
        world.commands.attach(ATTACH).result()
    assert len(world.requests) == 1
    assert world.added == []


@pytest.mark.parametrize("truth", ["scene", "map"])
def test_a_distant_entity_is_attached_only_by_force_or_at_a_position(truth):
    far = structs.replace(thing("hand1"), pose=at(5.0))
    world = World(truth, (far,), bodies=("cup1",))
    with pytest.raises(errors.Refused, match=r"farther than 0\.3 m"):
        world.commands.attach(ATTACH)
    world.commands.attach(structs.replace(ATTACH, force=True)).result()
    world.commands.attach(structs.replace(ATTACH, at=(0.0, 0.0, 0.0))).result()
    assert [type(request) for request in world.requests] == [c.Attach, c.Attach]


def test_a_replay_is_not_changed():
    world = World("replayed")
    with pytest.raises(errors.Refused, match="this scene is a replay of the past"):
        world.commands.attach(ATTACH)
    with pytest.raises(errors.Refused, match="this scene is a replay of the past"):
        world.commands.detach(c.Detach(name="cup1"))
    assert world.requests == []


def test_what_was_attached_together_is_detached_together():
    held = (
        thing("cup1", held_by="hand1", since=5),
        thing("sugar1", held_by="cup1", since=5),
        structs.replace(thing("lid1", held_by="cup1"), grip_provenance=provenance(4)),
    )
    world = World(entities=held)
    command = c.Detach(name="cup1")
    assert world.commands.detach(command).result() == "committed"
    assert world.requests == [Grip(orders=(GripOrder(name="cup1"), GripOrder(name="sugar1"))), command]
