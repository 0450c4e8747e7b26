"""A file that is loaded again replaces what it states about the entities that are there."""

import pytest

from semmap.nodes.kb_node.documents import document_change, rdf
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.bridge import LoadDocument
from semmap.schemas.commits import Edit, Transaction
from semmap.schemas.entities import Pose, orientation_from_yaw
from tests.kb_node import home
from tests.kb_node.entities import test_aligned_values as soma
from tests.kb_node.home import turtle


def loaded(semantic_map, text, *, add_only=False):
    """Load a document and return what it replaced; blank nodes have new labels in each document."""
    number = semantic_map.seq
    triples = rdf.parse((home.PREFIXES + text).encode(), "file", label_prefix=f"d{number}")
    load = LoadDocument(
        id=f"d{number}", source="file", content=b"", filename="f", replace=False, skip_unknown=False,
        add_only=add_only,
    )  # fmt: skip
    transaction, _, replaced = document_change.make_document_transaction(semantic_map, load, triples)
    semantic_map.commit(transaction)
    return replaced


def edited(semantic_map, **fields):
    """Commit an edit of `a`."""
    semantic_map.commit(
        Transaction(id=f"e{semantic_map.seq}", source="operator", edit=(Edit(name="a", **fields),))
    )


def chair(x=1, size=1, label="chair", more=""):
    """Return a chair whose parts are nameless."""
    return (
        f":a a dm:Chair ; dm:hasPosition [ a dm:Coordinates ; dm:float_coordinates_x {x} ;"
        " dm:float_coordinates_y 2 ; dm:float_coordinates_z 0 ] ;"
        f" dm:hasSize [ dm:float_size_x {size} ; dm:float_size_y 1 ; dm:float_size_z 1 ] ;"
        f' dm:hasPreferredReference [ a dm:PreferredReference ; dm:lexicalReference "{label}" ] {more} .'
    )


def test_the_same_file_changes_nothing(semantic_map):
    loaded(semantic_map, chair())
    before = home.state(semantic_map)
    assert not loaded(semantic_map, chair()).retract
    assert home.state(semantic_map) == before


def test_an_edited_file_replaces_pose_size_and_label(semantic_map):
    loaded(semantic_map, chair())
    count = len(semantic_map.abox())
    loaded(semantic_map, chair(x=5, size=2, label="stool"))
    entity = semantic_map.entity("a")
    assert entity.pose == Pose(position_m=(5.0, 2.0, 0.0))
    assert (entity.size_m, entity.preferred_reference) == ((2.0, 1.0, 1.0), "stool")
    assert len(semantic_map.abox()) == count


def test_what_the_file_does_not_state_stays(semantic_map):
    loaded(semantic_map, chair(more='; dm:hasAlternativeReference [ dm:lexicalReference "seat" ]'))
    loaded(semantic_map, ":a dm:hasSize [ dm:float_size_x 3 ; dm:float_size_y 1 ; dm:float_size_z 1 ] .")
    entity = semantic_map.entity("a")
    assert (entity.size_m, entity.pose) == ((3.0, 1.0, 1.0), Pose(position_m=(1.0, 2.0, 0.0)))
    assert (entity.preferred_reference, entity.alternative_references) == ("chair", ("seat",))


def test_a_file_without_an_orientation_turns_an_entity_back(semantic_map):
    named = (
        chair()
        .replace("dm:hasPosition [", "dm:hasPosition :p . :p")
        .replace("0 ] ; dm:hasSize", "0 . :a dm:hasSize")
    )
    loaded(semantic_map, named)
    edited(semantic_map, at=(3.0, 3.0, 0.0), orientation=orientation_from_yaw(1.0))
    loaded(semantic_map, named)
    assert semantic_map.entity("a").pose == Pose(position_m=(1.0, 2.0, 0.0))


def test_aliases_are_replaced_together_and_shared_references_stay(semantic_map):
    words = ':r a dm:AlternativeReference ; dm:lexicalReference "seat" . '
    loaded(
        semantic_map,
        words
        + ":a a dm:Chair ; dm:hasAlternativeReference :r . :b a dm:Chair ; dm:hasAlternativeReference :r .",
    )
    loaded(semantic_map, ':a dm:hasAlternativeReference [ dm:lexicalReference "perch" ] .')
    assert semantic_map.entity("a").alternative_references == ("perch",)
    assert semantic_map.entity("b").alternative_references == ("seat",)


