"""Terms of SWRL rules that nothing declares are named."""

import pytest

from semmap.nodes.kb_node.documents import abox_document
from semmap.nodes.kb_node.documents.rule_terms import undeclared_note, undeclared_terms
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import vocabulary as v
from tests.kb_node import home
from tests.kb_node.reasoner.graphs import triple
from tests.kb_node.reasoner.swrl import graph

DECLARED = ":Cup a owl:Class . :Full rdfs:subClassOf :Cup ; a owl:Class . :on a owl:ObjectProperty ."


@pytest.mark.parametrize(
    ("rule", "undeclared"),
    [
        ("Cup(x), on(x, y) -> Full(x)", []),
        ("Cpu(x), onn(x, y) -> Ful(x)", ["Cpu", "Ful", "onn"]),
        ("Cup(x), b.stringConcat(y, x, x) -> Ful(x)", []),  # it has no effect, which is another note
        ("Cup(x), sameAs(x, y), Cup(y) -> differentFrom(x, y)", []),
    ],
)
def test_undeclared_classes_and_properties_of_rules_are_found(rule, undeclared):
    found = undeclared_terms(graph(rule, axioms=DECLARED))
    assert [v.local_name(term) for term in found] == undeclared


def test_terms_that_are_declared_elsewhere_are_known():
    onn = triple(":x :onn :y")[1]
    assert undeclared_terms(graph("Cup(x), onn(x, y) -> Full(x)", axioms=DECLARED), {onn}) == []


def test_a_note_names_the_terms():
    found = undeclared_terms(graph("Cpu(x), onn(x, y) -> Cup(x)", axioms=DECLARED))
    assert undeclared_note(found) == "2 terms of SWRL rules not declared: Cpu and onn; check the spelling"
    assert undeclared_note([]) == ""


def test_the_notes_of_a_map_name_the_undeclared_terms_of_its_rules():
    rules = graph("Cpu(x) -> Cup(x)", axioms=":Cup a owl:Class .")
    chair = home.turtle(":chair1 a dm:Chair .")
    _, _, notes = abox_document.filter_document(
        [*rules, *chair], ClassTable(Reasoner(home.TBOX)), skip_unknown=False
    )
    assert "1 term of SWRL rules not declared: Cpu; check the spelling" in notes
