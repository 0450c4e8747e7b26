from msgspec import structs

from semmap.nodes.recorder.map_relations import Relations, is_relation, missed_commits
from semmap.ontology import vocabulary as v
from semmap.schemas.commits import PlaceChanges
from tests.recorder.messages import commit, entity, relation, star

ON = relation("cup1", "isOn", "table1")
ENTITIES = {name: entity(name) for name in ("cup1", "table1", "sink1")}


def begun():
    relations = Relations()
    relations.begin([star("cup1", ON, (v.entity_iri("cup1"), v.RDF_TYPE, v.dm("Cup"))), star("table1")])
    return relations


def test_relations_are_between_individuals():
    assert is_relation(ON)
    assert not is_relation((v.entity_iri("cup1"), v.RDF_TYPE, v.dm("Cup")))
    assert not is_relation((v.entity_iri("cup1"), v.HAS_POSITION, v.entity_iri("cup1_coordinates")))
    assert not is_relation((v.entity_iri("cup1_coordinates"), v.COORDINATE_XYZ[0], '"1.0"'))


def test_stars_are_the_start():
    between = begun().between(ENTITIES)
    assert between == {"cup1": (("isOn", "table1"),), "table1": (), "sink1": ()}


def test_commits_change_relations_and_only_those_of_present_entities_count():
    relations = begun()
    relations.take(commit(2, inserted=(relation("cup1", "isInside", "sink1"),), retracted=(ON,)))
    assert relations.between(ENTITIES)["cup1"] == (("isInside", "sink1"),)
    assert relations.between({"cup1": ENTITIES["cup1"]}) == {"cup1": ()}


def test_what_is_computed_counts_and_what_is_denied_does_not():
    relations = Relations()
    in_sink = relation("cup1", "isInside", "sink1")
    told = structs.replace(star("cup1", ON), computed=(in_sink,), denied=(ON,))
    relations.begin([told, star("table1"), star("sink1")])
    assert relations.between(ENTITIES)["cup1"] == (("isInside", "sink1"),)
    relations.take(commit(2, places=PlaceChanges(went=(in_sink,), undenied=(ON,))))
    assert relations.between(ENTITIES)["cup1"] == (("isOn", "table1"),)
    relations.take(commit(3, places=PlaceChanges(came=(in_sink,), denied=(ON,))))
    assert relations.between(ENTITIES)["cup1"] == (("isInside", "sink1"),)
    relations.take(commit(4, retracted=(ON,)))
    relations.take(commit(5, inserted=(ON,), places=PlaceChanges(went=(in_sink,))))
    assert relations.between(ENTITIES)["cup1"] == (("isOn", "table1"),)


def test_what_is_asserted_and_computed_stays_until_neither_is_so():
    relations = begun()
    relations.take(commit(2, places=PlaceChanges(came=(ON,))))
    relations.take(commit(3, retracted=(ON,)))
    assert relations.between(ENTITIES)["cup1"] == (("isOn", "table1"),)
    relations.take(commit(4, places=PlaceChanges(went=(ON,))))
    assert relations.between(ENTITIES)["cup1"] == ()


def test_stars_that_are_newer_than_a_commit_do_no_harm():
    relations = Relations()
    relations.begin([star("cup1", seq=3), star("table1", seq=3)])
    relations.take(commit(2, inserted=(ON,)))
    relations.take(commit(3, retracted=(ON,)))
    assert relations.between(ENTITIES)["cup1"] == ()


def test_what_was_missed_is_what_nobody_heard():
    assert missed_commits(4, 8, [commit(6), commit(9)]) == [5, 7, 8]
    assert missed_commits(4, 4, []) == []
