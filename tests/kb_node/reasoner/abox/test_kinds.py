"""Kinds of literals: all texts have one kind unless the schema distinguishes them."""

import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.abox.kinds import Kinds
from semmap.nodes.kb_node.reasoner.terms import iri
from tests.kb_node.reasoner.graphs import triples


def kinds(tbox):
    return Kinds(Reasoner(triples(tbox))._engine._schema)


def test_plain_texts_share_a_kind_that_numbers_and_tagged_texts_do_not_have():
    found = kinds(":name a owl:DatatypeProperty ; rdfs:range xsd:string .")
    assert found.literal('"cup"') is found.literal('"the blue cup, 2nd shelf"') is found.literal('"caffè"')
    others = ['"cup"@en', '"1"^^<http://www.w3.org/2001/XMLSchema#integer>']
    assert all(found.literal(term) is not found.literal('"cup"') for term in others)


@pytest.mark.parametrize(
    ("tbox", "one", "other"),
    [
        (":code a owl:DatatypeProperty ; rdfs:range xsd:token .", "two  spaces", "two spaces"),
        (":code a owl:DatatypeProperty ; rdfs:range xsd:NCName .", "1st", "first"),
    ],
)
def test_texts_are_distinguished_if_the_schema_does(tbox, one, other):
    found = kinds(tbox)
    assert found.literal(f'"{one}"') is not found.literal(f'"{other}"')
    reasoner = Reasoner(triples(tbox))
    code = triples(":a :code [] .")[0][1]
    reasoner.apply(insert=[("<http://x/a>", code, f'"{other}"')])
    with pytest.raises(Inconsistent):
        reasoner.apply(insert=[("<http://x/a>", code, f'"{one}"')])


def test_a_text_in_a_class_definition_is_distinguished():
    tbox = ":Red a owl:Class ; owl:equivalentClass [ owl:onProperty :colour ; owl:hasValue 'red' ] ."
    reasoner = Reasoner(triples(tbox))
    (red, *_), colour = triples(":Red a owl:Class .")[0], triples(":a :colour 'red' .")[0][1]
    reasoner.apply(insert=[("<http://x/a>", colour, '"red"'), ("<http://x/b>", colour, '"blue"')])
    assert reasoner.types("<http://x/a>") - {iri("owl:Thing")} == {red}
    assert red not in reasoner.types("<http://x/b>")
