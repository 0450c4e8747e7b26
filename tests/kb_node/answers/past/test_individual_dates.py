"""`get` of an individual that is not in space: the commits that last changed it."""

import pytest

from semmap.nodes.kb_node.answers.past.individual_dates import find_dates, find_described
from semmap.nodes.kb_node.storage.encoding import body_encoding
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from tests.kb_node.home import TBOX, SemanticMap, chair, rdf, transaction, turtle

ANNA = "<http://example.org/people/anna>"
PEOPLE = turtle(
    """
    @prefix ex: <http://example.org/people/> .
    ex:anna a ex:Person ; rdfs:label "Anna"@en ; ex:address [ ex:city "Rome" ] .
    ex:bob a ex:Person ; ex:knows ex:anna .
    """
)


@pytest.fixture
def journal(tmp_path):
    return Journal.create(tmp_path / FILENAME, rdf.serialise(TBOX, "ntriples"))


@pytest.fixture
def people(journal):
    semantic_map = SemanticMap(journal)
    semantic_map.commit(transaction("chair", chair("chair1")))
    semantic_map.commit(transaction("people", PEOPLE))
    return semantic_map


def dates(journal, people, term=ANNA):
    found = find_dates(journal, find_described(people.reasoner, term), people.seq)
    return found.last.commit, found.classes.commit, found.labels.commit


def test_each_part_has_the_commit_that_last_changed_it(journal, people):
    assert dates(journal, people) == (2, 2, 2)
    people.commit(transaction("note", [(ANNA, "<urn:x:note>", '"x"')]))
    people.commit(transaction("chair2", chair("chair2")))
    assert dates(journal, people) == (3, 2, 2)
    people.commit(transaction("label", turtle(f'{ANNA} rdfs:label "Anna"@it .')))
    assert dates(journal, people) == (5, 2, 5)
    assert dates(journal, people, "<http://example.org/people/bob>") == (2, 2, 2)


def test_a_change_of_a_nameless_value_counts_and_what_refers_to_it_does_not(journal, people):
    (node,) = people.reasoner.about(ANNA)["<http://example.org/people/address>"]
    people.commit(transaction("zip", [(node, "<http://example.org/people/zip>", '"00100"')]))
    people.commit(transaction("carl", turtle(f"<urn:x:carl> <urn:x:knows> {ANNA} .")))
    assert dates(journal, people) == (3, 2, 2)


def test_what_an_individual_of_the_tbox_is_has_no_commit(journal, people):
    assert dates(journal, people, "<urn:x:unknown>") == (0, 0, 0)


def test_a_pattern_is_found_across_the_pieces_of_a_compressed_body():
    text = "x" * ((1 << 20) - 3) + "pattern" + "y" * (1 << 20)
    body = body_encoding.encode(text, compressed_from=0)
    assert body_encoding.find_contained(body, {b"pattern", b"other"}) == {b"pattern"}
