"""Constructs of third-party ontologies, in short excerpts: all of them permit incremental changes."""

# ruff: noqa: E501
import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from semmap.nodes.kb_node.reasoner.terms import iri
from tests.kb_node.reasoner import proofs
from tests.kb_node.reasoner.graphs import triple, triples

TBOX = """
:Cup a owl:Class ; rdfs:subClassOf :Vessel . :Vessel a owl:Class . :Room a owl:Class ; owl:disjointWith :Vessel .
:in a owl:ObjectProperty , owl:TransitiveProperty ; rdfs:range :Room .
"""
HARMLESS = {
    "universal properties declared": "owl:topObjectProperty a owl:ObjectProperty ."
    "owl:topDataProperty a owl:DatatypeProperty . owl:bottomObjectProperty a owl:ObjectProperty .",
    "a subproperty of the universal one": ":in rdfs:subPropertyOf owl:topObjectProperty ."
    ":mass rdfs:subPropertyOf owl:topDataProperty .",
    "universal properties with domains": "owl:topObjectProperty rdfs:domain owl:Thing ; rdfs:label 'any'@en .",
    "an annotated axiom": "[] a owl:Axiom ; owl:annotatedSource :Cup ; owl:annotatedProperty rdfs:subClassOf ;"
    "owl:annotatedTarget :Vessel ; rdfs:comment 'all cups' .",
    "an annotated type": "[] a owl:Axiom ; owl:annotatedSource :in ; owl:annotatedProperty rdf:type ;"
    "owl:annotatedTarget owl:TransitiveProperty .",
    "an annotated annotation": "[] a owl:Annotation ; owl:annotatedSource :Cup ; owl:annotatedProperty rdfs:label ;"
    "owl:annotatedTarget 'cup' ; rdfs:seeAlso :x .",
    "a header": "<http://example.org/> a owl:Ontology ; owl:versionIRI <http://example.org/1> ;"
    "owl:imports <http://example.org/other> ; owl:versionInfo '1' ; owl:priorVersion <http://example.org/0> .",
    "a header ending in a slash, as a vocabulary": "<http://example.org/ns/> a owl:Ontology , :Vocabulary .",
    "classes of RDFS only": ":Cup a rdfs:Class . :Mug a rdfs:Class ; rdfs:subClassOf :Cup . :in a rdf:Property .",
    "a class of classes": ":Concept rdfs:subClassOf rdfs:Class . :Mug a :Concept .",
    "everything is a resource": ":Vessel rdfs:subClassOf rdfs:Resource . :in rdfs:domain rdfs:Resource .",
    "a range of classes": ":shows rdfs:range rdfs:Class . :shows2 rdfs:domain owl:Class ; rdfs:range rdf:Property .",
    "datatypes that have no values here": ":of rdfs:range xsd:ENTITY . :id rdfs:range xsd:ID ."
    ":id a owl:FunctionalProperty . xsd:ENTITY a rdfs:Datatype .",
    "data ranges": ":d rdfs:range [ a rdfs:Datatype ; owl:unionOf ( owl:real [ a rdfs:Datatype ; owl:oneOf"
    "( 'low' 'high' ) ] ) ] . :e rdfs:range [ a rdfs:Datatype ; owl:datatypeComplementOf rdf:JSON ] .",
    "a datatype of one's own": ":metre a rdfs:Datatype ; owl:onDatatype xsd:float ; owl:withRestrictions"
    "( [ xsd:minInclusive 0.0 ] ) . :mass rdfs:range :metre .",
    "a class that is an individual": ":Cup :madeBy :ikea . :ikea a :Maker . :Cup a :Product .",
    "a property that is an individual": ":in a :Relation ; :about :Room .",
    "anonymous individuals": "[] a :Cup ; :in [ a :Room ] .",
    "an annotation property of one's own": ":note a owl:AnnotationProperty ; rdfs:subPropertyOf rdfs:comment ."
    ":Cup :note 'n' .",
    "reification": "[] a rdf:Statement ; rdf:subject :Cup ; rdf:predicate rdfs:subClassOf ; rdf:object :Vessel .",
    "containers": ":things a rdf:Bag ; rdf:_1 :Cup ; rdf:_2 :ikea ; rdfs:member :ikea ; rdf:value 3 .",
    "an inverse without a name": ":In rdfs:subClassOf [ owl:onProperty [ owl:inverseOf :in ] ;"
    "owl:someValuesFrom :Cup ] .",
    "a self restriction": ":Self owl:equivalentClass [ owl:onProperty :in ; owl:hasSelf true ] .",
    "at least some": ":Cup rdfs:subClassOf [ owl:onProperty :in ; owl:someValuesFrom :Room ] ,"
    "[ owl:onProperty :in ; owl:minCardinality 1 ] , [ owl:onProperty :in ; owl:cardinality 3 ] .",
    "one of two": ":Cup rdfs:subClassOf [ owl:unionOf ( :Vessel :Room ) ] , [ owl:oneOf ( :a :b ) ] .",
    "a chain of one": ":over owl:propertyChainAxiom ( :in ) .",
    "a broken list": ":Broken owl:unionOf :nowhere . :Broken owl:intersectionOf [ rdf:first :Cup ] .",
    "a disjoint union": ":Vessel owl:disjointUnionOf ( :Cup :Pot ) .",
    "lists with words of the vocabulary": "[] :ignored ( rdf:type owl:Class ) ; :among ( [ :path rdf:type ] ) .",
    "types by another name": ":isA rdfs:subPropertyOf rdf:type . :mug1 :isA :Cup , :Unknown , 'text' , owl:Class .",
    "equality by another name": ":eq rdfs:subPropertyOf owl:sameAs . :ne rdfs:subPropertyOf owl:differentFrom ."
    ":mug1 :eq :mug2 ; :ne :mug3 .",
    "the schema of RDF": "rdf:type a rdf:Property ; rdfs:domain rdfs:Resource ; rdfs:range rdfs:Class ."
    "rdf:Bag rdfs:subClassOf rdfs:Container . rdf:first rdfs:domain rdf:List . owl:sameAs rdfs:domain owl:Thing .",
    "another name for types": "rdf:type rdfs:subPropertyOf :kind . :broader rdfs:subPropertyOf rdfs:subClassOf .",
    "below plain terms of RDF": ":Map rdfs:subClassOf rdf:Seq . :of rdfs:range rdf:Statement , owl:Ontology ."
    ":item rdfs:subPropertyOf rdfs:member . rdf:_1 rdfs:subPropertyOf rdfs:member .",
    "a deprecated class": ":Old a owl:DeprecatedClass , owl:Class ; owl:deprecated true .",
}
INSTEAD = {
    "a chain of types": (
        ":isA owl:propertyChainAxiom :l . :l rdf:first :in ; rdf:rest :m . :m rdf:first rdf:type ; rdf:rest rdf:nil .",
        "vocabulary",
    ),
    "classes that are the same": (":Cup owl:sameAs :Becher .", "classes or properties are compared"),
    "members of an enumeration that are equal by another name": (
        ":One owl:equivalentClass [ owl:oneOf ( :i ) ] ; rdfs:subClassOf [ owl:onProperty :eq ; owl:hasValue :j ] ."
        " :eq rdfs:subPropertyOf owl:sameAs .",
        "equates individuals",
    ),
    "an individual that is a word of the vocabulary": (
        ":x :one :y , rdf:type . :one a owl:FunctionalProperty .",
        "the same as another",
    ),
    "an individual that is a value": (
        ":x :one :y , 1 . :one a owl:FunctionalProperty .",
        "the same as a value",
    ),
}


