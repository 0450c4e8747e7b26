"""Properties that can be set: their names, values and syntax."""

import pytest

from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.entities import PropertyInfo
from tests.kb_node import home, stating
from tests.kb_node.home import transaction, turtle
from tests.kb_node.stating import (
    adding,
    edited,
    properties,
    stated,
    statement,
    unstated,
)

CHAIR = v.entity_iri("chair1")


@pytest.mark.parametrize("word", ["isOpen", "is open", "IS_OPEN", "isopen", "dm:isOpen", v.dm("isOpen")])
def test_a_property_is_found_by_its_names(stateful_map, word):
    stated(stateful_map, word, "yes")
    assert properties(stateful_map) == {"isOpen": True}


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("isOpne", "unknown property 'isOpne'; did you mean isOpen"),
        ("xyzzy", "unknown property 'xyzzy'; see: semmap properties"),
        ("hasPosition", "hasPosition is changed with: semmap update chair1 --at X Y Z"),
        ("hasSize", "--size X Y Z"),
        ("hasPreferredReference", "--ref TEXT"),
        ("hasAlternativeReference", "--alt TEXT"),
        ("type", "--class CLASS"),
        ("label", "label is changed with: semmap update chair1 --ref TEXT"),
        ("position", "--at X Y Z"),
        ("size", "--size X Y Z"),
        ("lexicalReference", "unknown property"),
        (
            "sameAs",
            "'sameAs' is not changed by commands, but by files: semmap load FILE.ttl with the statement",
        ),
    ],
)
def test_an_unknown_property_is_reported_with_hints(stateful_map, word, said):
    with pytest.raises(errors.BadRequest) as caught:
        stated(stateful_map, word, "x")
    assert said in caught.value.text
    assert stateful_map.seq == 1


@pytest.mark.parametrize("word", ["color_red", "red", "Rosso", "dm:color_red", v.dm("color_red")])
def test_an_individual_of_the_tbox_is_found_by_its_names(stateful_map, word):
    stated(stateful_map, "hasColor", word)
    assert properties(stateful_map) == {"hasColor": ("color_red",)}


def test_the_range_selects_among_individuals_with_the_same_label(stateful_map):
    stated(stateful_map, "ha colore", "blue")
    assert properties(stateful_map) == {"hasColor": ("color_blue",)}


@pytest.mark.parametrize("word", ["_2nd", "2nd", "dm:2nd"])
def test_an_individual_with_a_made_name_is_listed_and_found_by_that(tmp_path, monkeypatch, word):
    second = turtle("dm:2nd a owl:NamedIndividual , dm:Color .")
    monkeypatch.setattr(stating, "TBOX", [*stating.TBOX, *second])
    made = stating.new_map(tmp_path)
    stated(made, "hasColor", word)
    assert properties(made) == {"hasColor": ("_2nd",)}
    rows = {row.name: row for row in made.classes.property_table.rows()}
    assert "_2nd" in rows["hasColor"].values
    home.close(made)


@pytest.mark.parametrize(
    ("range_", "word", "value"),
    [
        ("", "kitchen1", ("kitchen1",)),
        ("", v.bare(v.entity_iri("kitchen1")), ("kitchen1",)),
        ("", "to be cleaned", ("to be cleaned",)),
        ("rdfs:range xsd:integer", "7", (7,)),
        ("rdfs:range dm:Color", "rosso", ("color_red",)),
        ("a owl:AnnotationProperty", "7", None),
    ],
)
def test_an_rdf_property_takes_what_its_range_allows(tmp_path, monkeypatch, range_, word, value):
    plain = turtle(f"dm:plain a <{v.RDF}Property> ; {range_} .")
    monkeypatch.setattr(stating, "TBOX", [*stating.TBOX, *plain])
    made = stating.new_map(tmp_path)
    if value is None:
        with pytest.raises(errors.BadRequest, match="unknown property 'plain'"):
            stated(made, "plain", word)
    else:
        stated(made, "plain", word)
        assert properties(made) == {"plain": value}
    home.close(made)


