"""Equal individuals are one entity, whichever of its names a change or a question uses."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.answers import answers, entity_queries
from semmap.nodes.kb_node.entities.equal_individuals import choose_primary, find_other_names
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Get, Relations
from semmap.schemas.commits import Edit, Statement, Transaction
from tests.kb_node import home
from tests.kb_node.home import transaction, turtle

AT = """dm:hasPosition [ dm:float_coordinates_x "1.0"^^xsd:float ; dm:float_coordinates_y "2.0"^^xsd:float ;
  dm:float_coordinates_z "0.0"^^xsd:float ]"""
A, B = v.entity_iri("a"), v.entity_iri("b")


def edit(number, **fields):
    return Transaction(id=str(number), source="operator", edit=(Edit(**fields),))


def names(semantic_map):
    return [entity.name for entity in semantic_map.entities()]


@pytest.fixture
def pair(semantic_map):
    """A map with a chair of two names; only `b` has a pose."""
    text = f":a a dm:Chair ; rdfs:label 'mine'@en . :b a dm:Chair ; {AT} . :a owl:sameAs :b ."
    semantic_map.commit(transaction(1, turtle(text)))
    return semantic_map


def test_equal_individuals_are_one_entity_with_what_is_known_of_either(pair):
    (entity,) = pair.entities()
    assert (entity.name, entity.other_names) == ("b", ("a",))
    assert entity.pose.position_m == (1.0, 2.0, 0.0)
    assert entity.preferred_reference == "mine"
    assert len(tuple(answers.find_entities(pair, "Chair"))) == 1
    assert next(info for info in pair.class_table() if info.name == "Chair").asserted == 1


@pytest.mark.parametrize("word", ["a", "b"])
def test_either_name_is_understood(pair, word):
    now = entity_queries.CurrentState(pair)
    assert pair.resolve(word).name == "b"
    assert now.entity(Get(name=word)).properties == {"sameAs": ("a",)}
    assert now.relations(Relations(name=word)) == ()


def test_equality_merges_entities_with_a_note_and_its_end_separates_them(semantic_map):
    semantic_map.commit(transaction(1, turtle(f":a a dm:Chair . :b a dm:Chair ; {AT} . :c a dm:Chair .")))
    link = turtle(":a owl:sameAs :b .")
    merged = semantic_map.commit(transaction(2, link))
    assert [gone.name for gone in merged.removed] == ["a"]
    assert [entity.name for entity in merged.changed] == ["b"]
    assert merged.notes == ("b and a are the same individual: one entity, b, which all these names refer to",)
    separated = semantic_map.commit(transaction(3, retract=link))
    assert {entity.name: entity.other_names for entity in separated.changed} == {"a": (), "b": ()}
    assert names(semantic_map) == ["a", "b", "c"]


def test_inferred_equality_counts(semantic_map):
    text = "dm:seatOf a owl:ObjectProperty , owl:FunctionalProperty ."
    semantic_map.commit(transaction(1, turtle(f"{text} :a a dm:Chair . :b a dm:Chair . :p a dm:Seat .")))
    semantic_map.commit(transaction(2, turtle(":p dm:seatOf :a .")))
    assert names(semantic_map) == ["a", "b", "p"]
    second = turtle(":p dm:seatOf :b .")
    semantic_map.commit(transaction(3, second))
    assert names(semantic_map) == ["a", "p"]
    assert semantic_map.entity("a").other_names == ("b",)
    semantic_map.commit(transaction(4, retract=second))
    assert names(semantic_map) == ["a", "b", "p"]


def test_two_poses_of_equal_individuals_are_rejected(semantic_map):
    elsewhere = AT.replace("1.0", "5.0")
    semantic_map.commit(transaction(1, turtle(f":a a dm:Chair ; {AT} . :b a dm:Chair ; {elsewhere} .")))
    with pytest.raises(errors.BadRequest, match=r"^a \(the same as b\) has two positions: \(1, 2, 0\) and"):
        semantic_map.commit(transaction(2, turtle(":a owl:sameAs :b .")))
    assert names(semantic_map) == ["a", "b"]
    semantic_map.commit(edit(3, name="b", at=(1.0, 2.0, 0.0)))
    semantic_map.commit(transaction(4, turtle(":a owl:sameAs :b .")))
    semantic_map.commit(edit(5, name="a", at=(7.0, 2.0, 0.0)))  # of both
    assert semantic_map.entity("a").pose.position_m == (7.0, 2.0, 0.0)


def test_a_move_of_the_entity_moves_the_individual_that_has_the_pose(pair):
    before = len(pair.abox())
    pair.commit(edit(2, name="b", at=(4.0, 4.0, 0.0), ref="seat", size=(0.4, 0.5, 0.6)))
    pair.commit(edit(3, name="b", at=(5.0, 4.0, 0.0), ref="stool", size=(0.4, 0.5, 0.7)))
    (entity,) = pair.entities()
    assert entity.pose.position_m == (5.0, 4.0, 0.0)
    assert (entity.preferred_reference, entity.size_m) == ("stool", (0.4, 0.5, 0.7))
    assert len(pair.abox()) == before + 8  # a size and a label of four triples each
    assert not [t for t in pair.abox() if t[:2] == (A, v.HAS_POSITION)]


def test_a_value_replaces_that_of_the_other_individual(stateful_map):
    text = ":twin owl:sameAs :chair1 ; dm:isOpen true ; dm:note 'old' ."
    stateful_map.commit(transaction(1, turtle(text)))
    stateful_map.commit(edit(2, name="chair1", set=(Statement(property="isOpen", values=("false",)),)))
    expected = {"isOpen": False, "note": ("old",), "sameAs": ("twin",)}
    assert stateful_map.entity("chair1").properties == expected
    removed = (Statement(property="isOpen"), Statement(property="note", values=("old",)))
    stateful_map.commit(edit(3, name="chair1", unset=removed))
    assert stateful_map.entity("chair1").properties == {"sameAs": ("twin",)}
    assert not [t for t in stateful_map.abox() if t[1] in (v.dm("isOpen"), v.dm("note"))]


def test_a_value_may_be_given_by_another_name(stateful_map):
    stateful_map.commit(transaction(1, turtle("<http://o.org/hall> owl:sameAs :kitchen1 .")))
    located = Statement(property="isLocatedIn", values=("hall",))
    stateful_map.commit(edit(2, name="chair1", set=(located,)))
    assert stateful_map.entity("chair1").properties == {"isLocatedIn": ("kitchen1",)}


def test_an_entity_of_several_names_is_renamed(pair):
    pair.commit(edit(2, name="b", rename="throne"))
    assert [(entity.name, entity.other_names) for entity in pair.entities()] == [("throne", ("a",))]
    assert pair.entity("throne").pose.position_m == (1.0, 2.0, 0.0)


def test_a_rename_is_rejected_if_another_individual_would_give_the_name(semantic_map):
    semantic_map.commit(transaction(1, turtle(":a a dm:Chair . :b a dm:Chair . :a owl:sameAs :b .")))
    with pytest.raises(errors.Refused, match="a is the same as b, which would give it its name instead of c"):
        semantic_map.commit(edit(2, name="a", rename="c"))
    assert names(semantic_map) == ["a"]
    semantic_map.commit(edit(3, name="a", rename="aa"))
    assert [(entity.name, entity.other_names) for entity in semantic_map.entities()] == [("aa", ("b",))]


def test_a_class_is_that_of_all(pair):
    pair.commit(edit(2, name="b", class_iri=v.bare(v.dm("Seat"))))
    assert pair.entity("b").class_ == "Seat"
    assert [t for t in pair.abox() if t[1] == v.RDF_TYPE and t[0] in (A, B)] == [
        (B, v.RDF_TYPE, v.dm("Seat"))
    ]


def test_removing_the_entity_removes_all_its_individuals_and_undo_restores_them(pair):
    before = sorted(pair.abox()), pair.entity("b")
    gone = pair.commit(Transaction(id="2", source="operator", remove=("b",)))
    assert not pair.abox()
    pair.commit(Transaction(id="3", source="operator", insert=gone.retracted))
    assert (sorted(pair.abox()), pair.entity("b").other_names) == (before[0], before[1].other_names)


def test_names_and_poses_are_the_same_after_a_restart(pair):
    before = tuple(pair.entities())
    again = home.reopened(pair)
    assert tuple(again.entities()) == before
    again.checkpoint()
    third = home.reopened(again)
    assert tuple(third.entities()) == before
    home.close(third)


def test_the_primary_individual_depends_on_the_triples_only(pair):
    about, classes = pair.reasoner.about, pair.classes
    elsewhere, blank = "<http://o.org/a>", "_:n"
    assert choose_primary([blank, elsewhere, A, B], classes, about) == B  # it has the pose
    assert choose_primary([blank, elsewhere, A], classes, about) == A
    assert choose_primary([blank, "<http://o.org/b>", elsewhere], classes, about) == elsewhere
    assert find_other_names([A, B, blank, elsewhere, "<http://o.org/b>"], A) == ("b",)


def test_an_individual_of_another_namespace_with_the_same_name_is_no_obstacle(semantic_map):
    described = turtle("<http://x.org/a#mug> a dm:Chair . <http://x.org/b#mug> a dm:Chair .")
    link = turtle("<http://x.org/a#mug> owl:sameAs <http://x.org/b#mug> .")
    semantic_map.commit(transaction(1, [*described, *link]))
    (entity,) = semantic_map.entities()
    assert (entity.name, entity.iri, entity.other_names) == ("mug", "http://x.org/a#mug", ())


def test_triples_of_the_entity_include_those_of_its_equals(pair):
    (star,) = pair.stars(["b"])
    assert {s for s, _, _ in star.own} >= {A, B}
