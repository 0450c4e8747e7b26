"""A document that is nested too deeply is rejected before a native parser reads it."""

import pytest

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.nesting import LIMIT
from semmap.schemas import errors

OWL = "http://www.w3.org/2002/07/owl#"


def functional(levels):
    inner = f"{'ObjectComplementOf(' * levels}<http://o#B>{')' * levels}"
    return f"Ontology(<http://o>\nSubClassOf(<http://o#A> {inner}))"


def manchester(levels):
    inner = f"{'not (' * levels}<http://o#B>{')' * levels}"
    return f"Ontology: <http://o>\nClass: <http://o#A>\n SubClassOf: {inner}"


def owlxml(levels):
    inner = f"{'<ObjectComplementOf>' * levels}<Class IRI='http://o#B'/>{'</ObjectComplementOf>' * levels}"
    return (
        f'<?xml version="1.0"?><Ontology xmlns="{OWL}" ontologyIRI="http://o"><SubClassOf>'
        f"<Class IRI='http://o#A'/>{inner}</SubClassOf></Ontology>"
    )


def jsonld(levels):
    return '{"@id": "http://o#a", "http://o#p": ' * levels + '"x"' + "}" * levels


@pytest.mark.parametrize("write", [functional, manchester, owlxml, jsonld])
@pytest.mark.parametrize("levels", [LIMIT + 1, 4_000, 60_000])
def test_deep_nesting_is_rejected_with_its_line(write, levels):
    with pytest.raises(
        errors.BadFile, match=rf"x is not valid .*: nested deeper than {LIMIT} levels \(line \d"
    ):
        rdf.parse(write(levels).encode(), "x")
    assert rdf.prefixes(write(levels).encode()) == {}


@pytest.mark.parametrize("write", [functional, manchester, owlxml, jsonld])
def test_ordinary_nesting_is_read(write):
    assert rdf.parse(write(LIMIT - 10).encode(), "x")


def test_brackets_in_texts_iris_and_comments_do_not_count():
    texts = " ".join(f'AnnotationAssertion(<http://o#p> <http://o#A> "((( \\" ((({n}")' for n in range(100))
    many = f"# {'(' * 300}\nOntology(<http://o> {texts} Declaration(Class(<http://o#{'(' * 300}>)))"
    assert len(rdf.parse(many.encode(), "x")) > 100


def test_nested_turtle_is_read_without_a_limit():
    deep = ":a :p " + "[ :p " * 5_000 + ":b" + " ]" * 5_000 + " ."
    assert len(rdf.parse(f"@prefix : <http://o#> . {deep}".encode(), "x")) == 5_001