@pytest.mark.parametrize("name", HARMLESS)
def test_changes_stay_incremental(name):
    tbox = triples(TBOX + HARMLESS[name])
    reasoner = Reasoner(tbox)
    assert reasoner.not_incremental is None
    engine = reasoner._engine
    star = triples(":cup1 a :Cup ; :in :kitchen1 ; rdfs:label 'a cup' . :kitchen1 :in :flat1 .")
    reasoner.apply(insert=star)
    assert reasoner.holds(triple(":cup1 a :Vessel"))
    assert reasoner.holds(triple(":cup1 :in :flat1"))
    with pytest.raises(Inconsistent):
        reasoner.apply(insert=[triple(":kitchen1 a :Cup")])
    assert set(reasoner.asserted()) == {*tbox, *star}
    assert reasoner._engine is engine
    for fact in set(reasoner.inferred()):
        proofs.check(reasoner.explain(fact), [*tbox, *star])
    closure = Closure([*tbox, *star])
    for fact in reasoner.inferred():
        assert closure.holds(fact)
    reasoner.apply(delete=star)
    assert set(reasoner.asserted()) == set(tbox)
    assert reasoner._engine is engine


@pytest.mark.parametrize("name", HARMLESS)
def test_the_construct_can_be_added_and_removed_at_run_time(name):
    base, more = triples(TBOX + ":cup1 a :Cup ; :in :kitchen1 ."), triples(HARMLESS[name])
    reasoner = Reasoner(base)
    before = set(reasoner.inferred())
    reasoner.apply(insert=more)
    assert set(reasoner.asserted()) == {*base, *more}
    assert len(reasoner) == len({*base, *more})
    for fact in more:
        assert reasoner.holds(fact)
        assert reasoner.explain(fact).support == (fact,)
        assert fact[2] in reasoner.about(fact[0])[fact[1]]
    reasoner.apply(delete=more)
    assert set(reasoner.asserted()) == set(base)
    assert set(reasoner.inferred()) == before


def test_the_household_with_a_universal_property_is_still_incremental():
    reasoner = Reasoner(triples(TBOX))
    reasoner.apply(insert=triples("owl:topObjectProperty a owl:ObjectProperty ."))
    assert reasoner.not_incremental is None


