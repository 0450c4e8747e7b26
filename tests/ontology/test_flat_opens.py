"""Every door and drawer in the flat opens and closes completely, without moving other bodies."""

import math

import pytest

from semmap.nodes.coordinator.reconciler.reconcile import body_order
from semmap.nodes.kb_node.answers.entity_queries import CurrentState
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.sim_node.physics import base_scene
from semmap.nodes.sim_node.world import World
from semmap.ontology import FLAT_TTL, FLAT_WORLD
from semmap.schemas.bridge import Entities
from semmap.schemas.commits import Transaction
from semmap.schemas.scenes import JointOrder
from tests.kb_node import home

_PUSHED_M = 0.01


@pytest.fixture(scope="module")
def flat(tmp_path_factory) -> World:
    """The flat and all its furniture, at rest."""
    made = SemanticMap(home.new_household_journal(tmp_path_factory.mktemp("flat")))
    abox = rdf.parse(FLAT_TTL.read_bytes(), "flat.ttl", label_prefix="f")
    made.commit(Transaction(id="flat", source="file", insert=tuple(abox)))
    things = CurrentState(made).entities(Entities())
    home.close(made)
    world = World(base_scene.read_mjcf(FLAT_WORLD))
    ordered = [
        body_order(thing, thing.pose) for thing in things if thing.pose is not None and not thing.place
    ]
    assert world.spawn(ordered).failed == {}
    world.step(5.0)
    return world


def opening(world: World) -> dict[tuple[str, str], float]:
    """How far each joint that opens something is open, by the names of body and joint."""
    return {
        (body.name, joint.name): joint.openness
        for body in world.scene().bodies
        for joint in body.joints
        if joint.opens
    }


def moved(world: World, openness: float, joint: str = "", *, of: set[str]) -> dict[tuple[str, str], float]:
    ordered = [JointOrder(name=name, joint=joint, openness=openness) for name in sorted(of)]
    assert world.move_joints(ordered).failed == {}
    world.step(5.0)
    return opening(world)


def test_everything_opens_by_itself_and_pushes_nothing(flat):
    joints = opening(flat)
    assert len(joints) >= 19
    before = {body.name: body.pose.position_m for body in flat.scene().bodies}
    ajar, askew = {}, {}
    for name, joint in joints:
        share = moved(flat, 1.0, joint, of={name})[name, joint]
        if share < 0.99:
            ajar[name, joint] = share
        share = moved(flat, 0.0, joint, of={name})[name, joint]
        if share > 0.01:
            askew[name, joint] = share
    assert (ajar, askew) == ({}, {})
    after = {body.name: body.pose.position_m for body in flat.scene().bodies}
    assert [name for name, at in after.items() if math.dist(at, before[name]) > _PUSHED_M] == []


def test_nor_are_two_in_each_others_way(flat):
    everything = {name for name, _ in opening(flat)}
    assert {joint: share for joint, share in moved(flat, 1.0, of=everything).items() if share < 0.99} == {}
    assert {joint: share for joint, share in moved(flat, 0.0, of=everything).items() if share > 0.01} == {}
