import pytest

from semmap.nodes.kb_node.answers.entity_queries import CurrentState
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.bridge import Entities
from semmap.schemas.commands import Get
from semmap.schemas.commits import Edit, Statement
from tests.kb_node.home import chair, transaction, turtle

PEOPLE = turtle(
    """
    @prefix ex: <http://example.org/people/> .
    ex:anna a ex:Person , owl:NamedIndividual ; rdfs:label "Anna Smith"@en ; ex:age 41 ;
        ex:address [ ex:city "Rome" ] ; ex:knows ex:bob .
    ex:bob a ex:Person ; ex:knows ex:anna . ex:untyped ex:employs ex:anna .
    dm:hasColor rdfs:comment "of the file" . ex:Person a owl:Class . ex:Robot rdfs:subClassOf ex:Person .
    ex:knows a owl:ObjectProperty . [] ex:about ex:bob .
    """
)


@pytest.fixture
def people(stateful_map):
    """A map with `chair1`, `kitchen1`, two persons and an organisation without a class."""
    stateful_map.commit(transaction("people", PEOPLE))
    return stateful_map


def names(semantic_map):
    return [individual.name for individual in semantic_map.individuals.list()]


def edit(name, *statements, **fields):
    return Edit(name=name, set=tuple(Statement(property=p, values=(o,)) for p, o in statements), **fields)


def test_entities_their_descriptions_schemas_and_the_tbox_are_not_listed(people):
    assert names(people) == ["anna", "bob", "untyped"]
    assert CurrentState(people).entities(Entities(all=True))[2:] == people.individuals.list()
    assert [e.name for e in CurrentState(people).entities(Entities(all=True))][:2] == ["chair1", "kitchen1"]


def test_individuals_are_listed_by_a_class_that_only_the_map_uses(people):
    found = CurrentState(people).entities(Entities(class_="Person", all=True))
    assert [(e.name, e.class_, e.in_space, e.pose) for e in found] == [
        ("anna", "Person", False, None),
        ("bob", "Person", False, None),
    ]
    with pytest.raises(errors.UnknownClass):
        CurrentState(people).entities(Entities(class_="Persona", all=True))


@pytest.mark.parametrize(
    "word", ["anna", "<http://example.org/people/anna>", "http://example.org/people/anna"]
)
def test_an_individual_has_its_labels_properties_and_what_refers_to_it(people, word):
    found = CurrentState(people).entity(Get(name=word))
    assert (found.iri, found.class_, found.preferred_reference) == (
        "http://example.org/people/anna",
        "Person",
        "Anna Smith",
    )
    assert found.properties == {"address": ("[city Rome]",), "age": (41,), "knows": ("bob",)}
    assert found.referred_by == {"employs": ("untyped",), "knows": ("bob",)}


def test_an_entity_is_found_by_its_iri(people):
    assert CurrentState(people).entity(Get(name=v.entity_iri("chair1"))).name == "chair1"


@pytest.mark.parametrize("word", ["carla", "<urn:carla>", "_:x", "chair1_coordinates"])
def test_what_is_not_an_individual_is_unknown(people, word):
    with pytest.raises(errors.UnknownName):
        CurrentState(people).entity(Get(name=word))


def test_a_name_of_several_individuals_is_ambiguous_and_their_iris_are_not(people):
    people.commit(transaction(2, turtle("<urn:other/anna> a <urn:Cat> .")))
    with pytest.raises(errors.BadRequest, match=r"'anna' is ambiguous: <http.*give the IRI"):
        people.described("anna")
    assert people.described("urn:other/anna").class_ == "Cat"


def test_properties_of_an_individual_are_set_and_unset(people):
    people.commit(transaction(2, edit=[edit("anna", ("seats", "2"), ("note", "x"))]))
    people.commit(transaction(3, edit=[edit("bob", ("hasColor", "anna"))]))
    assert people.described("anna").properties["seats"] == 2
    assert people.described("bob").properties["hasColor"] == ("anna",)
    people.commit(transaction(4, edit=[Edit(name="anna", unset=(Statement(property="seats"),))]))
    assert "seats" not in people.described("anna").properties


def test_an_individual_has_no_pose_to_change_and_one_of_the_tbox_cannot_be_changed(people):
    with pytest.raises(errors.Refused, match="anna is not in space, so only its class"):
        people.commit(transaction(2, edit=[edit("anna", at=(0.0, 0.0, 0.0))]))
    assert people.described("color_red").name == "color_red"
    with pytest.raises(errors.Refused, match="part of the TBox"):
        people.commit(transaction(3, edit=[edit("color_red", ("note", "x"))]))


def test_an_individual_is_removed_with_its_nameless_values_and_what_refers_to_it(people):
    people.commit(transaction(2, remove=["anna", "chair1"]))
    assert names(people) == ["bob"]  # the other was only the employer of anna
    assert not any("anna" in "".join(t) or "Rome" in t[2] for t in people.abox())
    people.commit(transaction(3, remove=["<http://example.org/people/bob>"]))
    assert names(people) == []


def test_names_follow_commits_reverted_ones_and_individuals_that_get_a_place(people):
    assert names(people) == ["anna", "bob", "untyped"]
    people.commit(transaction(2, turtle("<urn:x:dora> a <urn:Cat> .")))
    assert names(people) == ["anna", "bob", "dora", "untyped"]
    people.commit(transaction(3, turtle("<http://example.org/people/bob> a dm:Chair .")))
    assert names(people) == ["anna", "dora", "untyped"]
    people.commit(transaction(4, retract=turtle("<urn:x:dora> a <urn:Cat> .")))
    assert names(people) == ["anna", "untyped"]
    people.commit(transaction(5, chair("chair7")))
    assert names(people) == ["anna", "untyped"]


def test_entities_are_listed_by_a_class_that_only_the_map_declares(people):
    own = "<urn:x#Jig> a owl:Class ; rdfs:subClassOf dm:Chair . <urn:x#jig1> a <urn:x#Jig> ."
    people.commit(transaction(2, turtle(own)))
    for word in ("Jig", "urn:x#Jig"):
        assert [e.name for e in CurrentState(people).entities(Entities(class_=word))] == ["jig1"]
    with pytest.raises(errors.UnknownClass):
        CurrentState(people).entities(Entities(class_="Jigs"))


def test_equal_individuals_are_one(people):
    people.commit(transaction(2, turtle("<http://example.org/people/anna> owl:sameAs <urn:x:annie> .")))
    (anna, *_) = people.individuals.list()
    assert (anna.name, anna.properties["sameAs"]) == ("anna", ("annie",))
