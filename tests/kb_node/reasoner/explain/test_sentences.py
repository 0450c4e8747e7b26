"""The sentences of explanations."""

import functools

import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.explain.sentences import Clause, clauses
from semmap.nodes.kb_node.reasoner.explain.words import Words, article
from tests.kb_node.reasoner.graphs import household, triple, triples


@functools.cache
def home():
    return Reasoner(household())


HOLDS = {
    ":milk1 dm:isLocatedIn :kitchen1": (
        ":milk1 dm:isOn :counter1 . :counter1 dm:isLocatedIn :kitchen1",
        "milk1 is located in kitchen1, because milk1 is on counter1 (asserted), counter1 is located in "
        "kitchen1 (asserted), and everything that is on something that is located in something is located in "
        "the latter.",
    ),
    ":milk1 a dm:Food": (
        ":milk1 a dm:Milk",
        "milk1 is food, because it is milk (asserted), everything that is milk is a drink, and every drink "
        "is food.",
    ),
    ":counter1 dm:supports :milk1": (
        ":milk1 dm:isOn :counter1",
        "counter1 supports milk1, because milk1 is on counter1 (asserted), and if one thing is on another, "
        "the other supports it.",
    ),
    ":door1 dm:hasPart :x": (
        ":door1 dm:hasHandle :x",
        "door1 has part x, because door1 has handle x (asserted), everything that has something as handle "
        "has it as direct part, and everything that has something as direct part has it as part.",
    ),
    ":x a dm:Handle": (
        ":door1 dm:hasHandle :x",
        "x is a handle, because door1 has handle x (asserted), and everything that something has as handle "
        "is a handle.",
    ),
    ":f dm:hasAffordance dm:cooling": (
        ":f a dm:Fridge",
        "f has affordance cooling, because f is a fridge (asserted), and every fridge has affordance "
        "cooling.",
    ),
    ":a a dm:Object": (
        ":a dm:isSwitchedOn false",
        "a is an object, because it is not switched on (asserted), and everything that has a value for “is "
        "switched on” is an object.",
    ),
    ":plate1 a dm:Tableware": (
        ":plate1 a dm:Dishware",
        "plate1 is tableware, because it is dishware (asserted), and everything that is dishware is "
        "tableware.",
    ),
    ":door1 dm:isOpen true": (":door1 dm:isOpen true", "door1 is open (asserted)."),
    ":door1 dm:isOpen false": (":door1 dm:isOpen false", "door1 is not open (asserted)."),
    ":m owl:sameAs :m": (":m a dm:Milk", "m is the same as m (axiomatic)."),
}

CANNOT_BE = {
    ":a a dm:Fork , dm:Knife": (
        "a cannot be both a fork and a knife: it is a fork (asserted), it is a knife (asserted), "
        "and nothing is both a fork and a knife."
    ),
    ":a dm:isOn :b . :b dm:isOn :a": (
        "b and a cannot each be on the other: b is on a (asserted), a is on b (asserted), "
        "and if one thing is on another, the other is not on it."
    ),
    ":a dm:isOpen true , false": (
        "a cannot be both open and not open: a is not open (asserted), it is open (asserted), "
        "and “is open” has at most one value."
    ),
    ":a dm:hasMainColor dm:color_red , dm:color_blue": (
        "a cannot have both color_blue and color_red as main color: a has main color color_blue (asserted), "
        "a has main color color_red (asserted), nothing has more than one main color, "
        "and color_blue and color_red are different."
    ),
    ":x dm:hasDirectPart :p . :y dm:hasDirectPart :p . :x owl:differentFrom :y": (
        "p cannot be the direct part of both x and y: x has direct part p (asserted), y has direct part p "
        "(asserted), no two things have the same direct part, and x is different from y (asserted)."
    ),
    ":a dm:isAdjacentTo :a": (
        "a cannot be adjacent to itself: a is adjacent to itself (asserted), "
        "and nothing is adjacent to itself."
    ),
    ':a dm:mass "heavy"^^xsd:float': '"heavy" is not a value of float: a has mass "heavy" (asserted).',
    ":a a owl:Nothing": (
        "a cannot be a member of the empty class: it is a member of the empty class (asserted)."
    ),
    "[] owl:sourceIndividual :a ; owl:assertionProperty dm:isOn ; owl:targetIndividual :b . :a dm:isOn :b": (
        "a cannot be on b: a is on b (asserted), and a is not on b (asserted)."
    ),
}


@pytest.mark.parametrize(("goal", "case"), HOLDS.items(), ids=HOLDS)
def test_why_something_holds(goal, case):
    given, text = case
    with home().assuming(triples(given + " .")):
        assert home().explain(triple(goal)).text == text


@pytest.mark.parametrize(("given", "text"), CANNOT_BE.items(), ids=CANNOT_BE)
def test_why_something_cannot_be(given, text):
    with pytest.raises(Inconsistent) as refusal, home().assuming(triples(given + " .")):
        pass
    explanation = refusal.value.explanation
    assert sorted(explanation.text.split(", ")) == sorted(text.split(", "))  # facts come as they were found


def test_a_cached_proof_gets_the_names_of_its_individuals():
    for door in ("door1", "door2"):
        with pytest.raises(
            Inconsistent, match=f"{door} cannot be both open and not open: {door} is not open"
        ):
            home().apply(insert=triples(f":{door} dm:isOpen true , false ."))


@pytest.mark.parametrize(
    ("name", "affirmed", "negated"),
    [
        ("isOn", "is on x", "is not on x"),
        ("partOf", "is part of x", "is not part of x"),
        ("has_color", "has color x", "does not have color x"),
        ("touches", "touches x", "does not touch x"),
        ("carries", "carries x", "does not carry x"),
        ("dependsOn", "depends on x", "does not depend on x"),
        ("mass", "has mass x", "does not have mass x"),
        ("hasIRI", "has IRI x", "does not have IRI x"),
        ("class", "has class x", "does not have class x"),
        ("p", "has p x", "does not have p x"),
    ],
)
def test_a_property_without_a_label_is_split_into_words(name, affirmed, negated):
    words, prop = Words.of([]), f"<http://example.org/{name}>"
    assert words.predicate_phrase(prop, "<http://example.org/x>") == affirmed
    assert words.predicate_phrase(prop, "<http://example.org/x>", negated=True) == negated


def test_the_english_label_is_used():
    cls = ":C rdfs:label "
    assert Words.of(triples(cls + '"Tasse"@de .')).cls(triple(":a :p :C")[2]) == "C"
    assert Words.of(triples(cls + '"cup" .')).cls(triple(":a :p :C")[2]) == "cup"
    assert Words.of(triples(cls + '"cup"@en , "mug" .')).cls(triple(":a :p :C")[2]) == "cup"


def test_articles():
    assert [article(noun) for noun in ("cup", "egg", "dairy food", "something that is on a table")] == [
        "a cup",
        "an egg",
        "dairy food",
        "something that is on a table",
    ]


def test_every_triple_of_a_proof_has_a_clause_except_parts_of_axioms():
    proof = triples(
        ":milk1 a dm:Milk . dm:Milk rdfs:subClassOf [ a owl:Restriction ; owl:onProperty dm:hasAffordance ;"
        " owl:hasValue dm:drinking ] ."
    )
    found = clauses(proof, proof, home().words)
    assert Clause("milk1 is milk", is_axiom=False) in found.values()
    assert Clause("everything that is milk has affordance drinking", is_axiom=True) in found.values()
    assert not any(predicate.endswith(("onProperty>", "hasValue>")) for _, predicate, _ in found)
