"""Spatial queries use live poses; facts and the past do not."""

from __future__ import annotations

from contextlib import nullcontext
from types import SimpleNamespace

import pytest
from msgspec import structs

from semmap.nodes.kb_node.answers.entity_queries import CurrentState
from semmap.nodes.kb_node.answers.live_poses import LiveEntities
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.ontology import HOUSEHOLD_TTL
from semmap.ontology import vocabulary as v
from semmap.schemas.bridge import Entities
from semmap.schemas.commands import Relations
from semmap.schemas.commits import Edit, NewEntity, Transaction
from semmap.schemas.entities import Live, Pose, orientation_from_yaw
from semmap.schemas.live import LivePoses
from semmap.schemas.relations import Where
from tests.kb_node.relations.entities import thing


def new(name: str, class_name: str, x: float, **fields) -> NewEntity:
    iri = v.bare(v.dm(class_name))
    return NewEntity(name=name, class_iri=iri, pose=Pose(position_m=(x, 0.0, 0.0)), **fields)


@pytest.fixture
def semantic_map(tmp_path):
    journal = Journal.create(tmp_path / "journal.sqlite", HOUSEHOLD_TTL.read_bytes())
    found = SemanticMap(journal)
    found.commit(
        Transaction(
            id="begin",
            source="operator",
            add=(
                new("chair1", "Chair", 0.0),
                new("chair2", "Chair", 10.0),
                new("robot1", "Robot", 2.0, tracked="stream"),
            ),
        )
    )
    yield found
    journal.close()


def heard(x: float) -> LivePoses:
    live = Live(pose=Pose(position_m=(x, 0.0, 0.0)), stamp_ns=1, age_s=0.0, source="stream")
    return LivePoses(stamp_ns=1, entities={"robot1": live, "nobody1": live, "chair1": live})


def nearest(semantic_map) -> list[str]:
    found = CurrentState(semantic_map).entities(Entities(where=Where(nearest=1, to="robot1")))
    return [entity.name for entity in found]


def test_nearest_uses_the_live_poses(semantic_map):
    now_s = 0.0
    live = LiveEntities(semantic_map, lambda: now_s)
    with live.applied():
        assert nearest(semantic_map) == ["chair1"]
    live.update(heard(9.0))
    with live.applied():
        assert nearest(semantic_map) == ["chair2"]
        near = CurrentState(semantic_map).relations(Relations(name="robot1", other="chair2"))
        assert "isNear" in {relation.relation for relation in near if relation.holds}
    assert nearest(semantic_map) == ["chair1"]  # as committed
    assert semantic_map.entity("robot1").pose == Pose(position_m=(2.0, 0.0, 0.0))
    now_s = 10.0  # the publisher has stopped
    with live.applied():
        assert nearest(semantic_map) == ["chair1"]


def test_only_tracked_entities_have_live_poses(semantic_map):
    live = LiveEntities(semantic_map, lambda: 0.0)
    live.update(heard(9.0))
    with live.applied():
        assert semantic_map.places.space().solids["chair1"].position[0] == 0.0
        assert "nobody1" not in semantic_map.places.space().solids


def test_tracking_is_durable_and_can_be_undone(semantic_map):
    assert semantic_map.entity("robot1").tracked == "stream"
    commit = semantic_map.commit(
        Transaction(id="sim", source="operator", edit=(Edit(name="robot1", tracked="sim"),))
    )
    assert [e.tracked for e in commit.changed] == ["sim"]
    semantic_map.commit(Transaction(id="off", source="operator", edit=(Edit(name="robot1", tracked=""),)))
    assert semantic_map.entity("robot1").tracked == ""
    again = Transaction(id="again", source="operator", edit=(Edit(name="robot1", tracked=""),))
    assert semantic_map.commit(again) is None


def test_tracking_survives_a_restart(tmp_path):
    path = tmp_path / "journal.sqlite"
    for restart in (False, True):
        journal = Journal(path) if restart else Journal.create(path, HOUSEHOLD_TTL.read_bytes())
        found = SemanticMap(journal)
        if not restart:
            robots = (new("robot1", "Robot", 2.0, tracked="sim"), new("robot2", "Robot", 4.0))
            found.commit(Transaction(id="begin", source="operator", add=robots))
            found.checkpoint()
        assert (found.entity("robot1").tracked, found.entity("robot2").tracked) == ("sim", "")
        journal.close()


@pytest.mark.parametrize(
    ("pose", "moves"),
    [
        (Pose(position_m=(2.0005, 0.0, 0.0)), False),
        (Pose(position_m=(2.002, 0.0, 0.0)), True),
        (Pose(position_m=(2.0, 0.0, 0.0), orientation_wxyz=orientation_from_yaw(0.001)), False),
        (Pose(position_m=(2.0, 0.0, 0.0), orientation_wxyz=orientation_from_yaw(0.01)), True),
    ],
)
def test_a_live_pose_almost_as_committed_changes_nothing(pose, moves):
    robot = structs.replace(thing("robot1", (2.0, 0.0, 0.0)), tracked="stream")
    changes = []

    def with_changes(entities):
        changes.extend(entities)
        return nullcontext()

    space = SimpleNamespace(with_changes=with_changes)
    places = SimpleNamespace(space=lambda: space)
    live = LiveEntities(SimpleNamespace(find={"robot1": robot}.get, places=places), lambda: 0.0)
    now = Live(pose=pose, stamp_ns=1, age_s=0.0, source="stream")
    live.update(LivePoses(stamp_ns=1, entities={"robot1": now}))
    with live.applied():
        assert changes == ([structs.replace(robot, pose=pose)] if moves else [])
