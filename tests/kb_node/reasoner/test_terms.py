"""Terms in N-Triples syntax."""

import pytest

from semmap.nodes.kb_node.reasoner import terms
from semmap.nodes.kb_node.reasoner.terms import Literal, iri, iris, literal, quoted

XSD = terms.PREFIXES["xsd"]
RDF = terms.PREFIXES["rdf"]


def test_prefixed_names_become_terms():
    assert iri("owl:Thing") == "<http://www.w3.org/2002/07/owl#Thing>"
    assert iri("a") == f"<{RDF}type>" == terms.TYPE
    assert iris("xsd:int rdfs:label") == (f"<{XSD}int>", "<http://www.w3.org/2000/01/rdf-schema#label>")


def test_each_kind_of_term_is_recognised():
    assert [terms.is_literal(term) for term in ('"a"', "<urn:a>", "_:a")] == [True, False, False]
    assert [terms.is_named(term) for term in ('"a"', "<urn:a>", "_:a")] == [False, True, False]
    assert terms.is_reserved(iri("rdf:first"))
    assert terms.is_reserved(iri("xsd:int"))
    assert not terms.is_reserved("<http://www.w3.org/2003/01/geo/wgs84_pos#lat>")


@pytest.mark.parametrize(
    ("term", "text", "datatype", "language"),
    [
        ('"a b"', "a b", XSD + "string", ""),
        ('""', "", XSD + "string", ""),
        ('"chat"@fr-CA', "chat", RDF + "langString", "fr-CA"),
        (f'"1"^^<{XSD}int>', "1", XSD + "int", ""),
        (r'"a\"b\\c\nd\te\rf\bg\fh"', 'a"b\\c\nd\te\rf\bg\fh', XSD + "string", ""),
        (r'"\u00e9\U0001F600"', "é😀", XSD + "string", ""),
        (r'"\\u00e9"', r"\u00e9", XSD + "string", ""),
        ('"two\nlines"', "two\nlines", XSD + "string", ""),
    ],
)
def test_a_literal_is_read(term, text, datatype, language):
    assert literal(term) == Literal(text, datatype, language)


@pytest.mark.parametrize("term", ["<urn:a>", '"open', '"a"b', '"a"@', '"a"^^xsd:int', '"a"b"'])
def test_any_other_text_is_no_literal(term):
    with pytest.raises(ValueError, match="not a literal in N-Triples syntax"):
        literal(term)


@pytest.mark.parametrize(
    "text", ["", "plain", 'a "quote"', "back\\slash", "a\nb\tc\rd\be\f", "\x01\x7f", "é😀"]
)
@pytest.mark.parametrize(("datatype", "language"), [("", ""), (XSD + "int", ""), ("", "de")])
def test_a_written_literal_is_read_back(text, datatype, language):
    read = literal(quoted(text, datatype=datatype, language=language))
    assert read.text == text
    assert read.language == language
    assert read.datatype == (RDF + "langString" if language else datatype or XSD + "string")


def test_special_characters_are_escaped():
    assert quoted('a"\n\x01\\') == r'"a\"\n\u0001\\"'
    assert quoted("é", language="fr") == '"é"@fr'
    assert quoted("1", datatype=XSD + "int") == f'"1"^^<{XSD}int>'