def test_an_unknown_individual_is_rejected_with_suggestions(stateful_map):
    with pytest.raises(errors.UnknownName, match="hasColor takes color_blue, color_red"):
        stated(stateful_map, "hasColor", "xyzzy")
    with pytest.raises(errors.UnknownName, match="did you mean color_red"):
        stated(stateful_map, "hasColor", "color_rde")
    with pytest.raises(errors.UnknownName, match="named 'kitchen2'; did you mean kitchen1"):
        stated(stateful_map, "isLocatedIn", "kitchen2")
    with pytest.raises(errors.UnknownName, match="urn:unknown"):
        stated(stateful_map, "isLocatedIn", "<urn:unknown>")
    stated(stateful_map, "isLocatedIn", "kitchen1")
    assert properties(stateful_map) == {"isLocatedIn": ("kitchen1",)}


def test_a_functional_property_is_replaced_and_others_get_more_values(stateful_map):
    first = stated(stateful_map, "isOpen", "true")
    second = stated(stateful_map, "isOpen", "false")
    assert (second.retracted, second.seq) == (first.inserted, first.seq + 1)
    stated(stateful_map, "hasColor", "red")
    stated(stateful_map, "hasColor", "blue", "red")
    assert properties(stateful_map) == {"hasColor": ("color_blue", "color_red"), "isOpen": False}
    with pytest.raises(errors.BadRequest, match="one value at most"):
        stated(stateful_map, "isOpen", "true", "false")


def test_a_subproperty_of_a_functional_property_is_functional_with_its_range(stateful_map):
    stated(stateful_map, "hasOnlyColor", "red")
    stated(stateful_map, "hasOnlyColor", "blue")
    assert properties(stateful_map) == {"hasOnlyColor": "color_blue"}
    with pytest.raises(errors.UnknownName, match="hasOnlyColor takes color_blue, color_red"):
        stated(stateful_map, "hasOnlyColor", "xyzzy")


def test_the_same_value_in_another_spelling_changes_nothing(stateful_map):
    stateful_map.commit(transaction("spelt", turtle(':chair1 dm:seats "02"^^xsd:nonNegativeInteger .')))
    assert properties(stateful_map) == {"seats": 2}
    assert stated(stateful_map, "seats", "2") is None
    assert unstated(stateful_map, "seats", "2").inserted == ()
    assert properties(stateful_map) == {}


def test_unset_removes_one_value_or_all(stateful_map):
    stated(stateful_map, "note", "a", "b@it", "c")
    assert properties(stateful_map) == {"note": ("a", "b@it", "c")}
    unstated(stateful_map, "note", "b@it")
    assert properties(stateful_map) == {"note": ("a", "c")}
    assert unstated(stateful_map, "note", "z") is None
    unstated(stateful_map, "note")
    assert properties(stateful_map) == {}


def test_a_value_that_is_unset_and_set_in_one_commit_is_replaced(stateful_map):
    stated(stateful_map, "hasColor", "red", "blue")
    edited(stateful_map, unset=(statement("hasColor"),), set=(statement("hasColor", "red"),))
    assert properties(stateful_map) == {"hasColor": ("color_red",)}
    same = edited(stateful_map, unset=(statement("hasColor"),), set=(statement("hasColor", "red"),))
    assert same is None  # it was the only value, and still is
    edited(stateful_map, unset=(statement("hasColor", "red"),), set=(statement("ha colore", "blue"),))
    edited(stateful_map, unset=(statement("isOpen"),), set=(statement("isOpen", "true"),))
    assert properties(stateful_map) == {"hasColor": ("color_blue",), "isOpen": True}


