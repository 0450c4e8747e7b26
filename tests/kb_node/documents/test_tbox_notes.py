from nodes.kb_node.documents import rdf, tbox_notes
from nodes.kb_node.entities.class_table import ClassTable
from nodes.kb_node.reasoner import Reasoner
from tests.kb_node import home


def notes(text: str = ""):
    tbox = rdf.parse((home.TBOX_TURTLE + text).encode(), "tbox", label_prefix="t")
    reasoner = Reasoner(tbox)
    return tbox_notes.notes(tbox, reasoner, ClassTable(reasoner))


def test_of_a_plain_tbox_nothing_is_to_be_said():
    assert notes() == ()


def test_missing_imports_are_named():
    assert notes("<urn:o> a owl:Ontology ; owl:imports <urn:p> , <urn:o> .") == (
        "1 import was not found, and the TBox holds without: urn:p",
    )
    many = " , ".join(f"<urn:p{i}>" for i in range(7))
    assert notes(f"<urn:o> owl:imports {many} .") == (
        "7 imports were not found, and the TBox holds without:"
        " urn:p0, urn:p1, urn:p2, urn:p3, urn:p4 and 2 more",
    )
