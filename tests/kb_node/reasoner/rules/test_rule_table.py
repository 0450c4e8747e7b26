"""Every rule of the table is applied: it is the last step of the explanation."""

import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.rules.rule_table import RULES
from semmap.nodes.kb_node.reasoner.terms import iri
from tests.kb_node.reasoner import proofs
from tests.kb_node.reasoner.graphs import triple, triples

LIST = ":l rdf:first :{} ; rdf:rest :m . :m rdf:first :{} ; rdf:rest rdf:nil . "
AB, PQ, XY = LIST.format("a", "b"), LIST.format("p", "q"), LIST.format("x", "y")
ONE, ZERO = (f'"{n}"^^xsd:nonNegativeInteger' for n in (1, 0))
QUALIFIED = ":r owl:onProperty :p ; owl:maxQualifiedCardinality "
NEGATIVE = ":n owl:sourceIndividual :x ; owl:assertionProperty :p ; "
X_IS_Y, Z_IS_Y = ":x owl:sameAs :y", ":z owl:sameAs :y"
ENTAILED = [
    ("eq-sym", ":x owl:sameAs :y", ":y owl:sameAs :x"),
    ("eq-trans", ":x owl:sameAs :y . :y owl:sameAs :z", ":x owl:sameAs :z"),
    ("eq-rep-s", ":x owl:sameAs :y . :x :p :z", ":y :p :z"),
    ("eq-rep-p", ":p owl:sameAs :q . :x :p :z", ":x :q :z"),
    ("eq-rep-o", ":z owl:sameAs :y . :x :p :z", ":x :p :y"),
    ("prp-dom", ":p rdfs:domain :a . :x :p :y", ":x a :a"),
    ("prp-rng", ":p rdfs:range :a . :x :p :y", ":y a :a"),
    ("prp-fp", ":p a owl:FunctionalProperty . :x :p :y , :z", ":z owl:sameAs :y"),
    ("prp-ifp", ":p a owl:InverseFunctionalProperty . :x :p :z . :y :p :z", ":y owl:sameAs :x"),
    ("prp-symp", ":p a owl:SymmetricProperty . :x :p :y", ":y :p :x"),
    ("prp-trp", ":p a owl:TransitiveProperty . :x :p :y . :y :p :z", ":x :p :z"),
    ("prp-spo1", ":p rdfs:subPropertyOf :q . :x :p :y", ":x :q :y"),
    ("prp-spo2", ":r owl:propertyChainAxiom :l . " + PQ + ":x :p :y . :y :q :z", ":x :r :z"),
    ("prp-eqp1", ":p owl:equivalentProperty :q . :x :p :y", ":x :q :y"),
    ("prp-eqp2", ":q owl:equivalentProperty :p . :x :p :y", ":x :q :y"),
    ("prp-inv1", ":p owl:inverseOf :q . :x :p :y", ":y :q :x"),
    ("prp-inv2", ":q owl:inverseOf :p . :x :p :y", ":y :q :x"),
    (
        "prp-key",
        ":a owl:hasKey :l . " + PQ + ":x a :a ; :p 1 ; :q 2 . :y a :a ; :p 1 ; :q 2",
        ":x owl:sameAs :y",
    ),
    ("cls-int1", ":c owl:intersectionOf :l . " + AB + ":x a :a , :b", ":x a :c"),
    ("cls-int2", ":c owl:intersectionOf :l . " + AB + ":x a :c", ":x a :b"),
    ("cls-uni", ":c owl:unionOf :l . " + AB + ":x a :b", ":x a :c"),
    ("cls-svf1", ":r owl:onProperty :p ; owl:someValuesFrom :a . :x :p :y . :y a :a", ":x a :r"),
    ("cls-svf2", ":r owl:onProperty :p ; owl:someValuesFrom owl:Thing . :x :p :y", ":x a :r"),
    ("cls-avf", ":r owl:onProperty :p ; owl:allValuesFrom :a . :x a :r ; :p :y", ":y a :a"),
    ("cls-hv1", ":r owl:onProperty :p ; owl:hasValue :y . :x a :r", ":x :p :y"),
    ("cls-hv2", ":r owl:onProperty :p ; owl:hasValue :y . :x :p :y", ":x a :r"),
    (
        "cls-maxc2",
        f":r owl:onProperty :p ; owl:maxCardinality {ONE} . :x a :r ; :p :y , :z",
        ":z owl:sameAs :y",
    ),
    (
        "cls-maxqc3",
        QUALIFIED + f"{ONE} ; owl:onClass :a . :x a :r ; :p :y , :z . :y a :a . :z a :a",
        ":z owl:sameAs :y",
    ),
    (
        "cls-maxqc4",
        QUALIFIED + f"{ONE} ; owl:onClass owl:Thing . :x a :r ; :p :y , :z",
        Z_IS_Y,
    ),
    ("cls-oo", ":c owl:oneOf :l . " + XY, ":y a :c"),
    ("cax-sco", ":a rdfs:subClassOf :b . :x a :a", ":x a :b"),
    ("cax-eqc1", ":a owl:equivalentClass :b . :x a :a", ":x a :b"),
    ("cax-eqc2", ":b owl:equivalentClass :a . :x a :a", ":x a :b"),
    ("scm-cls", ":a a owl:Class", ":a rdfs:subClassOf owl:Thing"),
    ("scm-sco", ":a rdfs:subClassOf :b . :b rdfs:subClassOf :c", ":a rdfs:subClassOf :c"),
    ("scm-eqc1", ":a owl:equivalentClass :b", ":b rdfs:subClassOf :a"),
    ("scm-eqc2", ":a rdfs:subClassOf :b . :b rdfs:subClassOf :a", ":a owl:equivalentClass :b"),
    ("scm-op", ":p a owl:ObjectProperty", ":p rdfs:subPropertyOf :p"),
    ("scm-dp", ":p a owl:DatatypeProperty", ":p owl:equivalentProperty :p"),
    ("scm-spo", ":p rdfs:subPropertyOf :q . :q rdfs:subPropertyOf :r", ":p rdfs:subPropertyOf :r"),
    ("scm-eqp1", ":p owl:equivalentProperty :q", ":q rdfs:subPropertyOf :p"),
    ("scm-eqp2", ":p rdfs:subPropertyOf :q . :q rdfs:subPropertyOf :p", ":p owl:equivalentProperty :q"),
    ("scm-dom1", ":p rdfs:domain :a . :a rdfs:subClassOf :b", ":p rdfs:domain :b"),
    ("scm-dom2", ":q rdfs:domain :a . :p rdfs:subPropertyOf :q", ":p rdfs:domain :a"),
    ("scm-rng1", ":p rdfs:range :a . :a rdfs:subClassOf :b", ":p rdfs:range :b"),
    ("scm-rng2", ":q rdfs:range :a . :p rdfs:subPropertyOf :q", ":p rdfs:range :a"),
    (
        "scm-hv",
        ":r owl:onProperty :p ; owl:hasValue :x . :s owl:onProperty :q ; owl:hasValue :x ."
        ":p rdfs:subPropertyOf :q",
        ":r rdfs:subClassOf :s",
    ),
    *(
        (
            f"scm-{rule}",
            f":r owl:onProperty :p ; owl:{word} :{one} . :s owl:onProperty :{prop} ; owl:{word} :{other} ."
            ":p rdfs:subPropertyOf :q . :a rdfs:subClassOf :b",
            conclusion,
        )
        for rule, word, one, prop, other, conclusion in (
            ("svf1", "someValuesFrom", "a", "p", "b", ":r rdfs:subClassOf :s"),
            ("svf2", "someValuesFrom", "a", "q", "a", ":r rdfs:subClassOf :s"),
            ("avf1", "allValuesFrom", "a", "p", "b", ":r rdfs:subClassOf :s"),
            ("avf2", "allValuesFrom", "a", "q", "a", ":s rdfs:subClassOf :r"),
        )
    ),
    ("scm-int", ":c owl:intersectionOf :l . " + AB, ":c rdfs:subClassOf :b"),
    ("scm-uni", ":c owl:unionOf :l . " + AB, ":b rdfs:subClassOf :c"),
    ("ext-card", f":r owl:cardinality {ONE}", f":r owl:maxCardinality {ONE}"),
    ("ext-union", ":c owl:disjointUnionOf :l . " + AB, ":b rdfs:subClassOf :c"),
    ("ext-union", ":c owl:disjointUnionOf :l . " + AB, ":a owl:disjointWith :b"),
    ("ext-range", ":r owl:onDataRange xsd:float", ":r owl:onClass xsd:float"),
]
CONTRADICTORY = [
    ("eq-diff1", ":x owl:sameAs :y . :x owl:differentFrom :y"),
    ("eq-diff2", ":x owl:sameAs :y . :d a owl:AllDifferent ; owl:members :l . " + XY),
    ("eq-diff3", ":x owl:sameAs :y . :d a owl:AllDifferent ; owl:distinctMembers :l . " + XY),
    ("prp-irp", ":p a owl:IrreflexiveProperty . :x :p :x"),
    ("prp-asyp", ":p a owl:AsymmetricProperty . :x :p :y . :y :p :x"),
    ("prp-pdw", ":p owl:propertyDisjointWith :q . :x :p :y ; :q :y"),
    ("prp-adp", ":d a owl:AllDisjointProperties ; owl:members :l . " + PQ + ":x :p :y ; :q :y"),
    (
        "prp-npa1",
        NEGATIVE + "owl:targetIndividual :y . :x :p :y",
    ),
    ("prp-npa2", NEGATIVE + "owl:targetValue 1 . :x :p 1"),
    ("cls-nothing2", ":x a owl:Nothing"),
    ("cls-com", ":a owl:complementOf :b . :x a :a , :b"),
    ("cls-maxc1", f":r owl:onProperty :p ; owl:maxCardinality {ZERO} . :x a :r ; :p :y"),
    (
        "cls-maxqc1",
        QUALIFIED + f"{ZERO} ; owl:onClass :a . :x a :r ; :p :y . :y a :a",
    ),
    (
        "cls-maxqc2",
        QUALIFIED + f"{ZERO} ; owl:onClass owl:Thing . :x a :r ; :p :y",
    ),
    ("cax-dw", ":a owl:disjointWith :b . :x a :a , :b"),
    ("cax-adc", ":d a owl:AllDisjointClasses ; owl:members :l . " + AB + ":x a :a , :b"),
    ("dt-not-type", ':x :p "abc"^^xsd:float'),
]