def test_the_same_value_cannot_be_set_and_unset(stateful_map):
    stated(stateful_map, "isOpen", "true")
    for set_, unset in (("true", "1"), ("false", "false")):
        with pytest.raises(errors.BadRequest, match=r"isOpen (true|false|1) is both set and unset"):
            edited(stateful_map, set=(statement("isOpen", set_),), unset=(statement("is open", unset),))
    with pytest.raises(errors.BadRequest, match="isOpen has one value at most"):
        edited(stateful_map, set=(statement("isOpen", "true"), statement("isOpen", "false")))
    assert properties(stateful_map) == {"isOpen": True}


def test_a_condition_must_hold_or_nothing_changes(stateful_map):
    with pytest.raises(errors.PreconditionFailed, match="chair1: isOpen is not set, not false"):
        stated(stateful_map, "isOpen", "true", only_if=(statement("isOpen", "no"),))
    stated(stateful_map, "isOpen", "false", only_if=(statement("isOpen"),))
    stated(stateful_map, "isOpen", "true", only_if=(statement("isOpen", "false"),))
    assert properties(stateful_map) == {"isOpen": True}
    with pytest.raises(errors.PreconditionFailed, match="isOpen is true, not unset"):
        stated(stateful_map, "isOpen", "false", only_if=(statement("isOpen"),))
    assert properties(stateful_map) == {"isOpen": True}


def test_a_contradiction_with_the_tbox_is_rejected_with_an_explanation(stateful_map):
    before = home.state(stateful_map)
    with pytest.raises(errors.Inconsistent) as caught:
        stated(stateful_map, "isLocatedIn", "chair1")
    assert caught.value.explanation is not None
    with pytest.raises(errors.Inconsistent):
        edited(stateful_map, name="kitchen1", set=(statement("isOpen", "true"),))
    assert home.state(stateful_map) == before


def test_a_new_entity_may_have_properties_that_are_removed_with_it(stateful_map):
    stateful_map.commit(adding("stool1", set=(statement("isOpen", "no"), statement("isOn", "chair1"))))
    assert properties(stateful_map, "stool1") == {"isOn": ("chair1",), "isOpen": False}
    again = home.reopened(stateful_map)
    assert properties(again, "stool1") == {"isOn": ("chair1",), "isOpen": False}
    again.commit(transaction("gone", remove=["chair1"]))
    assert properties(again, "stool1") == {"isOpen": False}
    again.commit(transaction("gone too", remove=["stool1", "kitchen1"]))
    assert again.abox() == []
    again._journal.close()


def test_setting_a_property_can_be_undone(stateful_map):
    made = stated(stateful_map, "isOpen", "true")
    stateful_map.commit(transaction("back", made.retracted, made.inserted, require=made.inserted))
    assert properties(stateful_map) == {}


def test_rows_have_the_domain_and_range(stateful_map):
    rows = {row.name: row for row in stateful_map.classes.property_table.rows()}
    assert rows["isOpen"] == PropertyInfo(
        name="isOpen",
        iri=v.bare(v.dm("isOpen")),
        kind="data",
        functional=True,
        domain=("Object",),
        range=("boolean",),
        datatypes=("boolean",),
        labels={"en": "is open"},
        comment="Whether it stands open.",
        values={},
    )
    assert rows["hasMainColor"].values == {"color_blue": "blue", "color_red": "red"}
    assert rows["blushes"].range == ("Red",)
    assert not {"hasPosition", "lexicalReference", "float_coordinates_x"} & rows.keys()


def test_entities_of_one_shape_have_different_properties(stateful_map):
    stars = [
        turtle(f":s{i} a dm:Chair ; dm:isOpen {word} ; dm:hasColor dm:color_{color} ; dm:isOn :chair1 .")
        for i, (word, color) in enumerate([("true", "red"), ("false", "blue"), ("true", "blue")])
    ]
    stateful_map.commit(transaction("many", [t for star in stars for t in star]))
    assert [properties(stateful_map, f"s{i}") for i in range(3)] == [
        {"hasColor": (f"color_{color}",), "isOn": ("chair1",), "isOpen": is_open}
        for is_open, color in [(True, "red"), (False, "blue"), (True, "blue")]
    ]
