"""Notes on terms of a query that are in no triple."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.sparql.queries.unknown_terms import unknown_term_notes
from semmap.nodes.kb_node.sparql.triples.dataset import Dataset
from semmap.ontology import vocabulary as v
from tests.kb_node.home import turtle

KNOWN = {"dm": v.TBOX, "": v.ABOX, "rdf": v.RDF, "owl": v.OWL}


@pytest.fixture(scope="module")
def dataset():
    return Dataset(
        1,
        turtle(
            "dm:Chair a owl:Class . dm:isOn a owl:ObjectProperty . :chair1 a dm:Chair ; dm:isOn :table1 ."
            "<urn:other#Chair> a owl:Class . :wrench1 dm:isOn :table1 ."
        ),
    )


@pytest.mark.parametrize(
    ("query", "notes"),
    [
        ("SELECT ?x { ?x a dm:Chair ; dm:isOn :table1 }", []),
        ("SELECT ?x { ?x a dm:Chiar }", ["unknown term dm:Chiar; did you mean dm:Chair?"]),
        ("SELECT ?x { ?x dm:isOm ?y }", ["unknown term dm:isOm; did you mean dm:isOn?"]),
        ("SELECT ?x { :chair2 dm:isOn ?x }", ["unknown term :chair2; did you mean :chair1?"]),
        ("SELECT ?x { ?x a dm:Zzzzzz }", ["unknown term dm:Zzzzzz"]),
        (f"SELECT ?x {{ ?x a <{v.TBOX}Chiar> }}", [f"unknown term <{v.TBOX}Chiar>; did you mean Chair?"]),
        ("SELECT ?x { ?x a <urn:other#Chiar> }", ["unknown term <urn:other#Chiar>; did you mean Chair?"]),
        ("PREFIX o: <urn:other#> SELECT ?x { ?x a o:Chair }", []),
        (
            "prefix o: <urn:other#> SELECT ?x { ?x a o:Chairs }",
            ["unknown term o:Chairs; did you mean o:Chair?"],
        ),
        ("PREFIX dm: <urn:none#> SELECT ?x { ?x a dm:Chair }", ["unknown term dm:Chair"]),
        ("SELECT ?x { ?x a owl:Klass ; rdf:nothing 1 }", []),
        ("SELECT ?x { ?x a none:Chair }", []),
        (
            "SELECT ?x { ?x a dm:Ch\\-air , dm:Ch\\-air }",
            ["unknown term dm:Ch\\-air; did you mean dm:Chair?"],
        ),
        ("SELECT ?x { ?x a <relative> }", []),
    ],
)
def test_a_term_of_no_triple_is_noted_once_with_similar_ones(dataset, query, notes):
    assert list(unknown_term_notes(query, dataset, KNOWN)) == notes
