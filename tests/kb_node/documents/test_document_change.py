import pytest

from semmap.nodes.kb_node.documents import document_change, rdf
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.bridge import LoadDocument, LoadTBox
from tests.kb_node import home
from tests.kb_node.home import chair, transaction, turtle

SIGNED = {"id": "7", "source": "file", "agent": "a", "reason": "why", "content": b"", "filename": "f.ttl"}


def document(**fields):
    return LoadDocument(**SIGNED, **{"replace": False, "skip_unknown": False, **fields})


def test_a_transaction_has_the_author_of_the_load(semantic_map):
    made, *_ = document_change.make_document_transaction(semantic_map, document(), turtle(":a a dm:Chair ."))
    assert (made.id, made.source, made.agent, made.verb, made.reason) == ("7", "file", "a", "load", "why")
    assert (made.insert, made.retract) == (turtle(":a a dm:Chair ."), ())


def test_triples_of_the_tbox_are_not_part_of_the_abox(semantic_map):
    both = turtle(":a a dm:Chair . dm:Chair a owl:Class .")
    made, *_ = document_change.make_document_transaction(semantic_map, document(), both)
    assert made.insert == turtle(":a a dm:Chair .")


def test_replaced_triples_are_removed_in_the_same_transaction(semantic_map):
    semantic_map.commit(transaction(1, chair()))
    made, *_ = document_change.make_document_transaction(
        semantic_map, document(replace=True), turtle(":a a dm:Chair .")
    )
    assert set(made.retract) == set(chair())


def test_skipped_individuals_are_reported(semantic_map):
    content = turtle(":a a dm:Chair . :b a dm:Chiar .")
    made, filtered, _ = document_change.make_document_transaction(
        semantic_map, document(skip_unknown=True), content
    )
    assert made.insert == turtle(":a a dm:Chair .")
    assert filtered.skipped == ["b (unknown class 'Chiar')"]


def test_loading_the_current_tbox_changes_nothing(semantic_map):
    imports = (v.ABOX_ONTOLOGY, v.OWL_IMPORTS, v.iri(v.TBOX.rstrip("#")))
    semantic_map.commit(transaction(1, [imports]))
    assert (
        document_change.make_tbox_transaction(semantic_map, LoadTBox(**SIGNED), frozenset(home.TBOX)) is None
    )


def test_another_tbox_changes_the_import(semantic_map):
    before = (v.ABOX_ONTOLOGY, v.OWL_IMPORTS, v.iri(v.TBOX.rstrip("#")))
    semantic_map.commit(transaction(1, [before]))
    made = document_change.make_tbox_transaction(
        semantic_map, LoadTBox(**SIGNED), frozenset(turtle("<urn:other> a owl:Ontology ."))
    )
    assert made is not None
    assert made.retract == (before,)
    assert made.insert == ((v.ABOX_ONTOLOGY, v.OWL_IMPORTS, "<urn:other>"),)


STRANGE = ":a a dm:Chair ; dm:isLocatedIn :kitchn . :kitchn dm:isLocatedIn :b . :b a dm:Kitchen ."


def test_undescribed_individuals_are_noted(semantic_map):
    made, filtered, _ = document_change.make_document_transaction(semantic_map, document(), turtle(STRANGE))
    assert set(made.insert) == set(turtle(STRANGE))
    assert filtered.notes == [
        "referenced but not described: kitchn (a isLocatedIn kitchn); --strict rejects such files"
    ]


@pytest.mark.parametrize(
    "described", [":k a dm:Kitchen", ':k rdfs:label "kitchen"', ":k owl:sameAs :b", ":b owl:sameAs :k"]
)
def test_a_label_and_an_equal_individual_are_descriptions(semantic_map, described):
    text = f":a a dm:Chair ; dm:isLocatedIn :k . :b a dm:Kitchen . {described} ."
    _, filtered, _ = document_change.make_document_transaction(semantic_map, document(), turtle(text))
    assert filtered.notes == []


