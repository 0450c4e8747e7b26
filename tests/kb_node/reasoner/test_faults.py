"""Inconsistencies in a home, each with a similar consistent case."""

import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from tests.kb_node.reasoner import proofs
from tests.kb_node.reasoner.graphs import household, triples

FAULTS = {
    "disjoint by inheritance": (":box1 a dm:Kitchen , dm:Chair", "cannot be both"),
    "disjoint with an inferred class": (":box1 a dm:Chair . :x dm:isLocatedIn :box1", "cannot be both"),
    "AllDisjointClasses": (":box1 a dm:Fork , dm:Knife", "cannot be both a fork and a knife"),
    "abstract and physical": (":box1 a dm:Chair . :x dm:hasSize :box1", "cannot be both"),
    "Nothing": (":box1 a owl:Nothing", "cannot be a member of the empty class"),
    "complement": (":box1 a dm:Drug ; dm:hasAffordance dm:eating", "cannot be both"),
    "irreflexive": (":box1 dm:isAdjacentTo :box1", "box1 cannot be adjacent to itself"),
    "irreflexive through a subproperty": (":box1 dm:isOn :box1", "itself"),
    "irreflexive through an inverse": (":box1 dm:isControlledBy :box1", "itself"),
    "irreflexive through sameAs": (":box1 dm:touches :x . :x owl:sameAs :box1", "box1"),
    "asymmetric": (":box1 dm:isInside :x . :x dm:isInside :box1", "cannot each be inside the other"),
    "asymmetric through an inverse": (":box1 dm:isOn :x . :box1 dm:supports :x", "box1"),
    "disjoint properties": (":box1 dm:isOn :x ; dm:isInside :x", "cannot both be on x and be inside x"),
    "disjoint properties through an inverse": (
        ":box1 dm:isOn :x . :x dm:holds :box1",
        "cannot both be on x and be inside x",
    ),
    "two values of a functional property": (':box1 dm:mass "1.0"^^xsd:float , "2.0"^^xsd:float', "box1"),
    "the signs of zero": (':box1 dm:mass "0.0"^^xsd:float , "-0.0"^^xsd:float', "box1"),
    "a functional property and different values": (
        ":box1 dm:hasMainColor dm:color_red , dm:color_blue",
        "box1",
    ),
    "a value that the class comes with": (":box1 a dm:Can ; dm:hasShape dm:shape_sphere", "box1"),
    "inverse functional": (
        ":x dm:hasDirectPart :box1 . :y dm:hasDirectPart :box1 . :x owl:differentFrom :y",
        "x",
    ),
    "two wholes, said both ways": (
        ":box1 dm:isDirectPartOf :x . :y dm:hasHandle :box1 . :x owl:differentFrom :y",
        "x",
    ),
    "cardinality": (':box1 a dm:PreferredReference ; dm:lexicalReference "a" , "b"', "box1"),
    "exact cardinality": (
        ':box1 a dm:Coordinates ; dm:float_coordinates_x "1"^^xsd:float , "2"^^xsd:float',
        "it",
    ),
    "qualified cardinality": (
        ":box1 a dm:Chair ; dm:hasPosition :a , :b . :a a dm:Coordinates . :b a dm:Coordinates ."
        ":a owl:differentFrom :b",
        "cannot have both a and b as position",
    ),
    "allValuesFrom": (":box1 a dm:Tap ; dm:controls :x . :x a dm:Chair", "x cannot be"),
    "range of an individual": (":box1 dm:isOwnedBy :x . :x a dm:Cat", "x cannot be both"),
    "ill-typed literal": (
        ':box1 dm:mass "heavy"^^xsd:float',
        '"heavy" is not a value of float: box1 has mass "heavy"',
    ),
    "a negative mass": (':box1 dm:mass "-3"^^xsd:float', "box1 has mass -3"),
    "an infinite mass": (':box1 dm:mass "INF"^^xsd:float', "box1 has mass INF"),
    "a mass that is not a number": (':box1 dm:mass "NaN"^^xsd:float', "box1 has mass NaN"),
    "more than open": (':box1 dm:openness "1.5"^^xsd:float', "box1 has openness 1.5"),
    "a literal of another type": (':box1 dm:mass "1.0"^^xsd:double', "1.0 (double) is not a value of float"),
    "a number for a truth value": (':box1 dm:isOpen "2"^^xsd:integer', "not a value of boolean"),
    "sameAs against differentFrom": (
        ":box1 owl:sameAs :x . :box1 owl:differentFrom :x",
        "same and different",
    ),
    "sameAs in a circle against differentFrom": (
        ":box1 owl:sameAs :x . :x owl:sameAs :y . :box1 owl:differentFrom :y",
        "same and different",
    ),
    "different from itself": (":box1 owl:differentFrom :box1", "different from itself"),
    "sameAs of disjoint things": (
        ":box1 a dm:Chair . :x a dm:Kitchen . :box1 owl:sameAs :x",
        "cannot be both",
    ),
    "AllDifferent": ("dm:color_red owl:sameAs dm:color_blue", "color_"),
    "a location by a chain": (":box1 dm:isOn :x . :x dm:isLocatedIn :y . :y a dm:Chair", "y cannot be both"),
}
LOOK_ALIKES = {
    "two classes that may meet": ":box1 a dm:Couch , dm:Bed",
    "a couch in two senses": ":box1 a dm:Oven , dm:Stove",
    "disjoint classes, two things": ":box1 a dm:Fork . :x a dm:Knife",
    "a window that is a door": ":box1 a dm:Window , dm:Door",
    "complement, other affordance": ":box1 a dm:Drug ; dm:hasAffordance dm:grasping",
    "adjacent to another": ":box1 dm:isAdjacentTo :x",
    "on another": ":box1 dm:isOn :x",
    "connected to itself": ":box1 dm:isConnectedTo :box1",
    "part of itself at a distance": ":box1 dm:isPartOf :x . :x dm:isPartOf :box1",
    "touching both ways": ":box1 dm:touches :x . :x dm:touches :box1",
    "on, and supporting, said both ways": ":box1 dm:isOn :x . :x dm:supports :box1",
    "on one, inside another": ":box1 dm:isOn :x ; dm:isInside :y",
    "the same mass in two spellings": ':box1 dm:mass "1.0"^^xsd:float , "1.00"^^xsd:float , "1e0"^^xsd:float',
    "minus zero beside zero": (
        ":box1 a dm:Coordinates ; "
        'dm:float_coordinates_x "0.0"^^xsd:float ; dm:float_coordinates_y "-0.0"^^xsd:float'
    ),
    "two colors": ":box1 dm:hasColor dm:color_red , dm:color_blue",
    "the color twice": ":box1 dm:hasMainColor dm:color_red ; dm:hasColor dm:color_red",
    "the shape that the class comes with": ":box1 a dm:Can ; dm:hasShape dm:shape_cylinder",
    "two wholes that may be one": ":x dm:hasDirectPart :box1 . :y dm:hasDirectPart :box1",
    "two alternative texts": ':box1 a dm:AlternativeReference ; dm:lexicalReference "a" , "b"',
    "one text, as two types": ':box1 a dm:PreferredReference ; dm:lexicalReference "a" , "a"^^xsd:token',
    "two positions, one in coordinates": ":box1 a dm:Chair ; dm:hasPosition :a , :b . :a a dm:Coordinates",
    "allValuesFrom, and the value is one": ":box1 a dm:Tap ; dm:controls :x . :x a dm:Sink",
    "a cat and its owner": ":box1 dm:isOwnedBy :x . :box1 a dm:Cat",
    "any literal will do": ':box1 a dm:LexicalReference ; dm:lexicalReference "2"^^xsd:integer',
    "a truth value as a digit": ':box1 dm:isOpen "1"^^xsd:boolean',
    "infinity": ':box1 a dm:Coordinates ; dm:float_coordinates_x "INF"^^xsd:float',
    "no mass": ':box1 dm:mass "0"^^xsd:float',
    "sameAs and differentFrom of others": ":box1 owl:sameAs :x . :box1 owl:differentFrom :y",
    "sameAs of like things": ":box1 a dm:Chair . :x a dm:Furniture . :box1 owl:sameAs :x",
    "different in a row": ":box1 owl:differentFrom :x . :x owl:differentFrom :y",
    "a location by a chain": ":box1 dm:isOn :x . :x dm:isLocatedIn :y . :y a dm:Kitchen",
    "a text in two languages": ':box1 a dm:AlternativeReference ; dm:lexicalReference "x"@it , "x"@en',
    "an unknown class": ":box1 a :Contraption , dm:Chair",
}


