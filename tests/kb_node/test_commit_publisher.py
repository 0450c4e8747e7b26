"""Publication of commits and entities with locations, on a real session."""

import queue

import pytest

from semmap.nodes import bus
from semmap.nodes.kb_node.answers.entity_queries import CurrentState
from semmap.nodes.kb_node.commit_publisher import CommitPublisher
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.ontology import FLAT_TTL
from semmap.ontology import vocabulary as v
from semmap.schemas import keys
from semmap.schemas.commits import Edit, NewEntity, Transaction
from semmap.schemas.entities import Pose
from tests.kb_node import home

FLAT = tuple(rdf.parse(FLAT_TTL.read_bytes(), "flat.ttl", label_prefix="f"))
WAIT_S = 60.0


def on(name, other):
    return (v.entity_iri(name), v.dm("isOn"), v.entity_iri(other))


class Told:
    """A map, and what a subscriber receives of its commits and entities."""

    def __init__(self, session, journal):
        self.map = SemanticMap(journal)
        self.commits, self.news = queue.Queue(), queue.Queue()
        self._followed = [
            bus.follow(session, keys.COMMIT, lambda _, commit: self.commits.put(commit)),
            bus.follow(session, keys.ENTITY, lambda key, entity: self.news.put((key, entity))),
        ]
        self._publisher = CommitPublisher(session, (), CurrentState(self.map).describe)

    def commit(self, **what):
        made = self.map.commit(Transaction(id=str(self.map.seq), source="operator", **what))
        self._publisher.publish(made, self.map.take_derived_changes(made), told=True)
        return self.commits.get(timeout=WAIT_S)

    def heard(self, class_name):
        """Return the messages for a class since the last call, by name."""
        self._publisher._session.delete(keys.entity_key("End", "end"))
        found = {}
        while True:
            key, entity = self.news.get(timeout=WAIT_S)
            if key == keys.entity_key("End", "end"):
                return found
            if key.split("/")[-2] == class_name:
                found[key.split("/")[-1]] = entity


@pytest.fixture
def told(tmp_path):
    journal = home.new_household_journal(tmp_path)
    with bus.open_session(bus.Network(mode="peer", listen=(), connect=())) as session:
        yield Told(session, journal)
    journal.close()


def test_a_commit_is_published_with_location_changes_that_the_journal_omits(told):
    told.commit(insert=FLAT)
    added = told.commit(
        add=(NewEntity(name="cup9", class_iri=v.bare(v.dm("Cup")), pose=Pose(position_m=(8.2, 0.3, 0.9))),)
    )
    assert on("cup9", "counter1") in added.places.came
    assert added.places.went == ()
    away = told.commit(edit=(Edit(name="cup9", at=(2.0, 2.0, 0.0)),))
    assert on("cup9", "counter1") in away.places.went
    said = told.commit(insert=(on("cup9", "counter1"),))
    assert said.places.denied == (on("cup9", "counter1"),)
    called = told.commit(edit=(Edit(name="cup9", ref="mug"),))
    assert called.places is None
    assert [commit.places for commit in told.map._journal.commits()] == [None] * 5


def test_entity_messages_include_the_location_also_if_another_entity_moved(told):
    told.commit(insert=FLAT)
    told.heard("Glass")
    told.commit(edit=(Edit(name="table1", at=(6.0, 3.5, 0.0)),))
    news = told.heard("Glass")
    assert news.keys() == {"glass1"}
    assert "isOn" not in {relation.relation for relation in news["glass1"].whereabouts}
    told.commit(edit=(Edit(name="glass1", at=(8.2, 0.3, 0.9)),))
    (where, *_) = told.heard("Glass")["glass1"].whereabouts
    assert (where.relation, where.object) == ("isOn", "counter1")
    assert where.text


def test_entities_whose_facts_changed_without_a_commit_are_published(told):
    told.commit(insert=FLAT)
    told.heard("Table")
    table = told.map.entity("table1")
    told._publisher.publish_entities([table])
    assert told.heard("Table")["table1"].name == "table1"
    assert told._publisher._types["table1"] == table.types
