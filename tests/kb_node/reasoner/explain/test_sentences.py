"""The sentences of explanations."""

import functools

import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.explain.sentences import (
    Clause,
    clauses,
    entailment_sentence,
    mark_measured,
    refutation_sentence,
)
from semmap.nodes.kb_node.reasoner.explain.words import Words, article
from tests.kb_node.reasoner.graphs import household, triple, triples

LABELS = """
:on rdfs:label "is on" . :holds rdfs:label "holds" . :color rdfs:label "has color" .
:open rdfs:label "is open" .
:open a owl:DatatypeProperty . :Cup rdfs:label "cup" . :Egg rdfs:label "egg" . :Lid rdfs:label "lid" .
"""


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


NONE, ONE = (f'"{number}"^^xsd:nonNegativeInteger' for number in (0, 1))
CUP_HOLDS = ":Cup rdfs:subClassOf [ owl:onProperty :holds ; "
EGGS = "; owl:onClass :Egg ]"
HEADLINES = [
    (":on a owl:AsymmetricProperty", ":a :on :a", "a cannot be on itself"),
    (
        ":color a owl:AsymmetricProperty",
        ":a :color :b . :b :color :a",
        "b and a cannot each have the other as color",
    ),
    (":holds a owl:IrreflexiveProperty", ":a :holds :b ; owl:sameAs :b", "b cannot hold itself"),
    (":on owl:propertyDisjointWith :holds", ":a :on :b ; :holds :b", "a cannot both be on b and hold b"),
    (
        ":on owl:propertyDisjointWith :color",
        ":a :on :a ; :color :a",
        "a cannot both be on itself and have itself as color",
    ),
    (
        "[] a owl:AllDisjointProperties ; owl:members ( :on :holds :color )",
        ":a :on :b ; :color :b",
        "a cannot both be on b and have color b",
    ),
    (f"{CUP_HOLDS} owl:maxCardinality {NONE} ]", ":a a :Cup ; :holds :b", "a cannot hold b"),
    (
        f"{CUP_HOLDS} owl:maxQualifiedCardinality {NONE} {EGGS}",
        ":a a :Cup ; :holds :b . :b a :Egg",
        "a cannot hold b",
    ),
    (
        f"{CUP_HOLDS} owl:maxCardinality {ONE} ]",
        ":a a :Cup ; :holds :b , :c . :b owl:differentFrom :c",
        "a cannot hold both b and c",
    ),
    (
        f"{CUP_HOLDS} owl:maxQualifiedCardinality {ONE} {EGGS}",
        ":a a :Cup ; :holds :b , :c . :b a :Egg . :c a :Egg . :b owl:differentFrom :c",
        "a cannot hold both b and c",
    ),
    (
        f":Cup rdfs:subClassOf [ owl:onProperty [ owl:inverseOf :on ] ; owl:maxCardinality {NONE} ]",
        ":a a :Cup . :b :on :a",
        "b cannot be on a",
    ),
    (
        ":on a owl:FunctionalProperty",
        ":a :on :b , :c . :b owl:differentFrom :c",
        "a cannot be on both b and c",
    ),
    (":d a owl:FunctionalProperty", ":a :d 1 , 2", "a cannot have both 2 and 1 as d"),
    (
        ":on a owl:InverseFunctionalProperty",
        ":b :on :a . :c :on :a . :b owl:differentFrom :c",
        "b and c cannot both be on a",
    ),
    (
        ":color a owl:InverseFunctionalProperty",
        ":b :color :a . :c :color :a . :c owl:differentFrom :b",
        "a cannot be the color of both c and b",
    ),
    (
        ":Cup owl:hasKey ( :d )",
        ":a a :Cup ; :d 1 . :b a :Cup ; :d 1 . :a owl:differentFrom :b",
        "a and b cannot be both the same and different",
    ),
    ("", ":a owl:differentFrom :a", "a cannot be different from itself"),
    (
        "[] a owl:AllDifferent ; owl:members ( :a :b :c )",
        ":a owl:sameAs :c",
        "a and c cannot be both the same and different",
    ),
    (
        "[] a owl:AllDisjointClasses ; owl:members ( :Cup :Egg :Lid )",
        ":a a :Cup , :Lid",
        "a cannot be both a cup and a lid",
    ),
    (":Cup owl:complementOf :Egg", ":a a :Cup , :Egg", "a cannot be both a cup and an egg"),
    (":Cup rdfs:subClassOf owl:Nothing", ":a a :Cup", "a cannot be a member of the empty class"),
    (":d rdfs:range xsd:integer", ":a :d 1.5", "1.5 (decimal) is not a value of integer"),
    (
        ":d rdfs:range [ a rdfs:Datatype ; owl:oneOf ( 1 2 ) ]",
        ":a :d 3",
        "3 (integer) is not one of 1, 2",
    ),
]


