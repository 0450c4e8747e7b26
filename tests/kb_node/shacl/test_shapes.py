"""Shapes are validated over asserted, inferred and computed facts."""

import pytest

from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.shacl.shapes import Shapes
from semmap.nodes.kb_node.shacl.violations import to_violation
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from tests.kb_node import home
from tests.kb_node.home import turtle

SH = "@prefix sh: <http://www.w3.org/ns/shacl#> .\n"
FACTS = """
:chair1 a dm:Chair ; dm:isLocatedIn :kitchen1 ; dm:seats 3 .
:chair2 a dm:Chair ; owl:sameAs :stool2 .
:stool2 dm:seats "x" .
:kitchen1 a dm:Kitchen .
"""


def found(shapes, facts=FACTS, touched=None, computed=""):
    reasoner = Reasoner([*home.TBOX, *turtle(facts)])
    reasoner.update_computed(add=turtle(computed))
    terms = None if touched is None else [v.entity_iri(name) for name in touched]
    results = Shapes(turtle(SH + shapes), "s.ttl").validate(reasoner, terms)
    return [to_violation(result, v.entity_name, {}).text for result in results]


def of_chairs(constraint):
    return f"[] sh:targetClass dm:Seat ; sh:property [ {constraint} ] ."


@pytest.mark.parametrize(
    ("constraint", "texts"),
    [
        (
            "sh:path dm:isLocatedIn ; sh:minCount 1",
            ["chair2: the values of isLocatedIn violate sh:minCount 1; correct the map or the shape"],
        ),
        (
            "sh:path dm:seats ; sh:datatype xsd:integer",
            ["chair2: the value x of seats violates sh:datatype integer; correct the map or the shape"],
        ),
        (
            "sh:path dm:seats ; sh:in ( 3 ) ; sh:message 'gar nicht'@de , 'not this'@en",
            ["chair2: not this; seats; x"],
        ),
        ("sh:path dm:isLocatedIn ; sh:class dm:Location", []),
        (
            "sh:path ( dm:isLocatedIn [ sh:inversePath dm:isLocatedIn ] ) ; sh:maxCount 0",
            [
                "chair1: the values of isLocatedIn / ^isLocatedIn violate sh:maxCount 0; "
                "correct the map or the shape"
            ],
        ),
        ("sh:path dm:isLocatedIn ; sh:minCount 1 ; sh:deactivated true", []),
    ],
)
def test_violations_are_sentences_with_path_and_value(constraint, texts):
    assert found(of_chairs(constraint)) == texts


def test_inferred_and_computed_facts_count():
    shape = of_chairs("sh:path dm:isOn ; sh:minCount 1")
    assert found(shape, computed=":chair1 dm:isOn :kitchen1 . :stool2 dm:isOn :kitchen1 .") == []
    assert found("[] sh:targetObjectsOf dm:isLocatedIn ; sh:class dm:Location .") == []
    assert found("[] sh:targetSubjectsOf dm:isOn ; sh:class dm:Location .", computed=":a dm:isOn :b .") == [
        "a: violates sh:class Location; correct the map or the shape"
    ]


def test_equal_individuals_are_one_node():
    assert found("[] sh:targetClass dm:Chair ; sh:property [ sh:path dm:seats ; sh:maxCount 1 ] .") == []
    facts = ":a a dm:Chair ; dm:near :b , :c . :b owl:sameAs :c ."
    assert found(of_chairs("sh:path dm:near ; sh:maxCount 1"), facts) == []


def test_only_what_is_touched_is_validated():
    shape = of_chairs("sh:path dm:seats ; sh:maxCount 0")
    assert found(shape, touched=["chair1", "kitchen1"]) == [
        "chair1: the values of seats violate sh:maxCount 0; correct the map or the shape"
    ]
    assert found(shape, touched=["stool2"]) == [
        "chair2: the values of seats violate sh:maxCount 0; correct the map or the shape"
    ]
    assert found("[] sh:targetNode :chair1 ; sh:class dm:Door .", touched=["chair2"]) == []


@pytest.mark.parametrize(
    "shapes",
    [
        "[] sh:targetNode :a ; sh:property [ sh:path dm:seats ; sh:minCount 'x' ] .",
        "[] sh:targetNode :chair1 ; sh:property [ sh:path dm:seats ; sh:pattern '(' ] .",
        "[] a sh:PropertyShape ; sh:targetNode :a .",
        "[] sh:targetNode :a ; sh:property [ sh:path 'seats' ; sh:minCount 1 ] .",
        "[] sh:targetNode :a ; sh:property [ sh:path ( dm:seats ) ; sh:minCount 1 ] .",
        ":s sh:targetNode :a ; sh:node :s .",
    ],
)
def test_invalid_shapes_are_errors_in_one_line(shapes):
    with pytest.raises(errors.BadFile, match=r"^s\.ttl: invalid SHACL shape: .+$"):
        found(shapes)


def test_many_individuals_are_validated_in_parts():
    facts = " ".join(f":c{n} a dm:Chair ." for n in range(250))
    texts = found(of_chairs("sh:path dm:isLocatedIn ; sh:minCount 1 ; sh:message 'm'"), facts)
    assert sorted(texts) == sorted(f"c{n}: m; isLocatedIn" for n in range(250))


def test_sparql_is_not_evaluated():
    shape = """[] sh:targetNode :chair1 ; sh:sparql [ sh:message "m" ;
        sh:select "SELECT $this WHERE { SERVICE <http://127.0.0.1:9/> { ?s ?p ?o } }" ] ."""
    assert found(shape) == []
