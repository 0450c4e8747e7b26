"""The nouns, states and places of objects for descriptions."""

from __future__ import annotations

import pytest
from msgspec import structs

from semmap.nodes.kb_node.answers.inventories import Inventories, Nouns, _uncapitalized
from semmap.nodes.kb_node.answers.map_states import PastState, PresentState
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import Pose
from tests.kb_node import home
from tests.kb_node.home import transaction, turtle

TBOX = (
    *home.TBOX,
    *turtle(
        "dm:Table a owl:Class ; rdfs:subClassOf dm:Object ; rdfs:label 'table'@en ."
        "dm:Stool a owl:Class ; rdfs:subClassOf dm:Seat ."
        "dm:Cup a owl:Class ; rdfs:subClassOf dm:Object ; rdfs:label 'Cup' ."
        "dm:Living_Room a owl:Class ; rdfs:subClassOf dm:Location ."
        "dm:isOpen a owl:DatatypeProperty ; rdfs:range xsd:boolean ; rdfs:label 'is open'@en ."
        "dm:isLit a owl:DatatypeProperty ; rdfs:range xsd:boolean ; rdfs:label 'is lit'@en ."
        "dm:broken a owl:DatatypeProperty ; rdfs:range xsd:boolean ; rdfs:label 'broken'@en ."
        "dm:isOpen a owl:FunctionalProperty . dm:isLit a owl:FunctionalProperty ."
        "dm:broken a owl:FunctionalProperty . dm:hasSubLocation a owl:ObjectProperty ."
    ),
)


def described(name, class_, at, size_m=None, **fields):
    return entity_triples.describe(
        name,
        v.dm(class_),
        pose=Pose(position_m=at),
        **({} if size_m is None else {"size_m": size_m}),
        **fields,
    )


@pytest.fixture(scope="module")
def rooms(tmp_path_factory):
    made = home.new_map(tmp_path_factory.mktemp("map"), TBOX)
    triples = [
        *described("kitchen1", "Kitchen", (0.0, 0.0, 0.0), (6.0, 6.0, 3.0)),
        *described("corner1", "Living_Room", (2.0, 2.0, 0.0), (1.5, 1.5, 3.0)),
        *described("far1", "Kitchen", (40.0, 0.0, 0.0), (2.0, 2.0, 3.0)),
        *described("part1", "Kitchen", (60.0, 0.0, 0.0), (2.0, 2.0, 3.0)),
        *described("table1", "Table", (0.0, 0.0, 0.0), (1.0, 1.0, 0.7)),
        *described("cup1", "Cup", (0.0, 0.0, 0.7), (0.1, 0.1, 0.1)),
        *described("chair1", "Chair", (0.8, 0.0, 0.0), (0.4, 0.4, 0.9)),
        *described("stool1", "Stool", (-2.8, -2.8, 0.0), (0.3, 0.3, 0.5)),
        *turtle(":far1 dm:hasSubLocation :part1 . :cup1 dm:isOpen true ; dm:isLit true ; dm:broken true ."),
    ]
    made.commit(transaction(1, triples))
    yield made
    home.close(made)


@pytest.fixture(scope="module")
def nouns(rooms):
    return Nouns(rooms.classes)


@pytest.fixture(scope="module", params=["present", "past"])
def inventories(request, rooms, nouns):
    entities = tuple(rooms.entities())
    state = PresentState(rooms) if request.param == "present" else PastState(entities, rooms.classes.limits)
    return Inventories(state, nouns)


def test_an_object_is_on_its_support_and_in_its_place(inventories):
    cup = inventories.whole().things["cup1"]
    assert (cup.at, cup.place) == (("on", "table1"), "kitchen1")
    assert cup.state == "lit and open"
    assert cup.volume_m3 == pytest.approx(0.001)


def test_a_seat_is_round_the_nearest_table(inventories):
    things = inventories.whole().things
    assert things["chair1"].at == ("round", "table1")
    assert things["stool1"].at is None
    assert things["table1"].at is None


def test_a_place_is_within_the_one_that_it_is_stated_to_be_part_of(inventories):
    places = inventories.whole().places
    assert {name: place.within for name, place in places.items()} == {
        "kitchen1": None,
        "corner1": None,
        "far1": None,
        "part1": "far1",
    }


def test_numbers_have_no_locations(inventories):
    things = inventories.numbers().things
    assert set(things) == {"table1", "cup1", "chair1", "stool1"}
    assert all(thing.at is None and thing.place is None for thing in things.values())
    assert set(inventories.numbers().places) == {"kitchen1", "corner1", "far1", "part1"}


def test_what_surrounds_an_object(rooms, nouns):
    inventories = Inventories(PresentState(rooms), nouns)
    assert set(inventories.around(rooms.find("table1")).things) >= {"table1", "cup1", "chair1"}
    assert set(inventories.around(rooms.find("far1")).things) == set()
    assert "cup1" in inventories.around(rooms.find("kitchen1")).things


@pytest.mark.parametrize(
    ("reference", "noun"),
    [
        (None, "chair"),
        ("red chair", "red chair"),
        ("Red Chair", "red chair"),
        ("Red chair", "Red chair"),
        ("throne", "throne"),
        ("Bob", "Bob"),
        ("the chair", "chair"),
        ("my old chair", "chair"),
        ("nothing", "chair"),
        ("chair no 4", "chair"),
        ("one two three four", "chair"),
        ("arm-chair", "arm-chair"),
        (" throne ", "throne"),
        ("", "chair"),
    ],
)
def test_a_label_is_a_noun_unless_it_is_a_name_or_a_phrase(rooms, nouns, reference, noun):
    chair = structs.replace(rooms.find("chair1"), preferred_reference=reference)
    assert nouns.of(chair) == noun


@pytest.mark.parametrize(
    ("label", "noun"),
    [
        ("Designed handle", "designed handle"),
        ("Designed Handle", "designed handle"),
        ("TV", "TV"),
        ("TV set", "TV set"),
        ("A", "A"),
        ("cup", "cup"),
        ("McCup", "McCup"),
    ],
)
def test_the_label_of_a_class_is_a_common_noun(label, noun):
    assert _uncapitalized(label) == noun


def test_the_kind_of_a_thing_is_the_label_or_the_words_of_its_class(rooms, nouns):
    kinds = {name: nouns.kind(rooms.find(name)) for name in ("chair1", "cup1", "corner1", "stool1")}
    assert kinds == {"chair1": "chair", "cup1": "cup", "corner1": "living room", "stool1": "stool"}
    assert nouns.states["isOpen"] == "open"
    assert "broken" not in nouns.states
