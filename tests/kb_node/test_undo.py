import pytest

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.undo import undo
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Undo
from tests.kb_node import home
from tests.kb_node.documents.tbox.test_tbox_validation import NEW_CLASSES, replace
from tests.kb_node.home import chair, transaction, turtle
from tests.kb_node.storage.test_history import A, B, C, move

CHAIR1 = v.entity_iri("chair1")
ids = iter(range(1000, 9999))


def add(semantic_map, *names, verb="add", **fields):
    triples = [t for name in names for t in chair(name)]
    return semantic_map.commit(transaction(next(ids), triples, verb=verb, **fields))


def order(semantic_map, name, before, after):
    return semantic_map.commit(move(next(ids), name, before, after, verb="update"))


def settle(semantic_map, name, before, after):
    return semantic_map.commit(move(next(ids), name, before, after, source="scene"))


def take_back(semantic_map, commit=None, **fields):
    return undo(semantic_map, semantic_map._journal, Undo(id=str(next(ids)), commit=commit, **fields))


def triples(semantic_map):
    return set(semantic_map.abox())


def test_a_commit_is_undone_by_another_one(semantic_map):
    add(semantic_map, "chair1")
    before = triples(semantic_map), semantic_map.entity("chair1").pose
    order(semantic_map, "chair1", A, B)
    commit = take_back(semantic_map, 2, agent="ann")
    assert (commit.seq, commit.undoes, commit.verb, commit.agent) == (3, (2,), "undo", "ann")
    assert commit.reason.startswith("undo 2: ")
    (chair1,) = semantic_map.entities()
    assert (triples(semantic_map), chair1.pose) == before
    assert semantic_map.entity("chair1").pose_provenance.commit == 3
    take_back(semantic_map, 1)
    assert list(semantic_map.entities()) == []


def test_removed_entities_are_restored(semantic_map):
    add(semantic_map, "chair1", "chair2")
    before = triples(semantic_map)
    semantic_map.commit(transaction("gone", (), [*chair("chair1"), *chair("chair2")], verb="clear"))
    assert {e.name for e in take_back(semantic_map).changed} == {"chair1", "chair2"}
    assert triples(semantic_map) == before


def test_undo_without_a_number_undoes_client_commits_in_reverse_order(semantic_map):
    add(semantic_map, "chair0", verb="", source="file")
    add(semantic_map, "chair1")
    settle(semantic_map, "chair1", A, B)
    add(semantic_map, "chair2")
    settle(semantic_map, "chair2", A, B)
    settle(semantic_map, "chair2", B, C)
    assert take_back(semantic_map).undoes == (4, 5, 6)
    assert take_back(semantic_map).undoes == (2, 3)
    assert [e.name for e in semantic_map.entities()] == ["chair0"]
    with pytest.raises(errors.Refused, match="there is nothing to undo"):
        take_back(semantic_map)


def test_objects_on_a_removed_table_are_restored_with_it(semantic_map):
    add(semantic_map, "table1", "cup1")
    order(semantic_map, "table1", A, B)
    settle(semantic_map, "cup1", A, C)
    assert take_back(semantic_map).undoes == (2, 3)
    assert semantic_map.entity("cup1").pose.position_m == A


def test_settling_after_an_undo_is_undone_with_the_next(semantic_map):
    add(semantic_map, "chair1")
    order(semantic_map, "chair1", A, B)
    settle(semantic_map, "chair1", B, C)
    take_back(semantic_map)
    settle(semantic_map, "chair1", A, B)
    assert take_back(semantic_map).undoes == (1, 5)
    assert list(semantic_map.entities()) == []


def test_entities_added_by_the_scene_are_not_settling(semantic_map):
    add(semantic_map, "chair1")
    add(semantic_map, "chair2", verb="", source="scene")
    assert take_back(semantic_map).undoes == (1,)
    assert [e.name for e in semantic_map.entities()] == ["chair2"]


def test_undoing_an_undo_repeats_the_change(semantic_map):
    add(semantic_map, "chair1")
    done = triples(semantic_map)
    first = take_back(semantic_map)
    assert take_back(semantic_map, first.seq).undoes == (2,)
    assert triples(semantic_map) == done
    assert take_back(semantic_map).undoes == (1,)


