"""Which triples are schema, which axioms have no consequences, and which redefine the vocabulary."""

import pytest

from semmap.nodes.kb_node.reasoner.tbox.axioms import NotCompilable
from semmap.nodes.kb_node.reasoner.tbox.split import (
    check_all_compilable,
    check_compilable,
    is_datatype,
    is_inert,
    is_schema,
)
from semmap.nodes.kb_node.reasoner.terms import iri
from tests.kb_node.reasoner.graphs import triple, triples


@pytest.mark.parametrize(
    ("text", "schema", "inert"),
    [
        (":A rdfs:subClassOf :B", True, False),
        (":A a owl:Class", True, False),
        (":A owl:disjointWith :B", True, False),
        (":p a owl:TransitiveProperty", True, False),
        (":p rdfs:domain :A", True, False),
        (":l rdf:first :A", True, False),
        (":r a <http://www.w3.org/2003/11/swrl#Imp>", True, True),
        (":r <http://swrl.stanford.edu/ontologies/3.3/swrla.owl#isRuleEnabled> false", True, True),
        (":x a :A", False, False),
        (":x a owl:Thing", False, False),
        (":x a owl:NamedIndividual", False, False),
        (":x a xsd:integer", False, False),
        (":x a rdf:Bag", False, False),
        (":x :p :y", False, False),
        (":x owl:sameAs :y", False, False),
        (":x owl:differentFrom :y", False, False),
        (":x rdfs:label 'x'", False, False),
        (":o owl:imports :p", False, False),
        (":x owl:topObjectProperty :y", False, False),
        (":p rdfs:subPropertyOf owl:topObjectProperty", True, True),
        (":Concept rdfs:subClassOf rdfs:Class", True, True),
        ("rdf:type rdfs:domain rdfs:Resource", True, True),
        ("owl:Thing rdfs:subClassOf :A", True, False),
    ],
)
def test_a_triple_is_schema_and_perhaps_inert(text, schema, inert):
    assert (is_schema(triple(text)), is_inert(triple(text))) == (schema, inert)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        (":A rdfs:subClassOf :B . :x :p 1 ; owl:sameAs :y .", None),
        (":p rdfs:subPropertyOf owl:sameAs . rdfs:label a owl:AnnotationProperty .", None),
        (":shape :ignored ( rdf:type ) .", None),  # no axiom refers to the list
        ("[] a owl:AllDisjointProperties ; owl:members ( :p rdf:type ) .", "meaning of OWL's own vocabulary"),
        ("owl:Class rdfs:subClassOf :A .", "meaning of OWL's own vocabulary"),
        ("rdfs:subClassOf :p :x .", "meaning of OWL's own vocabulary"),
        (":p owl:inverseOf rdf:type .", "meaning of OWL's own vocabulary"),
        (":x owl:sameAs 1 .", "an individual is compared with a value"),
        (":x owl:differentFrom 'y' .", "an individual is compared with a value"),
    ],
)
def test_a_schema_that_redefines_the_vocabulary_is_not_compiled(text, problem):
    def check():
        check_all_compilable([one for one in triples(text) if is_schema(one)])
        for fact in (one for one in triples(text) if not is_schema(one)):
            check_compilable(fact)

    if problem is None:
        check()
    else:
        with pytest.raises(NotCompilable, match=problem):
            check()


def test_a_literal_has_no_properties():
    with pytest.raises(NotCompilable, match="a literal has properties"):
        check_compilable(('"x"', *triple(":a :p :b")[1:]))


@pytest.mark.parametrize(
    ("name", "expected"),
    [("xsd:integer", True), ("xsd:other", True), ("owl:real", True), ("owl:Class", False)],
)
def test_datatypes_are_those_of_xml_schema_and_those_with_known_values(name, expected):
    assert is_datatype(iri(name)) == expected
