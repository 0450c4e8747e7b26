"""Queries that may use measured properties are recognised by their text."""

import pytest

from semmap.nodes.kb_node.sparql.queries.footprint import patterns_of
from semmap.nodes.kb_node.sparql.queries.predicates import has_variable_predicate, may_use_properties
from semmap.ontology import vocabulary as v

WITH = [
    "SELECT * {?s ?p ?o}",
    "SELECT ?p ?o {:cup1 ?p ?o}",
    "ASK { :a a dm:Cup ; ?p 5 }",
    "SELECT ?x { ?x dm:q [ ?p ?y ] }",
    "SELECT ?x WHERE { FILTER NOT EXISTS { ?x ?q ?z } }",
    "SELECT ?x { { SELECT ?a ?b { ?a ?b true } } }",
    'SELECT ?x { ?x ?p "SELECT" . }',
    "DESCRIBE :a",
    "SELECT ?s { ?s ?p (1 2) }",
    "SELECT ?s {?s dm:a ?y.?y ?p ?z}",
    "SELECT ?s {?s dm:a 1.5 .?y ?p ?z}",
    "CONSTRUCT {?a ?b ?c} WHERE {?a ?b ?c}",
    "CONSTRUCT WHERE {?a ?b ?c}",
    "SELECT ?s {BIND(?x AS ?y) ?s ?p ?y}",
    "SELECT ?s {?s a dm:Cup.?s ?p ?y}",
    "SELECT ?s {?s a dm:Cup;?p ?y}",
    "SELECT ?s {?s ?p\n#c\n?y}",
    "SELECT ?x { _:a ?p ?x }",
    "SELECT ?x { ( [ ?p ?x ] ) a ?t }",
    "SELECT ?x {<urn:a> ?p ?x}",
    "SELECT ?x { :a dm:b 'x'@en ; ?p ?y }",
    "SELECT ?x { :a dm:b '5'^^xsd:integer , 6 ; ?p ?y }",
    "SELECT ?n {?s ?p ?o} ORDER BY ?n",
]
WITHOUT = [
    "SELECT ?a ?b ?c { ?a dm:x ?b . ?b dm:y ?c } ORDER BY ?a ?b ?c",
    "SELECT (COUNT(?x) AS ?n) ?y ?z { ?x dm:q ?y } GROUP BY ?y ?z ?q",
    "SELECT ?x { VALUES (?a ?b ?c) { (1 2 3) (:a :b :c) } ?x dm:q ?a }",
    "SELECT ?x { ?x a dm:Cup FILTER(?x = :cup1) ?x dm:on ?y FILTER regex(?x, 'a') ?x dm:in ?z }",
    "SELECT ?x { ?x dm:a/dm:b|^dm:c ?y ; dm:q ?z , ?w . OPTIONAL { ?x dm:z ?k } }",
    "SELECT ?x { ?x (dm:a|dm:b)+ ?y . BIND(1 AS ?z) ?y dm:q ?z }",
    "SELECT ?x { ?x dm:q '5'^^xsd:integer . ?x dm:z ?y }",
    "SELECT DISTINCT ?x ?y ?z WHERE { ?x dm:isOn ?y . FILTER EXISTS { ?y dm:isIn ?z } }",
    "SELECT ?x { ?x rdfs:label 'a'@en . ?y a ?c }",
]
NAMES = frozenset({"isNear"})


@pytest.mark.parametrize("query", WITH)
def test_a_variable_predicate_is_found(query):
    assert has_variable_predicate(query)


@pytest.mark.parametrize("query", WITHOUT)
def test_variables_at_other_positions_are_not_predicates(query):
    assert not has_variable_predicate(query)
    assert not may_use_properties(query, NAMES)


def test_a_name_is_found_in_any_spelling():
    assert may_use_properties("SELECT ?x { ?x dm:isNear ?y }", NAMES)
    assert may_use_properties("SELECT ?x { ?x <http://x/#isNear> ?y }", NAMES)
    assert may_use_properties("SELECT ?x { ?x dm:is\\u004Eear ?y }", NAMES)
    assert not may_use_properties("SELECT ?x { ?x dm:isOn ?y }", NAMES)


def test_the_terms_of_patterns_are_returned():
    found = patterns_of("PREFIX : <urn:> SELECT ?x { ?x dm:isNear :a ; ?p ?y . :b dm:isNear/dm:isOn [] }")
    assert found == {
        (None, v.dm("isNear"), "<urn:a>"),
        (None, None, None),
        ("<urn:b>", v.dm("isNear"), None),
        (None, v.dm("isOn"), None),
    }


def test_a_described_resource_may_be_at_either_end():
    assert patterns_of("DESCRIBE <urn:a>") == {("<urn:a>", None, None), (None, None, "<urn:a>")}


def test_a_path_that_may_have_no_steps_has_no_patterns():
    assert patterns_of("SELECT ?x { ?x dm:isNear* ?y }") is None