def test_labels_are_replaced_by_language(semantic_map):
    loaded(semantic_map, ':a a dm:Chair ; rdfs:label "chair"@en , "Stuhl"@de .')
    loaded(semantic_map, ':a rdfs:label "Sessel"@de .')
    labels = semantic_map.reasoner.about(v.entity_iri("a"))[v.RDFS_LABEL]
    assert set(labels) == {'"chair"@en', '"Sessel"@de'}


def test_nameless_parts_are_replaced_by_structure(semantic_map):
    def notes(*texts):
        return ":a a dm:Chair ; dm:note " + " , ".join(f'[ dm:text "{t}" ]' for t in texts) + " ."

    def known():
        return sorted(o for _, p, o in semantic_map.abox() if p.endswith("#text>"))

    loaded(semantic_map, notes("one", "two"))
    loaded(semantic_map, notes("one", "three"))
    assert known() == ['"one"', '"three"']
    loaded(semantic_map, notes("one", "three", "four"))  # one more
    assert known() == ['"four"', '"one"', '"three"']
    loaded(semantic_map, notes("five"))  # unclear which one it would replace
    assert known() == ['"five"', '"four"', '"one"', '"three"']
    loaded(semantic_map, ":a dm:note [ a dm:Remark ; dm:text 'six' ] .".replace("a dm:Remark ; ", ""))
    assert len(known()) == 5


def test_a_nameless_axiom_is_not_added_again(semantic_map):
    axiom = "[] a owl:Axiom ; owl:annotatedSource :a ; rdfs:comment 'why' . :a a dm:Chair ."
    loaded(semantic_map, axiom)
    count = len(semantic_map.abox())
    loaded(semantic_map, axiom + ":b a dm:Chair .")
    assert len(semantic_map.abox()) == count + 1


def test_values_of_functional_properties_are_replaced_with_what_follows(stateful_map):
    functional = next(
        p for p in stateful_map.classes.property_table.by_iri.values() if p.functional and p.is_data
    )
    subject = "<http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_1#chair1>"
    stateful_map.commit(
        home.transaction(
            "one", [(subject, functional.iri, '"true"^^<http://www.w3.org/2001/XMLSchema#boolean>')]
        )
    )
    loaded(stateful_map, f"{subject} {functional.iri} false .")
    assert stateful_map.entity("chair1").properties[functional.name] is False


def test_a_file_that_may_only_add_is_rejected_if_it_has_other_values(semantic_map):
    loaded(semantic_map, chair())
    before = home.state(semantic_map)
    with pytest.raises(errors.NameTaken) as rejected:
        loaded(semantic_map, chair(x=9), add_only=True)
    assert rejected.value.text == (
        "f has other values for a; to replace those of the map, load it without --add-only"
    )
    assert home.state(semantic_map) == before
    loaded(semantic_map, chair() + ":b a dm:Chair .", add_only=True)
    assert semantic_map.entity("b").class_ == "Chair"


def test_the_tbox_is_not_replaced(tmp_path):
    described = [*home.TBOX, *turtle(":a a dm:Chair ; rdfs:label 'one' .")]
    semantic_map = home.new_map(tmp_path, described)
    assert not loaded(semantic_map, ":a rdfs:label 'two' .").retract
    home.close(semantic_map)


@pytest.fixture
def kitchen(tmp_path):
    """A map in the vocabularies of SOMA and KnowRob with a drawer."""
    made = home.new_map(tmp_path, soma.triples(soma.TBOX, "t"))
    loaded(made, soma.PREFIXES + soma.DRAWER)
    yield made
    home.close(made)


MOVED = soma.PREFIXES + soma.DRAWER.replace("1.4 0.9 0.75", "2.0 2.0 0.75")