@pytest.mark.parametrize(("rule", "premise", "conclusion"), ENTAILED, ids=[row[0] for row in ENTAILED])
def test_a_conclusion_is_inferred_explained_and_removed_with_its_premise(rule, premise, conclusion):
    facts, goal = triples(premise.rstrip(" .") + " ."), triple(conclusion)
    reasoner = Reasoner(facts)
    assert reasoner.holds(goal)
    explanation = reasoner.explain(goal)
    assert explanation.steps[-1].rule == rule
    proofs.check(explanation, facts)
    for fact in explanation.support:
        less = Reasoner(facts)
        less.apply(delete=[fact])
        assert not less.holds(goal)


@pytest.mark.parametrize(("rule", "premise"), CONTRADICTORY, ids=[row[0] for row in CONTRADICTORY])
def test_a_contradiction_is_found_and_explained(rule, premise):
    facts = triples(premise.rstrip(" .") + " .")
    with pytest.raises(Inconsistent) as refusal:
        Reasoner(facts)
    assert refusal.value.explanation.steps[-1].rule == rule
    proofs.check(refusal.value.explanation, facts)


def test_every_rule_of_the_table_is_tested():
    shown = {row[0] for row in (*ENTAILED, *CONTRADICTORY)} - {"dt-not-type"}
    assert shown == {rule.name for rule in RULES}