@pytest.mark.parametrize("name", INSTEAD)
def test_the_reason_why_a_graph_is_not_incremental(name):
    turtle, why = INSTEAD[name]
    reasoner = Reasoner(triples(TBOX + turtle))
    assert why in reasoner.not_incremental
    assert not reasoner.is_compiled
    reasoner.apply(insert=triples(":cup1 a :Cup ."))
    assert reasoner.holds(triple(":cup1 a :Vessel"))
    assert why in reasoner.not_incremental
    reasoner.apply(delete=triples(turtle))
    assert reasoner.not_incremental is None


def test_existing_axioms_change_nothing():
    tbox = triples(TBOX)
    reasoner = Reasoner(tbox)
    engine = reasoner._engine
    reasoner.apply(insert=[*tbox, *triples(":cup1 a :Cup .")], delete=triples(":Mug rdfs:subClassOf :Cup ."))
    assert reasoner._engine is engine
    assert len(reasoner) == len(tbox) + 1
    reasoner.apply(insert=tbox[:3], delete=tbox[:2])
    assert len(reasoner) == len(tbox) + 1
    assert reasoner.holds(triple(":cup1 a :Vessel"))


OUTSIDE = {
    "existential restriction as a superclass": ":A rdfs:subClassOf [ owl:onProperty :p ; owl:someValuesFrom :B ] .",
    "minimum cardinality as a superclass": ":A rdfs:subClassOf [ owl:onProperty :p ; owl:minCardinality 1 ] .",
    "union as a superclass": ":A rdfs:subClassOf [ owl:unionOf ( :B :C ) ] .",
    "enumeration as a superclass": ":A rdfs:subClassOf [ owl:oneOf ( :b :c ) ] .",
    "universal restriction as a subclass": "[ owl:onProperty :p ; owl:allValuesFrom :B ] rdfs:subClassOf :A .",
    "complement as a subclass": "[ owl:complementOf :B ] rdfs:subClassOf :A .",
    "cardinality restriction as a superclass": ":A rdfs:subClassOf [ owl:onProperty :p ; owl:maxCardinality 2 ] .",
    "existential restriction in an equivalence": ":A owl:equivalentClass"
    "[ owl:intersectionOf ( :B [ owl:onProperty :p ; owl:someValuesFrom :C ] ) ] .",
    "union in an equivalence": ":A owl:unionOf ( :B :C ) .",
    "disjoint union": ":A owl:disjointUnionOf ( :X :Y ) .",
    "key without properties": ":A owl:hasKey () .",
    "reflexive property": ":p a owl:ReflexiveProperty .",
    "datatype ENTITY": ":d rdfs:range xsd:ENTITY .",
    "class of the vocabulary as a class": ":A rdfs:subClassOf rdfs:Class .",
    "universal property as a superproperty": ":p rdfs:subPropertyOf owl:topObjectProperty .",
    "property chain of less than two properties": ":p owl:propertyChainAxiom ( :q ) .",
}
INSIDE = """
:A rdfs:subClassOf :B , [ owl:onProperty :p ; owl:allValuesFrom :C ] , [ owl:onProperty :p ; owl:hasValue :c ] ,
    [ owl:complementOf :D ] , [ owl:intersectionOf ( :B [ owl:onProperty :p ; owl:maxCardinality 1 ] ) ] .
[ owl:unionOf ( :B [ owl:onProperty :p ; owl:someValuesFrom :C ] ) ] rdfs:subClassOf :A .
[ owl:oneOf ( :b :c ) ] rdfs:subClassOf :A .
:E owl:equivalentClass [ owl:intersectionOf ( :A [ owl:onProperty :p ; owl:hasValue :c ] ) ] .
:F owl:disjointWith [ owl:onProperty :p ; owl:someValuesFrom owl:Thing ] .
:p rdfs:domain :A ; rdfs:range :B ; owl:inverseOf :q ; owl:propertyChainAxiom ( :p :q ) . :d rdfs:range xsd:float .
"""


@pytest.mark.parametrize("kind", OUTSIDE)
def test_axioms_outside_the_profile_are_counted(kind):
    assert Reasoner(triples(OUTSIDE[kind])).outside_rl == {kind: 1}


def test_axioms_inside_the_profile_are_not_counted():
    assert not Reasoner(triples(INSIDE)).outside_rl
    several = "".join(text.replace(":A ", f":A{i} ") for i, text in enumerate(OUTSIDE.values()))
    assert Reasoner(triples(INSIDE + several)).outside_rl == dict.fromkeys(OUTSIDE, 1)


def test_a_value_of_an_unknown_datatype_is_in_it():
    reasoner = Reasoner(triples(":of rdfs:range xsd:ENTITY ."))
    reasoner.apply(insert=triples(':x :of "a"^^xsd:ENTITY , "no entity"^^xsd:ENTITY .'))
    assert reasoner.holds(('"a"^^' + iri("xsd:ENTITY"), iri("a"), iri("xsd:ENTITY")))
