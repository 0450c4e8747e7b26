"""Names of entities whose IRIs have the same last part."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.documents import document_change
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.bridge import LoadDocument
from semmap.schemas.commits import Edit, Transaction
from tests.kb_node import home
from tests.kb_node.home import transaction, turtle

A, B = "http://x.org/a#mug", "http://x.org/b#mug"
TWO = f"<{A}> a dm:Chair . <{B}> a dm:Chair ."


@pytest.fixture
def household_map(tmp_path):
    made = SemanticMap(home.new_household_journal(tmp_path))
    yield made
    home.close(made)


def load(semantic_map, text, prefixes=None, **fields):
    """Commit a document, and return the notes of its reply."""
    usual = {"filename": "", "replace": False, "skip_unknown": False}
    document = LoadDocument(id=f"{semantic_map.seq}", source="file", content=b"", **{**usual, **fields})
    made, filtered, _ = document_change.make_document_transaction(
        semantic_map, document, turtle(text), prefixes or {}
    )
    semantic_map.commit(made)
    return filtered.notes


def iris(semantic_map):
    return {entity.name: entity.iri for entity in semantic_map.entities()}


def test_new_entities_of_one_name_get_prefixes_with_one_note(semantic_map):
    notes = load(semantic_map, TWO)
    assert iris(semantic_map) == {"a.mug": A, "b.mug": B}
    assert notes == [
        f"2 names with a prefix, because the last part is not unique: a.mug (<{A}>) and b.mug (<{B}>)"
    ]


def test_the_prefixes_of_the_file_are_used(semantic_map):
    load(semantic_map, TWO, {"floor1": "http://x.org/a#", "floor2": "http://x.org/b#"})
    assert iris(semantic_map) == {"floor1.mug": A, "floor2.mug": B}


@pytest.mark.parametrize("namespace", ["http://o.org/other#", v.ABOX])
def test_an_entity_of_the_map_keeps_its_name(semantic_map, namespace):
    load(semantic_map, f"<{namespace}mug> a dm:Chair .")
    load(semantic_map, f"<{B}> a dm:Chair .")
    assert iris(semantic_map) == {"b.mug": B, "mug": f"{namespace}mug"}


def test_an_entity_in_the_namespace_of_the_map_keeps_its_name(semantic_map):
    load(semantic_map, f":mug a dm:Chair . {TWO}")
    assert iris(semantic_map) == {"a.mug": A, "b.mug": B, "mug": f"{v.ABOX}mug"}


def test_a_file_that_is_loaded_again_gives_the_same_names(semantic_map):
    load(semantic_map, TWO)
    before = iris(semantic_map)
    assert load(semantic_map, TWO) == []
    assert load(semantic_map, f"<{B}> a dm:Chair ; rdfs:label 'mine' .") == []
    assert iris(semantic_map) == before
    assert semantic_map.entity("b.mug").preferred_reference == "mine"


def test_names_outlive_the_entities_that_made_them_necessary(semantic_map):
    load(semantic_map, f":mug a dm:Chair . <{B}> a dm:Chair .")
    gone = semantic_map.commit(Transaction(id="r", source="operator", remove=("b.mug",)))
    semantic_map.commit(Transaction(id="s", source="operator", remove=("mug",)))
    semantic_map.commit(Transaction(id="u", source="operator", insert=gone.retracted))
    assert iris(semantic_map) == {"b.mug": B}
    semantic_map.commit(
        Transaction(id="m", source="operator", edit=(Edit(name="b.mug", at=(1.0, 2.0, 3.0)),))
    )
    semantic_map.checkpoint()
    v.give_name(v.iri(B), "")  # as in another process
    again = home.reopened(semantic_map)
    assert iris(again) == {"b.mug": B}
    assert v.entity_name(v.iri(B)) == "b.mug"
    home.close(again)


def test_an_entity_without_a_stated_name_has_that_of_its_iri_again(semantic_map):
    load(semantic_map, TWO)
    semantic_map.commit(Transaction(id="r", source="operator", remove=("a.mug", "b.mug")))
    load(semantic_map, f"<{B}> a dm:Chair .")
    assert iris(semantic_map) == {"mug": B}
    assert not v.has_given_name(v.iri(B))


def test_an_entity_with_a_prefix_is_renamed(semantic_map):
    load(semantic_map, TWO)
    rename = Transaction(id="r", source="operator", edit=(Edit(name="b.mug", rename="cup"),))
    semantic_map.commit(rename)
    assert iris(semantic_map) == {"a.mug": A, "cup": "http://x.org/b#cup"}
    assert len([t for t in semantic_map.abox() if t[1] == v.ENTITY_NAME]) == 1


def test_a_file_may_state_another_name(semantic_map):
    load(semantic_map, TWO)
    load(semantic_map, f"<{B}> <urn:semmap:entityName> 'beaker' .")
    assert iris(semantic_map) == {"a.mug": A, "beaker": B}
    with pytest.raises(errors.BadRequest, match="'no name' is not a name"):
        load(semantic_map, f"<{B}> <urn:semmap:entityName> 'no name' .")


def test_a_rejected_change_leaves_the_names(semantic_map):
    load(semantic_map, TWO)
    with pytest.raises(errors.SemmapError):
        load(semantic_map, f"<{B}> a dm:Chair . <http://x.org/c> a dm:Chair, dm:Kitchen .", replace=True)
    assert v.entity_name(v.iri(B)) == "b.mug"
    semantic_map.commit(Transaction(id="r", source="operator", remove=("b.mug",)))
    assert iris(semantic_map) == {"a.mug": A}


def test_individuals_that_are_the_same_share_a_name(semantic_map):
    assert load(semantic_map, f"{TWO} <{A}> owl:sameAs <{B}> .") == []
    assert iris(semantic_map) == {"mug": A}


def test_a_name_is_unique_even_if_prefixes_are_not(semantic_map):
    load(semantic_map, f":mug a dm:Chair . :b.mug a dm:Chair . <{B}> a dm:Chair .")
    assert iris(semantic_map) == {"b.mug": f"{v.ABOX}b.mug", "b.mug_2": B, "mug": f"{v.ABOX}mug"}


def test_blank_nodes_of_two_files_are_different_and_those_of_one_are_the_same(semantic_map):
    text = "[] a dm:Chair . [] a dm:Chair ."
    load(semantic_map, text, filename="one.ttl")
    assert len(semantic_map) == 2
    load(semantic_map, text, filename="elsewhere/one.ttl")
    assert len(semantic_map) == 2
    load(semantic_map, text, filename="two.ttl")
    assert len(semantic_map) == 4


def test_a_document_that_replaces_the_map_gets_names_of_its_own(semantic_map):
    semantic_map.commit(transaction("first", turtle(":mug a dm:Chair .")))
    load(semantic_map, f"<{B}> a dm:Chair .", replace=True)
    assert iris(semantic_map) == {"mug": B}


def test_the_prefix_does_not_choose_the_model(household_map):
    described = "<http://x.org/floor2#lamp> a dm:Lamp . <http://x.org/a#lamp> a dm:Lamp ."
    load(household_map, described, {"floor2": "http://x.org/floor2#"})
    assert {e.name: e.model for e in household_map.entities()} == {"a.lamp": "lamp", "floor2.lamp": "lamp"}
