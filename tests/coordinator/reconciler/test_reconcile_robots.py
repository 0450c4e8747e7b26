"""A robot of a new simulator is placed at its last committed pose."""

import pytest
from msgspec import structs

from semmap.nodes.coordinator.reconciler.reconcile import Actions
from semmap.schemas.entities import Entity
from semmap.schemas.scenes import Body
from tests.coordinator.reconciler.test_reconcile import NOTHING, at, body, entity, look

TRUTHS = ["map", "scene", "perceived"]
STOOD, BEGAN = at(4.0, 1.0), at(0.0)


def known(name: str = "robot1") -> Entity:
    return structs.replace(entity(name, STOOD, posed=9, source="scene"), tracked="sim")


def robot(name: str = "robot1", *, commit: int, part_of: str = "", pose=BEGAN) -> Body:
    made = body(name, pose, commit=commit, of_entity=False)
    return structs.replace(made, robot=True, part_of=part_of)


@pytest.mark.parametrize("truth", TRUTHS)
def test_it_starts_at_its_committed_pose_with_its_parts(truth):
    bodies = [robot(commit=-1), robot("robot1_gripper", commit=-1, part_of="robot1")]
    wanted = look([known(), known("robot1_gripper")], bodies, truth)
    (placed,) = wanted.place
    assert (placed.name, placed.pose, placed.commit) == ("robot1", STOOD, 9)
    assert wanted._replace(place=()) == NOTHING


@pytest.mark.parametrize("truth", TRUTHS)
def test_after_its_start_the_map_follows_it(truth):
    for commit in (0, 9):
        wanted = look([known()], [robot(commit=commit)], truth)
        assert [placement.pose for placement in wanted.follow] == [BEGAN]
        assert wanted._replace(follow=()) == NOTHING


@pytest.mark.parametrize("truth", TRUTHS)
def test_a_new_one_stays_where_it_is_and_becomes_an_entity(truth):
    there = robot(commit=-1)
    assert look([], [there], truth) == Actions(adopt=(there,))
