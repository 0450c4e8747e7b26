"""Queries about the past use the facts that were asserted and computed then."""

import pytest

from semmap.nodes.kb_node.answers import answers
from semmap.nodes.kb_node.answers.past.past_map import export_past, load_past_map, query_past
from semmap.nodes.kb_node.derived_facts import DerivedChanges
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.ontology import FLAT_TTL
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Export, Sparql
from semmap.schemas.commits import Edit, NewEntity, Transaction
from semmap.schemas.entities import Pose
from tests.kb_node import home

FLAT = tuple(rdf.parse(FLAT_TTL.read_bytes(), "flat.ttl", label_prefix="f"))
ON_COUNTER = "SELECT ?x { ?x dm:isOn :counter1 } ORDER BY ?x"


@pytest.fixture(scope="module")
def flat(tmp_path_factory):
    journal = home.new_household_journal(tmp_path_factory.mktemp("flat"))
    made = SemanticMap(journal)
    changes = [
        {"insert": FLAT},
        {
            "add": (
                NewEntity(name="cup9", class_iri=v.bare(v.dm("Cup")), pose=Pose(position_m=(8.2, 0.3, 0.9))),
            )
        },
        {"insert": ((v.entity_iri("cup9"), v.dm("isOn"), v.entity_iri("table1")),)},
        {"edit": (Edit(name="cup9", at=(2.0, 2.0, 0.0)),)},
        {"remove": ("cup9",)},
    ]
    for number, change in enumerate(changes):
        made.commit(Transaction(id=str(number), source="operator", **change))
    yield made
    journal.close()


def asked(flat, when, query=ON_COUNTER, *, inferred=True):
    found = query_past(
        flat._journal, HistoryReader(flat._journal), Sparql(query=query, as_of=when, inferred=inferred)
    )
    return found.seq, [v.entity_name(row[0]) for row in found.rows]


def test_a_query_of_the_past_sees_the_computed_facts_of_that_time(flat):
    seq, before = asked(flat, 1)
    assert seq == 1
    assert "milk1" in before
    assert asked(flat, 2)[1] == sorted([*before, "cup9"])
    assert asked(flat, 4)[1] == before


def test_without_inferred_it_sees_the_asserted_facts_of_that_time(flat):
    said = "SELECT ?x { ?x dm:isOn :table1 . FILTER(?x = :cup9) }"
    assert asked(flat, 3, said, inferred=False) == (3, ["cup9"])
    assert asked(flat, 3, said, inferred=True) == (3, [])  # the geometry denied it then, too
    assert asked(flat, 4, said, inferred=False) == (4, [])


def test_measurements_on_demand_use_the_past_poses(flat):
    near = "SELECT ?x { ?x dm:isNextTo :cup9 }"
    assert asked(flat, 2, near)[1]


def test_the_last_commit_equals_the_present_map(flat):
    then = load_past_map(flat._journal, HistoryReader(flat._journal), 5, inferred=True)
    assert set(then.asserted) == set(flat.reasoner.asserted())
    now = flat.all_derived()
    assert DerivedChanges(*map(set, then.derived_changes)) == DerivedChanges(*map(set, now))


def test_before_the_first_commit_there_is_no_map(flat):
    with pytest.raises(errors.Refused, match="there was no map at that time"):
        asked(flat, 0)
    with pytest.raises(errors.Refused, match="there is no commit 9 yet"):
        asked(flat, 9)


def exported(flat, when, **others):
    query = Export(format="turtle", as_of=when, **others)
    document = export_past(flat._journal, HistoryReader(flat._journal), query)
    return document, set(rdf.parse(document.content, "export.ttl"))


def test_an_export_of_the_past_has_the_asserted_facts_of_that_time(flat):
    is_cup = (v.entity_iri("cup9"), v.RDF_TYPE, v.dm("Cup"))
    before, then, after = (exported(flat, when)[1] for when in (1, 2, 5))
    assert is_cup in then
    assert is_cup not in before | after
    assert before == after


def test_an_export_of_the_past_omits_the_ontology_and_has_its_commit(flat):
    document, triples = exported(flat, 3)
    assert document.seq == 3
    assert document.triples == len(triples)
    assert not [s for s, p, o in triples if p == v.RDF_TYPE and o == v.OWL_CLASS]


def test_an_export_of_the_past_can_include_inferences_and_measurements(flat):
    on_counter = (v.entity_iri("cup9"), v.dm("isOn"), v.entity_iri("counter1"))
    on_table = (v.entity_iri("cup9"), v.dm("isOn"), v.entity_iri("table1"))
    graspable = (v.entity_iri("cup9"), v.RDF_TYPE, v.dm("Graspable_Thing"))
    then = exported(flat, 3, inferred=True)[1]
    assert {on_counter, graspable} <= then
    assert on_table not in then  # it was asserted, and denied by the geometry
    assert [t for t in then if t[0] == v.entity_iri("cup9") and t[1] == v.dm("isNextTo")]
    assert on_counter not in exported(flat, 4, inferred=True)[1]


def test_an_export_of_the_last_commit_equals_an_export_of_the_present(flat):
    now = answers.document(answers.export_snapshot(flat, inferred=True), "turtle")
    assert exported(flat, 5, inferred=True)[1] == set(rdf.parse(now.content, "now.ttl"))