@pytest.mark.parametrize(("axioms", "facts", "headline"), HEADLINES)
def test_a_contradiction_is_named_before_its_reasons(axioms, facts, headline):
    with pytest.raises(Inconsistent) as refusal:
        Reasoner(triples(f"{LABELS} {axioms} {'.' if axioms else ''} {facts} ."))
    assert refusal.value.explanation.text.partition(": ")[0] == headline


DENIED = [
    (
        ":a :on :b",
        ":b :on :a . :on a owl:AsymmetricProperty",
        "a is not on b, because b is on a (asserted), and",
    ),
    (
        ":a owl:sameAs :b",
        ":a a :Cup . :b a :Egg",
        "a is different from b, because a is a cup (asserted), and b",
    ),
    (":a owl:sameAs :b", ":b owl:differentFrom :a", "a is different from b, because b is different from a"),
    (":a owl:sameAs :b", ":a owl:differentFrom :b", "a is different from b (asserted)."),
    (":a owl:differentFrom :b", ":a owl:sameAs :b", "a is the same as b (asserted)."),
    (
        ":a a :Egg",
        ":Cup owl:disjointWith :Egg . :a a :Cup",
        "a is not an egg, because it is a cup (asserted), and",
    ),
    (":Cup rdfs:subClassOf :Egg", ":a a :Cup", "it is not true that every cup is an egg, because a is a cup"),
    (":a :on :a", ":on a owl:IrreflexiveProperty", "a is not on itself, because nothing is on itself."),
    (":a :open true", ":a :open false", "a is not open (asserted)."),
    (
        ":a :on :b",
        "[] a owl:NegativePropertyAssertion ; owl:sourceIndividual :a ; owl:assertionProperty :on ; "
        "owl:targetIndividual :b",
        "a is not on b (asserted).",
    ),
    (
        ":a :on :a",
        "[] a owl:NegativePropertyAssertion ; owl:sourceIndividual :a ; owl:assertionProperty :on ; "
        "owl:targetIndividual :a",
        "a is not on itself (asserted).",
    ),
]


@pytest.mark.parametrize(("supposed", "others", "text"), DENIED)
def test_a_refuted_statement_is_negated(supposed, others, text):
    words, supposed = Words.of(triples(LABELS)), triple(supposed)
    assert refutation_sentence(supposed, [*triples(f"{others} ."), supposed], words).startswith(text)


def test_facts_come_before_axioms_and_rules_last():
    words = Words.of(triples(LABELS))
    axiom, fact = triple(":Cup rdfs:subClassOf :Egg"), triple(":a a :Cup")
    goal = triple(":a a :Egg")
    assert entailment_sentence(goal, [axiom, fact], words) == (
        "a is an egg, because it is a cup (asserted), and every cup is an egg."
    )
    assert entailment_sentence(goal, [], words) == "a is an egg (axiomatic)."


def test_measured_facts_are_marked():
    words = Words.of(triples(LABELS))
    first, second = triples(":a :on :b . :a :d 1 .")
    text = entailment_sentence(triple(":a a :Cup"), [triple(":a a :Lid"), first, second], words)
    marked = mark_measured(text, [first], words)
    assert marked == text.replace("on b (asserted)", "on b (measured)")
    assert "is a lid (asserted)" in marked
    assert "on b (measured)" in marked


def test_it_stands_for_the_only_individual_of_the_clause_before():
    words = Words.of(triples(LABELS))
    support = triples(":a a :Cup . :a :open true . :a :on :a . :a :on :b . :a a :Lid . :b a :Lid .")
    assert entailment_sentence(triple(":a a :Egg"), support, words) == (
        "a is an egg, because it is a cup (asserted), it is open (asserted), it is on itself (asserted), "
        "it is on b (asserted), a is a lid (asserted), and b is a lid (asserted)."
    )
