"""Replacing the TBox at run time."""

import pytest

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.tbox import tbox_validation
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import History
from tests.kb_node import home
from tests.kb_node.home import TBOX_TURTLE, chair, state, transaction, turtle
from tests.kb_node.test_semantic_map import full_by_page_count

NEW_CLASSES = (
    TBOX_TURTLE + "dm:Seat rdfs:subClassOf dm:Movable . dm:Movable a owl:Class . dm:Bench a owl:Class ;"
)
NEW_CLASSES += " rdfs:subClassOf dm:Seat . dm:Chair dm:model 'throne' ."


def tbox(text):
    return rdf.parse(text.encode(), "tbox", label_prefix="n")


def replace(semantic_map, number, text):
    return semantic_map.replace_tbox(transaction(number, source="file", verb="load"), tbox(text))


@pytest.fixture
def furnished(semantic_map):
    semantic_map.commit(
        transaction(1, [*chair("chair1"), *chair("chair2"), *turtle(":kitchen1 a dm:Kitchen .")])
    )
    return semantic_map


def test_replacing_the_tbox_is_one_commit(furnished):
    commit = replace(furnished, "t", NEW_CLASSES)
    assert (commit.seq, commit.tbox, furnished.seq) == (2, True, 2)
    assert [e.name for e in commit.changed] == ["chair1", "chair2"]
    assert commit.removed == ()
    assert (v.dm("Bench"), v.RDFS_SUB_CLASS_OF, v.dm("Seat")) in commit.inserted
    chair1 = furnished.entity("chair1")
    assert "Movable" in chair1.types
    assert chair1.provenance.commit == 1
    assert [e.name for e in furnished.entities(v.dm("Movable"))] == ["chair1", "chair2"]
    assert "Bench" in furnished.classes.iris
    bench = turtle(":bench1 a dm:Bench .")
    assert furnished.commit(transaction("bench", bench)).changed[0].types[:2] == ("Bench", "Seat")
    assert furnished.abox() != []
    assert not set(furnished.abox()) & set(tbox(NEW_CLASSES))


def test_the_model_of_a_body_changes_with_the_tbox(furnished):
    changed = TBOX_TURTLE.replace('dm:model "chair"', 'dm:model "throne"')
    replace(furnished, "t", changed)
    chair1 = furnished.entity("chair1")
    assert (chair1.model, chair1.shape_provenance.commit, chair1.pose_provenance.commit) == ("throne", 2, 1)


def test_the_same_command_twice_replaces_once(furnished):
    assert replace(furnished, "t", NEW_CLASSES) == replace(furnished, "t", TBOX_TURTLE)
    assert "Bench" in furnished.classes.iris


@pytest.mark.parametrize("checkpoints", [(), ("before",), ("after",), ("before", "after")])
def test_it_survives_a_restart(furnished, checkpoints):
    if "before" in checkpoints:
        furnished.checkpoint()
    replace(furnished, "t", NEW_CLASSES)
    if "after" in checkpoints:
        furnished.checkpoint()
    furnished.commit(transaction("bench", turtle(":bench1 a dm:Bench .")))
    expected, classes = state(furnished), list(furnished.class_table())
    again = home.reopened(furnished)
    assert (state(again), list(again.class_table())) == (expected, classes)
    assert again.tbox == furnished.tbox
    home.close(again)


def test_the_next_start_uses_the_cached_closure(furnished):
    assert not furnished.checkpoint_is_due(quiet=True)
    replace(furnished, "t", NEW_CLASSES)
    assert furnished.checkpoint_is_due(quiet=True)
    assert not furnished.checkpoint_is_due(quiet=False)
    furnished.checkpoint()
    assert not furnished.checkpoint_is_due(quiet=True)


def test_history_and_past_states_stay_correct(furnished):
    before = furnished.snapshot().entities
    replace(furnished, "t", NEW_CLASSES)
    past = HistoryReader(furnished._journal)
    assert past.entities(1) == before
    assert past.entities(2) == furnished.snapshot().entities
    assert past.entities(1, "Movable", ["Movable"]) == ()
    assert [(c.seq, c.tbox) for c in past.history(History(name="chair1"))] == [(1, False), (2, True)]


REFUSED = {
    "unknown class": (
        TBOX_TURTLE.replace("dm:Kitchen", "dm:Cellar"),
        tbox_validation.DoesNotFit,
        "the map does not fit the TBox: unknown class 'Kitchen' \\(of kitchen1\\)",
    ),
    "a spatial class lost": (
        TBOX_TURTLE.replace("dm:Chair a owl:Class ; rdfs:subClassOf dm:Seat", "dm:Chair a owl:Class"),
        tbox_validation.DoesNotFit,
        "chair. would lose its spatial class, because the TBox does not say that Chair is spatial",
    ),
    "inconsistent map": (
        TBOX_TURTLE + "dm:Chair owl:disjointWith dm:Seat .",
        errors.Inconsistent,
        "chair. cannot be both a chair and a Seat",
    ),
    "inconsistent TBox": (
        TBOX_TURTLE + ":x a dm:Chair , dm:Kitchen .",
        errors.Inconsistent,
        "the TBox is inconsistent: x cannot be",
    ),
    "no TBox": ("<urn:a> <urn:b> <urn:c> .", errors.BadFile, "has no class: is it a TBox"),
}


@pytest.mark.parametrize(("text", "error", "says"), REFUSED.values(), ids=REFUSED.keys())
def test_a_tbox_that_does_not_fit_the_map_changes_nothing(furnished, text, error, says):
    before = (
        state(furnished),
        list(furnished.class_table()),
        set(furnished.reasoner.inferred()),
        furnished.tbox,
    )
    with pytest.raises(error, match=says) as caught:
        replace(furnished, "t", text)
    assert type(caught.value) is error
    after = (
        state(furnished),
        list(furnished.class_table()),
        set(furnished.reasoner.inferred()),
        furnished.tbox,
    )
    assert after == before
    assert furnished.commit(transaction("more", chair("chair3"))).seq == 2
    again = home.reopened(furnished)
    assert again.seq == 2
    home.close(again)


def test_a_full_disk_does_not_change_the_tbox(furnished):
    before = state(furnished), furnished.tbox
    text = NEW_CLASSES + f"dm:Chair rdfs:comment '{'x' * 100_000}' ."
    with full_by_page_count(furnished._journal), pytest.raises(errors.Refused, match="could not be written"):
        replace(furnished, "t", text)
    assert (state(furnished), furnished.tbox) == before


def test_imports_name_the_ontology(semantic_map):
    (said,) = tbox_validation.import_triples(semantic_map.tbox)
    assert said[:2] == (v.ABOX_ONTOLOGY, v.OWL_IMPORTS)


@pytest.mark.parametrize(
    ("text", "has"),
    [
        (TBOX_TURTLE, False),
        (TBOX_TURTLE + ":sink a dm:Door .", True),
        (TBOX_TURTLE + ":sink dm:isLocatedIn :kitchen .", True),
    ],
)
def test_a_tbox_may_describe_individuals(text, has):
    assert tbox_validation.has_individuals(tbox(text)) is has