def test_a_repeated_command_undoes_once(semantic_map):
    add(semantic_map, "chair1")
    add(semantic_map, "chair2")
    journal = semantic_map._journal
    assert undo(semantic_map, journal, Undo(id="same")) == undo(semantic_map, journal, Undo(id="same"))
    assert [e.name for e in semantic_map.entities()] == ["chair1"]


def says(text):
    return lambda semantic_map: semantic_map.commit(transaction(next(ids), turtle(text), verb="update"))


RESTS = {
    "moved since": lambda m: order(m, "chair1", A, B),
    "removed since": lambda m: m.commit(transaction(next(ids), (), chair("chair1"), reason="gone")),
    "given a size since": lambda m: m.commit(
        transaction(next(ids), entity_triples.size(CHAIR1, v.entity_iri("chair1_size"), (1.0, 1.0, 1.0)))
    ),
    "spoken of since": says(":chair2 dm:isLocatedIn :kitchen1 . :kitchen1 dm:near :chair1 ."),
    "shared since": says(":chair2 dm:hasPosition :chair1_coordinates ."),
}


@pytest.mark.parametrize("rest", RESTS.values(), ids=RESTS.keys())
def test_a_commit_that_later_ones_depend_on_cannot_be_undone(semantic_map, rest):
    add(semantic_map, "chair2")
    add(semantic_map, "chair1", reason="a chair")
    rest(semantic_map)
    before = semantic_map.seq, triples(semantic_map)
    with pytest.raises(errors.Refused, match=r"commit 2 .*cannot be undone"):
        take_back(semantic_map, 2)
    assert (semantic_map.seq, triples(semantic_map)) == before
    take_back(semantic_map, 3)
    take_back(semantic_map, 2)
    assert [e.name for e in semantic_map.entities()] == ["chair2"]


def test_the_error_names_the_commit_that_depends_on_it(semantic_map):
    add(semantic_map, "chair1", reason="a chair")
    order(semantic_map, "chair1", A, B)
    with pytest.raises(
        errors.Refused,
        match=r"commit 1 \(a chair\) cannot be undone: commit 2 \(\) depends on it; undo that one first:",
    ):
        take_back(semantic_map, 1)


def test_the_error_does_not_name_undone_commits(semantic_map):
    """The undo is not named either, because undoing it leads to the same state."""
    add(semantic_map, "chair1", reason="a chair")
    order(semantic_map, "chair1", A, B)
    says(":chair1 dm:hasPreferredReference :r . :r dm:lexicalReference 'stool' .")(semantic_map)
    take_back(semantic_map, 3)
    with pytest.raises(errors.Refused, match=r"commit 2 .* depends on it"):
        take_back(semantic_map, 1)
    take_back(semantic_map, 2)
    take_back(semantic_map, 1)
    assert not list(semantic_map.entities())


def test_other_changes_of_the_same_entity_do_not_prevent_it(semantic_map):
    add(semantic_map, "chair1")
    order(semantic_map, "chair1", A, B)
    says(":chair1 dm:hasPreferredReference :r . :r dm:lexicalReference 'stool' .")(semantic_map)
    take_back(semantic_map, 2)
    chair1 = semantic_map.entity("chair1")
    assert (chair1.pose.position_m, chair1.preferred_reference) == (A, "stool")


def test_an_inconsistent_result_is_rejected_with_the_explanation(semantic_map):
    add(semantic_map, "chair1")
    semantic_map.commit(transaction("no chair", (), chair("chair1")))
    says(":x dm:isLocatedIn :chair1 .")(semantic_map)
    with pytest.raises(errors.Inconsistent, match="commit 2 cannot be undone: chair1 cannot be") as caught:
        take_back(semantic_map, 2)
    assert caught.value.explanation is not None


@pytest.mark.parametrize(
    ("commit", "fields", "text"),
    [
        (9, {}, "there is no commit 9 yet; the last one is 3"),
        (2, {}, "commit 2 was already undone by commit 3"),
        (1, {"source": "perception"}, "commit 1 was made by an operator, so only an operator may undo it"),
        (1, {"source": "scene"}, "commit 1 was made by an operator"),
    ],
)
def test_invalid_undos_are_rejected(semantic_map, commit, fields, text):
    add(semantic_map, "chair1")
    order(semantic_map, "chair1", A, B)
    take_back(semantic_map)
    with pytest.raises(errors.Refused, match=text):
        take_back(semantic_map, commit, **fields)


