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


def test_a_document_is_signed_by_who_loads_it(semantic_map):
    made, _ = document_change.of_document(semantic_map, document(), turtle(":a a dm:Chair ."))
    assert (made.id, made.source, made.agent, made.verb, made.reason) == ("7", "file", "a", "load", "why")
    assert (made.insert, made.retract) == (turtle(":a a dm:Chair ."), ())


def test_what_the_tbox_says_too_is_not_of_the_abox(semantic_map):
    both = turtle(":a a dm:Chair . dm:Chair a owl:Class .")
    made, _ = document_change.of_document(semantic_map, document(), both)
    assert made.insert == turtle(":a a dm:Chair .")


def test_what_is_replaced_goes_in_the_same_transaction(semantic_map):
    semantic_map.commit(transaction(1, chair()))
    made, _ = document_change.of_document(semantic_map, document(replace=True), turtle(":a a dm:Chair ."))
    assert set(made.retract) == set(chair())


def test_what_was_left_out_is_told(semantic_map):
    content = turtle(":a a dm:Chair . :b a dm:Chiar .")
    made, sorted_out = document_change.of_document(semantic_map, document(skip_unknown=True), content)
    assert made.insert == turtle(":a a dm:Chair .")
    assert sorted_out.skipped == ["b (unknown class 'Chiar')"]


def test_the_tbox_that_holds_is_no_change(semantic_map):
    imports = (v.ABOX_ONTOLOGY, v.OWL_IMPORTS, v.iri(v.TBOX.rstrip("#")))
    semantic_map.commit(transaction(1, [imports]))
    assert document_change.of_tbox(semantic_map, LoadTBox(**SIGNED), frozenset(home.TBOX)) is None


def test_another_tbox_is_imported_instead(semantic_map):
    before = (v.ABOX_ONTOLOGY, v.OWL_IMPORTS, v.iri(v.TBOX.rstrip("#")))
    semantic_map.commit(transaction(1, [before]))
    made = document_change.of_tbox(
        semantic_map, LoadTBox(**SIGNED), frozenset(turtle("<urn:other> a owl:Ontology ."))
    )
    assert made is not None
    assert made.retract == (before,)
    assert made.insert == ((v.ABOX_ONTOLOGY, v.OWL_IMPORTS, "<urn:other>"),)


STRANGE = ":a a dm:Chair ; dm:isLocatedIn :kitchn . :kitchn dm:isLocatedIn :b . :b a dm:Kitchen ."


def test_what_nobody_describes_is_noted(semantic_map):
    made, sorted_out = document_change.of_document(semantic_map, document(), turtle(STRANGE))
    assert set(made.insert) == set(turtle(STRANGE))
    assert sorted_out.notes == [
        "referenced but not described: kitchn (a isLocatedIn kitchn); --strict refuses such files"
    ]


def test_what_nobody_describes_is_refused_when_that_is_asked_for(semantic_map):
    many = "".join(f":a{i} a dm:Chair ; dm:isLocatedIn :k{i} ." for i in range(7))
    with pytest.raises(errors.UnknownName) as caught:
        document_change.of_document(semantic_map, document(strict=True), turtle(many))
    assert caught.value.text == (
        "referenced but not described: "
        + ", ".join(f"k{i} (a{i} isLocatedIn k{i})" for i in range(5))
        + " and 2 more"
    )


@pytest.mark.parametrize("strict", [False, True])
@pytest.mark.parametrize(
    "text",
    [
        ":a a dm:Chair ; dm:isLocatedIn :b . :b a dm:Kitchen .",
        ":a a dm:Chair ; dm:isLocatedIn :hall .",  # it is in the map
        ":a a dm:Chair ; dm:isLocatedIn dm:Kitchen .",  # it is in the TBox
        ":a a dm:Chair ; rdfs:seeAlso <urn:a> ; owl:sameAs :c ; dm:near :d .",  # no relations
        ":a a dm:Chair ; dm:lexicalReference 'chair' .",
    ],
)
def test_what_somebody_describes_is_no_stranger(semantic_map, text, strict):
    semantic_map.commit(transaction(1, turtle(":hall a dm:Location .")))
    _, sorted_out = document_change.of_document(semantic_map, document(strict=strict), turtle(text))
    assert not any("not described" in note for note in sorted_out.notes)


def test_what_goes_describes_nothing(semantic_map):
    semantic_map.commit(transaction(1, turtle(":hall a dm:Location .")))
    strange = turtle(":a a dm:Chair ; dm:isLocatedIn :hall .")
    with pytest.raises(errors.UnknownName, match="hall"):
        document_change.of_document(semantic_map, document(replace=True, strict=True), strange)


def test_a_map_is_not_taken_for_a_tbox(semantic_map):
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
    added = document_change.tbox_of(semantic_map, load, label_prefix="x")
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
