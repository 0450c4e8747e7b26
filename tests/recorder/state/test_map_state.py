from nodes.recorder.state.map_state import MapState, is_relation, missed
from ontology import vocabulary as v
from schemas.commits import Snapshot
from tests.recorder.messages import commit, entity, relation, star

ON = relation("cup1", "isOn", "table1")


def begun():
    state = MapState()
    snapshot = Snapshot(seq=1, entities=(entity("cup1", "Cup"), entity("table1", "Table")))
    state.begin(snapshot)
    state.relate([star("cup1", ON, (v.entity_iri("cup1"), v.RDF_TYPE, v.dm("Cup"))), star("table1")])
    return state


def test_relations_are_between_individuals():
    assert is_relation(ON)
    assert not is_relation((v.entity_iri("cup1"), v.RDF_TYPE, v.dm("Cup")))
    assert not is_relation((v.entity_iri("cup1"), v.HAS_POSITION, v.entity_iri("cup1_coordinates")))
    assert not is_relation((v.entity_iri("cup1_coordinates"), v.COORDINATE_XYZ[0], '"1.0"'))


def test_a_snapshot_and_its_stars_are_the_start():
    state = begun()
    assert state.seq == 1
    assert state.relations() == {"cup1": (("isOn", "table1"),), "table1": ()}


def test_commits_change_entities_and_relations():
    state = begun()
    inside = relation("cup1", "isInside", "sink1")
    assert state.take(commit(2, entity("sink1", "Sink"), inserted=(inside,), retracted=(ON,)))
    assert state.relations()["cup1"] == (("isInside", "sink1"),)
    assert state.take(commit(3, removed=("sink1",)))
    assert set(state.entities) == {"cup1", "table1"}
    assert state.relations()["cup1"] == ()


def test_stars_that_are_newer_than_the_snapshot_do_no_harm():
    state = MapState()
    snapshot = Snapshot(seq=1, entities=(entity("cup1", "Cup"), entity("table1", "Table")))
    state.begin(snapshot)
    state.relate([star("cup1", seq=3), star("table1", seq=3)])
    state.take(commit(2, inserted=(ON,)))
    state.take(commit(3, retracted=(ON,)))
    assert state.relations()["cup1"] == ()


def test_what_was_missed_is_what_nobody_heard():
    assert missed(4, 8, [commit(6), commit(9)]) == [5, 7, 8]
    assert missed(4, 4, []) == []