def test_a_nameless_individual_is_no_label_in_the_note(semantic_map):
    text = ":b a dm:Kitchen ; dm:p [ dm:isLocatedIn :kitchn ] ."
    _, filtered, _ = document_change.make_document_transaction(semantic_map, document(), turtle(text))
    assert any("kitchn (a nameless individual isLocatedIn kitchn)" in note for note in filtered.notes)


@pytest.mark.parametrize(("number", "more"), [(5, ""), (7, " and 2 more")])
def test_undescribed_individuals_are_rejected_if_the_load_is_strict(semantic_map, number, more):
    many = "".join(f":a{i} a dm:Chair ; dm:isLocatedIn :k{i} ." for i in range(number))
    with pytest.raises(errors.UnknownName) as caught:
        document_change.make_document_transaction(semantic_map, document(strict=True), turtle(many))
    assert caught.value.text == (
        "referenced but not described: " + ", ".join(f"k{i} (a{i} isLocatedIn k{i})" for i in range(5)) + more
    )


@pytest.mark.parametrize("strict", [False, True])
@pytest.mark.parametrize(
    "text",
    [
        ":a a dm:Chair ; dm:isLocatedIn :b . :b a dm:Kitchen .",
        ":a a dm:Chair ; dm:isLocatedIn :hall .",  # the map has it
        ":a a dm:Chair ; dm:isLocatedIn dm:Kitchen .",  # the TBox has it
        ":a a dm:Chair ; rdfs:seeAlso <urn:a> ; owl:sameAs :c ; dm:near :d .",  # no relations
        ":a a dm:Chair ; dm:lexicalReference 'chair' .",
    ],
)
def test_described_individuals_are_accepted(semantic_map, text, strict):
    semantic_map.commit(transaction(1, turtle(":hall a dm:Location .")))
    _, filtered, _ = document_change.make_document_transaction(
        semantic_map, document(strict=strict), turtle(text)
    )
    assert not any("not described" in note for note in filtered.notes)


def test_replaced_triples_do_not_describe_individuals(semantic_map):
    semantic_map.commit(transaction(1, turtle(":hall a dm:Location .")))
    strange = turtle(":a a dm:Chair ; dm:isLocatedIn :hall .")
    with pytest.raises(errors.UnknownName, match="hall"):
        document_change.make_document_transaction(semantic_map, document(replace=True, strict=True), strange)


def test_a_map_is_not_accepted_as_a_tbox(semantic_map):
    order, tbox = LoadTBox(**SIGNED), turtle(":a a dm:Chair . dm:Chair a owl:Class .")
    document_change.require_no_map(semantic_map, order, tbox)
    semantic_map.commit(transaction(1, turtle(":a a dm:Chair .")))
    with pytest.raises(errors.BadFile) as refused:
        document_change.require_no_map(semantic_map, order, tbox)
    assert refused.value.text == (
        "f.ttl cannot be the TBox: it describes 1 entity of the map (a); load a map without --tbox"
    )
    document_change.require_no_map(semantic_map, order, turtle("dm:Chair a owl:Class . :b a dm:Chair ."))


def test_an_extension_survives_a_restart_and_a_replay(semantic_map, tmp_path):
    semantic_map.commit(transaction(1, chair()))
    stool = "dm:Stool a owl:Class ; rdfs:subClassOf dm:Chair , [ owl:unionOf ( dm:Seat dm:Object ) ] ."
    content = (home.PREFIXES + stool).encode()
    load = LoadTBox(**{**SIGNED, "content": content}, extend=True)
    document = rdf.read(content, load.filename, label_prefix="x")
    added = document_change.complete_tbox(semantic_map, load, document)
    tbox = semantic_map.tbox | frozenset(added)
    assert set(semantic_map.tbox) < tbox
    commit = semantic_map.replace_tbox(transaction(2), tbox)
    semantic_map.commit(transaction(3, turtle(":stool1 a dm:Stool .")))
    (tmp_path / "other").mkdir()
    other = home.new_map(tmp_path / "other")
    other.commit(transaction(1, chair()))
    other.restate(commit, rdf.serialise(tbox, "ntriples"))
    again = home.reopened(semantic_map)
    assert again.tbox == other.tbox == tbox
    assert "Chair" in again.entity("stool1").types
    home.close(again)
    home.close(other)
