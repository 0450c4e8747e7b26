"""What is answered of where things are, with what was asserted and what follows."""

import pytest

from nodes.kb_node.answers import questions, whereabouts
from nodes.kb_node.documents import rdf
from nodes.kb_node.relations.measuring.phrases import SPOKEN
from ontology import FLAT_TTL, HOUSEHOLD_TTL
from ontology import vocabulary as v
from schemas import errors
from schemas.bridge import Entities
from schemas.commands import Could, Explain
from schemas.relations import Where
from tests.kb_node import home


@pytest.fixture(scope="module")
def flat(tmp_path_factory):
    triples = rdf.parse(HOUSEHOLD_TTL.read_bytes(), "household.ttl", label_prefix="h")
    made = home.new_map(tmp_path_factory.mktemp("flat"), triples)
    made.commit(home.transaction(1, rdf.parse(FLAT_TTL.read_bytes(), "flat.ttl", label_prefix="f")))
    made.believe_places()
    yield made
    home.close(made)


def explained(semantic_map, name, predicate, value):
    query = Explain(name=name, predicate=predicate, value=value)
    now = whereabouts.Now(semantic_map)
    return now.measured(query) or now.explained(query, questions.of_explain(semantic_map, query))


def refused(semantic_map, name, predicate, value):
    with pytest.raises(errors.Refused) as caught:
        explained(semantic_map, name, predicate, value)
    return str(caught.value)


def test_list_says_of_on_what_a_path_says_in_sparql(flat):
    listed = {e.name for e in whereabouts.Now(flat).entities(Entities(where=Where(on="table1")))}
    held = flat.reasoner
    on, inside, table = v.dm("isOn"), v.dm("isInside"), v.iri(flat.entity("table1").iri)
    direct = {s for s, _, _ in held.given(None, on, table)}
    assert v.entity_name(v.iri(flat.entity("apple1").iri)) in listed
    assert v.iri(flat.entity("apple1").iri) not in direct
    waiting, all_on = list(direct), set(direct)
    while waiting:
        lower = waiting.pop()
        above = {s for p in (on, inside) for s, _, _ in held.given(None, p, lower)} - all_on
        all_on |= above
        waiting += above
    assert listed == {v.entity_name(s) for s in all_on}


def test_the_commit_is_that_of_the_poses(flat):
    entity = flat.entity("milk1")
    told = explained(flat, "milk1", "isOn", "counter1").text
    assert told.endswith(f"(placed so since commit {entity.pose_provenance.commit})")


def test_why_not_says_by_what_way(flat):
    text = refused(flat, "apple1", "isOn", "table1")
    assert text == "apple1 is not on table1: it is inside bowl1, which is on table1"
    assert "table1 has no hollow" in refused(flat, "apple1", "isInside", "table1")
    assert refused(flat, "table1", "supports", "apple1") == text


@pytest.mark.parametrize("relation", SPOKEN)
def test_each_relation_is_answered_by_measuring(flat, relation):
    answers = []
    for other in ("table1", "chair1", "bowl1"):
        try:
            answers.append(explained(flat, "apple1", relation, other).text)
        except errors.Refused as error:
            answers.append(str(error))
    assert all(answer.startswith("apple1 ") for answer in answers)
    assert not any("nothing excludes" in answer for answer in answers)


def test_what_was_asserted_and_denied_is_said_to_be(flat):
    said = (v.iri(flat.entity("milk1").iri), v.dm("isOn"), v.iri(flat.entity("table1").iri))
    assert "asserted" not in refused(flat, "milk1", "isOn", "table1")
    flat.commit(home.transaction(2, [said]))
    flat.believe_places()
    assert "it was asserted, but is left out" in refused(flat, "milk1", "isOn", "table1")


def test_what_could_be_says_what_geometry_says(flat):
    asked = questions.of_could(flat, Could(name="water1", predicate="isOn", value="chair1"))
    against = whereabouts.Now(flat).against(asked.triples[0])
    text = questions.could(flat.reasoner, asked, against=against).text
    assert text.startswith("yes: nothing excludes")
    assert "but as things are, it stands" in text