ABOUT_NO_ENTITY = {
    "an annotation": "<urn:map> rdfs:comment 'of the ground floor' .",
    "a class": ":Barstool rdfs:subClassOf dm:Chair .",
    "an individual that is none": ":x dm:lexicalReference 'ghost' .",
}


@pytest.mark.parametrize("text", ABOUT_NO_ENTITY.values(), ids=ABOUT_NO_ENTITY.keys())
def test_a_commit_without_entities_is_undone_once(semantic_map, text):
    assert not says(text)(semantic_map).names
    add(semantic_map, "chair1")
    first = take_back(semantic_map, 1)
    order(semantic_map, "chair1", A, B)
    with pytest.raises(errors.Refused, match="commit 1 was already undone by commit 3"):
        take_back(semantic_map, 1)
    again = take_back(semantic_map, first.seq)
    assert again.inserted == first.retracted
    take_back(semantic_map, 1)
    says(text)(semantic_map)
    with pytest.raises(errors.Refused, match=f"commit 1 was already undone by commit {again.seq + 1}"):
        take_back(semantic_map, 1)


def test_an_undo_survives_a_restart(semantic_map):
    add(semantic_map, "chair1")
    take_back(semantic_map)
    expected = home.state(semantic_map)
    again = home.reopened(semantic_map)
    assert home.state(again) == expected
    with pytest.raises(errors.Refused, match="nothing to undo"):
        take_back(again)
    home.close(again)


def test_a_replaced_tbox_is_undone_and_restored(semantic_map):
    add(semantic_map, "chair1")
    before, tbox = semantic_map.entity("chair1").types, semantic_map.tbox
    replace(semantic_map, "t", NEW_CLASSES)
    changed = semantic_map.tbox
    commit = take_back(semantic_map)
    assert (commit.tbox, commit.undoes, commit.verb) == (True, (2,), "undo")
    assert semantic_map.tbox == tbox
    assert "Bench" not in semantic_map.classes.iris
    assert semantic_map.entity("chair1").types == before
    with pytest.raises(errors.Refused, match="commit 2 was already undone by commit 3"):
        take_back(semantic_map, 2)
    take_back(semantic_map, 3)
    assert semantic_map.tbox == changed
    again = home.reopened(semantic_map)
    assert again.tbox == changed
    home.close(again)


def test_a_tbox_that_the_map_needs_cannot_be_undone(semantic_map):
    replace(semantic_map, "t", NEW_CLASSES)
    semantic_map.commit(transaction("bench", turtle(":bench1 a dm:Bench .")))
    before = home.state(semantic_map)
    with pytest.raises(errors.Refused, match="does not fit the TBox: unknown class 'Bench'") as caught:
        take_back(semantic_map, 1)
    assert caught.value.text.startswith("commit 1 cannot be undone: ")
    assert caught.value.text.endswith("semmap load --tbox FILE")
    assert home.state(semantic_map) == before


def test_a_tbox_that_was_replaced_again_waits_for_the_later_undo(semantic_map):
    first = semantic_map.tbox
    replace(semantic_map, "t", NEW_CLASSES)
    replace(semantic_map, "u", NEW_CLASSES + "dm:Pew a owl:Class .")
    with pytest.raises(errors.Refused, match="undo that one first: semmap undo 2"):
        take_back(semantic_map, 1)
    take_back(semantic_map, 2)
    take_back(semantic_map, 1)
    assert semantic_map.tbox == first


def test_imports_of_a_tbox_are_undone_with_it(semantic_map):
    mine = turtle(":chair9 a dm:Chair .")
    before = triples(semantic_map)
    semantic_map.replace_tbox(
        transaction("t", mine, verb="load"), rdf.parse(NEW_CLASSES.encode(), "t", label_prefix="n")
    )
    assert "chair9" in {entity.name for entity in semantic_map.entities()}
    take_back(semantic_map)
    assert triples(semantic_map) == before
