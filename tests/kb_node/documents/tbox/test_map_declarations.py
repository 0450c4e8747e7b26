import pytest

from semmap.nodes.kb_node.documents.tbox.map_declarations import describe, split_declarations
from tests.kb_node.home import turtle

DECLARED = """
:Mug a owl:Class ; rdfs:label "mug" ; rdfs:subClassOf dm:Object ,
    [ a owl:Restriction ; owl:onProperty :holds ; owl:allValuesFrom [ owl:oneOf ( :a :b ) ] ] .
:holds a owl:ObjectProperty ; rdfs:domain :Mug . :Cup rdfs:subClassOf :Mug .
[] a owl:AllDisjointClasses ; owl:members ( :Mug dm:Chair ) .
"""
STATED = """
:mug1 a :Mug ; :holds :tea ; :in [ :room "kitchen" ] ; :parts ( :lid :rim ) .
:mug2 a [ a owl:Restriction ; owl:onProperty :holds ; owl:hasValue :tea ] .
[] a owl:AllDifferent ; owl:distinctMembers ( :mug1 :mug2 ) .
<urn:map> a owl:Ontology ; owl:imports <urn:other> . :mug1 owl:sameAs :mug3 .
"""


def test_declarations_are_told_from_statements_with_their_nameless_parts():
    declared, stated = turtle(DECLARED), turtle(STATED)
    found = split_declarations([*stated, *declared])
    assert (len(found.declared), len(found.others)) == (len(declared), len(stated))
    assert {p for _, p, _ in found.declared if "holds" in p or "parts" in p} == set()
    assert describe(found.declared) == "added to the TBox: 1 class and 1 property of the file"


def test_what_the_tbox_has_already_gets_its_labels():
    known = turtle(DECLARED)
    renamed = [tuple(term.replace("_:", "_:other") for term in triple) for triple in known]
    assert set(split_declarations(renamed, known).declared) == set(known)


@pytest.mark.parametrize("text", [STATED, ""])
def test_a_map_without_declarations_has_none(text):
    assert split_declarations(turtle(text)).declared == []