@pytest.mark.parametrize("term", ["<http://example.org/new>", iri("owl:Thing")])
def test_everything_is_the_same_as_itself(term):
    assert Reasoner().holds((term, iri("owl:sameAs"), term))


def test_axiomatic_triples_hold():
    assert Reasoner().holds(triple("rdfs:label a owl:AnnotationProperty"))
    assert Reasoner().holds(triple("xsd:float a rdfs:Datatype"))
    assert Reasoner().holds(triple("owl:Nothing rdfs:subClassOf owl:Thing"))


def test_a_schema_that_contradicts_the_map_is_rejected():
    reasoner = Reasoner(triples(":x a :a , :b ."))
    with pytest.raises(Inconsistent):
        reasoner.apply(insert=triples(":a owl:disjointWith :b ."))
    assert len(reasoner) == 2
    change = reasoner.apply(insert=triples(":a rdfs:subClassOf :c ."))
    assert "<http://example.org/x>" in change.touched
    assert reasoner.types("<http://example.org/x>") >= {"<http://example.org/c>"}


def test_axiomatic_triples_have_an_empty_support():
    for turtle in (":x owl:sameAs :x", "rdfs:label a owl:AnnotationProperty"):
        explanation = Reasoner().explain(triple(turtle))
        assert explanation.support == ()
        assert explanation.text.endswith("(axiomatic).")


def test_another_spelling_of_a_value_holds_and_is_explained():
    reasoner = Reasoner(triples(':x :p "1.0"^^xsd:float .'))
    other = triple(':x :p "1.00"^^xsd:float')
    assert reasoner.holds(other)
    assert reasoner.explain(other).support == (triple(':x :p "1.0"^^xsd:float'),)


def test_a_false_statement_has_no_explanation():
    assert Reasoner().explain(triple(":x :p :y")) is None


def test_graphs_beyond_the_compiled_engine_are_supported():
    reasoner = Reasoner(triples(":a rdfs:subClassOf :b . :x a :a ."))
    reasoner.apply(insert=triples(":a owl:sameAs :c . :y a :c ."))
    assert reasoner.holds(triple(":y a :b"))
    proofs.check(reasoner.explain(triple(":y a :b")), list(reasoner.asserted()))
    reasoner.apply(delete=triples(":a owl:sameAs :c ."))
    assert not reasoner.holds(triple(":y a :b"))
    assert reasoner.holds(triple(":x a :b"))


def test_a_cycle_of_a_transitive_property_is_explained():
    facts = triples(":p a owl:TransitiveProperty . :x :p :y . :y :p :x .")
    explanation = Reasoner(facts).explain(triple(":x :p :x"))
    assert set(explanation.support) == set(facts)
