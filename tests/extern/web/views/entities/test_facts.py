from msgspec import structs

from semmap.nodes.extern.web.views.entities.facts import (
    ExplainArgs,
    asserted_facts,
    exclude_asserted,
    group_facts,
)
from semmap.nodes.extern.web.views.proof_lines import words_of
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import PropertyInfo
from semmap.schemas.relations import Relation
from tests.extern.web.views.sample_maps import class_, fact, thing

COLOR = PropertyInfo(
    name="hasColor", iri=f"{v.TBOX}hasColor", kind="object", functional=False, domain=(), range=(),
    labels={"en": "has color"}, values={"color_red": "red"}
)  # fmt: skip
OPEN = PropertyInfo(
    name="isOpen", iri=f"{v.TBOX}isOpen", kind="data", functional=True, domain=(), range=("boolean",),
    datatypes=("boolean",),
    labels={"en": "is open"}, values={}
)  # fmt: skip
PROPERTIES = {p.name: p for p in (COLOR, OPEN)}
WORDS = words_of([class_("Drink", labels={"en": "drink"})], PROPERTIES.values())
MILK = thing("milk1", "Milk", properties={"hasColor": ("color_red",), "isOpen": False})


def is_a(name, class_name):
    return (v.entity_iri(name), v.RDF_TYPE, v.dm(class_name))


def on(subject, other, text):
    return Relation(relation="isOn", subject=subject, object=other, text=text)


def test_asserted_facts_have_labels_and_can_be_unset():
    class_fact, color, open_ = asserted_facts(MILK, PROPERTIES)
    assert (class_fact.text, class_fact.why) == ("class: Milk", ExplainArgs("milk1", "type", "Milk"))
    assert (color.text, color.removable) == ("has color: red", ("hasColor", "color_red"))
    assert color.why == ExplainArgs("milk1", "hasColor", "color_red")
    assert (open_.text, open_.removable) == ("is open: false", ("isOpen", False))


def test_undeclared_properties_are_shown_by_name():
    (_, odd) = asserted_facts(thing("a", properties={"odd": 3}), {})
    assert odd.text == "odd: 3"


def test_inferred_and_computed_facts_are_separate():
    follows = [
        is_a("milk1", "Drink"),
        fact("milk1", "isOn", "counter1"),
        fact("milk1", "isLocatedIn", "flat1"),
        fact("milk1", "isLocatedIn", "kitchen1"),
        fact("milk1", "touches", "counter1"),
        fact("milk1", "hasReference", "ref1"),
        fact("counter1", "supports", "milk1"),
    ]
    relations = [
        on("milk1", "counter1", "milk1 is on counter1: its bottom is level"),
        Relation(
            relation="isLocatedIn", subject="milk1", object="kitchen1", text="milk1 is in kitchen1: 100%"
        ),
    ]
    found = group_facts(MILK, PROPERTIES, follows, relations, WORDS)
    assert [f.text for f in found.inferred] == ["is a drink", "is located in flat1"]
    assert found.inferred[0].why == ExplainArgs("milk1", "type", "Drink")
    assert [(f.text, f.measured) for f in found.computed] == [
        ("is on counter1", "its bottom is level"),
        ("is in kitchen1", "100%"),
        ("touches counter1", ""),
    ]
    assert [f.other for f in found.computed] == ["counter1", "kitchen1", "counter1"]


def test_supported_entities_are_the_subject_of_the_fact():
    found = group_facts(thing("table1"), {}, [], [on("cup1", "table1", "cup1 is on table1: level")], WORDS)
    (borne,) = found.computed
    assert (borne.text, borne.other) == ("cup1 is on table1", "cup1")
    assert borne.why == ExplainArgs("cup1", "isOn", "table1")


def test_relations_that_do_not_hold_or_are_viewer_relative_have_no_explanation():
    nothing = Relation(
        relation="isOn", subject="milk1", object="", holds=False, text="milk1 is on nothing: 40 cm"
    )
    left = Relation(relation="isLeftOf", subject="milk1", object="cup1", text="milk1 is left of cup1: 3 cm")
    found = group_facts(MILK, PROPERTIES, [], [nothing, left], WORDS)
    assert [f.why for f in found.computed] == [None, None]


def test_asserted_triples_are_excluded_from_past_inferences():
    held = [
        is_a("milk1", "Milk"),
        is_a("milk1", "Drink"),
        fact("milk1", "hasColor", "color_red"),
        (v.entity_iri("milk1"), v.dm("isOpen"), v.literal("false", v.XSD_BOOLEAN)),
        fact("milk1", "hasPreferredReference", "milk1_preferred_reference"),
        fact("milk1", "isLocatedIn", "flat1"),
    ]
    assert exclude_asserted(MILK, held) == (is_a("milk1", "Drink"), fact("milk1", "isLocatedIn", "flat1"))


def test_a_made_name_is_used_for_an_asserted_and_an_inferred_value():
    held = (v.entity_iri("milk1"), v.dm("hasColor"), v.dm("2nd"))
    assert exclude_asserted(structs.replace(MILK, properties={"hasColor": ("_2nd",)}), [held]) == ()
    (color,) = group_facts(MILK, PROPERTIES, [held], [], WORDS).inferred
    assert (color.why, color.other) == (ExplainArgs("milk1", "hasColor", "_2nd"), "_2nd")


def test_next_to_hides_near():
    next_to = Relation(
        relation="isNextTo", subject="milk1", object="cup1", text="milk1 is next to cup1: 2 cm"
    )
    near = Relation(relation="isNear", subject="cup1", object="milk1", text="cup1 is near milk1: 2 cm")
    other = Relation(relation="isNear", subject="milk1", object="jug1", text="milk1 is near jug1: 9 cm")
    follows = [fact("milk1", "isNear", "cup1"), fact("milk1", "isNear", "tin1")]
    found = group_facts(MILK, PROPERTIES, follows, [next_to, near, other], WORDS)
    assert [f.other for f in found.computed] == ["cup1", "jug1", "tin1"]


def test_individuals_have_the_same_labels_in_inferred_facts():
    (color,) = group_facts(MILK, PROPERTIES, [fact("milk1", "hasColor", "color_red")], [], WORDS).inferred
    assert color.text == "has color red"