@pytest.fixture(scope="module")
def tbox():
    return household()


@pytest.fixture(scope="module")
def reasoner(tbox):
    return Reasoner(tbox)


@pytest.mark.parametrize("name", FAULTS)
def test_a_contradiction_is_rejected_and_explained(name, reasoner, tbox):
    turtle, claim = FAULTS[name]
    facts, size = triples(turtle + " ."), len(reasoner)
    with pytest.raises(Inconsistent) as refusal:
        reasoner.apply(insert=facts)
    explanation = refusal.value.explanation
    assert claim in explanation.text
    assert explanation.conclusion is None
    assert set(explanation.support) & set(facts)
    proofs.check(explanation, [*tbox, *facts])
    assert len(reasoner) == size
    assert not any(reasoner.types(term) for term in ("<http://example.org/box1>", "<http://example.org/x>"))


@pytest.mark.parametrize("name", LOOK_ALIKES)
def test_a_similar_consistent_case_is_accepted(name, reasoner):
    facts, size = triples(LOOK_ALIKES[name] + " ."), len(reasoner)
    try:
        reasoner.apply(insert=facts)
        assert len(reasoner) == size + len(facts)
    finally:
        reasoner.apply(delete=facts)
    assert len(reasoner) == size


def test_every_case_has_a_consistent_counterpart():
    assert len(FAULTS) >= 20
    assert len(LOOK_ALIKES) >= 20
