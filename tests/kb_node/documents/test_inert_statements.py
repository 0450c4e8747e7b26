"""Rules and shapes are stored and counted, and refuse nothing."""

import pytest

from semmap.nodes.kb_node.documents import abox_document
from semmap.nodes.kb_node.documents.inert_statements import count_inert, inert_note
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from tests.kb_node import home
from tests.kb_node.home import turtle

RULE = """
<urn:swrl#x> a <http://www.w3.org/2003/11/swrl#Variable> .
[] a <http://www.w3.org/2003/11/swrl#Imp> ; <http://www.w3.org/2003/11/swrl#body> () ;
    <http://www.w3.org/2003/11/swrl#head> () .
"""
SHAPES = """
:named a <http://www.w3.org/ns/shacl#NodeShape> ; <http://www.w3.org/ns/shacl#targetClass> dm:Chair .
:untyped <http://www.w3.org/ns/shacl#property> [ <http://www.w3.org/ns/shacl#path> dm:near ] ;
    <http://www.w3.org/ns/shacl#rule> [ <http://www.w3.org/ns/shacl#object> dm:Table ] .
"""


@pytest.mark.parametrize(
    ("text", "counts"),
    [
        (RULE, {"SWRL rule (empty)": 1}),
        (SHAPES, {"SHACL rule": 1}),
        (":a a dm:Chair .", {}),
    ],
)
def test_statements_that_are_not_evaluated_are_counted_by_kind(text, counts):
    assert count_inert(turtle(text)) == counts


def test_a_map_with_rules_and_shapes_is_accepted_with_a_note():
    triples = turtle(RULE + SHAPES + ":a a dm:Chair .")
    kept, _, notes = abox_document.filter_document(
        triples, ClassTable(Reasoner(home.TBOX)), skip_unknown=False
    )
    assert set(kept) == set(triples)
    assert notes == ["stored, but not evaluated: 1 SHACL rule, 1 SWRL rule (empty)"]
    assert inert_note(count_inert(())) == ""