def test_a_nameless_pose_in_another_vocabulary_is_replaced(kitchen):
    count = len(kitchen.abox())
    loaded(kitchen, soma.PREFIXES + soma.DRAWER)
    assert len(kitchen.abox()) == count
    loaded(kitchen, MOVED)
    assert kitchen.entity("drawer1").pose.position_m == (2.0, 2.0, 0.68)
    assert (
        soma.said(kitchen, soma.TRANSLATION) == ['"2.0 2.0 0.75"^^<soma:array_double>']
        or len(soma.said(kitchen, soma.TRANSLATION)) == 1
    )
    assert len(kitchen.abox()) == count


def test_a_file_replaces_a_pose_that_was_changed_by_hand(kitchen):
    soma.edited(kitchen, at=(7.0, 7.0, 7.0))
    loaded(kitchen, MOVED)
    assert kitchen.entity("drawer1").pose.position_m == (2.0, 2.0, 0.68)
    assert len(soma.said(kitchen, soma.TRANSLATION)) == 1


def test_of_two_poses_in_an_older_map_a_file_leaves_its_own(kitchen):
    second = rdf.parse(MOVED.replace("2.0 2.0 0.75", "4.0 4.0 4.0").encode(), "m", label_prefix="second")
    home.restated(kitchen, "old", second)
    loaded(kitchen, MOVED)
    assert kitchen.entity("drawer1").pose.position_m == (2.0, 2.0, 0.68)
    assert len(soma.said(kitchen, soma.TRANSLATION)) == len(soma.said(kitchen, soma.LOCALIZATION)) == 1


def test_a_pose_replaces_that_of_another_vocabulary(kitchen):
    own = (
        "<http://lab.org/kitchen.owl#drawer1> dm:hasPosition [ dm:float_coordinates_x 3 ;"
        " dm:float_coordinates_y 3 ; dm:float_coordinates_z 3 ] ."
    )
    loaded(kitchen, own)
    assert kitchen.entity("drawer1").pose.position_m == (3.0, 3.0, 3.0)
    assert not soma.said(kitchen, soma.LOCALIZATION)
    loaded(kitchen, MOVED)
    assert kitchen.entity("drawer1").pose.position_m == (2.0, 2.0, 0.68)
    assert not any("float_coordinates" in p for _, p, _ in kitchen.abox())


def test_a_pose_that_two_entities_share_stays_with_the_other(kitchen):
    (localization,) = soma.said(kitchen, soma.LOCALIZATION)
    other = "<http://lab.org/kitchen.owl#drawer2>"
    twin = soma.triples("map:drawer2 a soma:Drawer .")
    kitchen.commit(home.transaction("twin", [*twin, (other, soma.LOCALIZATION, localization)]))
    loaded(kitchen, MOVED)
    assert kitchen.entity("drawer1").pose.position_m == (2.0, 2.0, 0.68)
    assert kitchen.entity("drawer2").pose.position_m == (1.4, 0.9, 0.75)


def test_a_pose_by_another_name_of_an_entity_replaces_its_pose(semantic_map):
    loaded(semantic_map, chair() + ":twin owl:sameAs :a .")
    count = len(semantic_map.abox())
    again = chair(x=5, size=2).replace(":a a dm:Chair", ":twin a dm:Chair")
    loaded(semantic_map, again)
    entity = semantic_map.resolve("a") if "a" in semantic_map.names else semantic_map.resolve("twin")
    assert (entity.pose.position_m, entity.size_m) == ((5.0, 2.0, 0.0), (2.0, 1.0, 1.0))
    assert len(semantic_map) == 1
    assert len(semantic_map.abox()) <= count + 5  # the class and the label of the other name
    assert not loaded(semantic_map, again).retract


def test_a_second_pose_by_another_name_is_rejected_from_the_wire(semantic_map):
    loaded(semantic_map, chair() + ":twin owl:sameAs :a .")
    second = turtle(
        ":twin dm:hasPosition :p . :p dm:float_coordinates_x '9'^^xsd:float ;"
        " dm:float_coordinates_y '2'^^xsd:float ; dm:float_coordinates_z '0'^^xsd:float ."
    )
    with pytest.raises(errors.BadRequest, match="has two positions"):
        semantic_map.commit(home.transaction("w", second))
