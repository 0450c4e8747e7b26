"""Kinds: what follows from classes. All texts have one kind unless the schema distinguishes them."""

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


CLASSES = """
:B rdfs:subClassOf :A . :C rdfs:subClassOf :B . :A owl:disjointWith :X . :Y owl:complementOf :C .
:I owl:intersectionOf ( :A :D ) . :J owl:intersectionOf ( :I :E ) . :U owl:unionOf ( :D :E ) .
[] a owl:AllDisjointClasses ; owl:members ( :E :F :G ) . :None rdfs:subClassOf owl:Nothing .
:V rdfs:subClassOf [ owl:onProperty :p ; owl:hasValue :v ] . :W rdfs:subClassOf :V .
:One owl:oneOf ( :i :j ) .
"""


@pytest.mark.parametrize(
    ("given", "names", "clash"),
    [
        ("", "", False),
        ("A", "A", False),
        ("C", "A B C", False),
        ("D", "D U", False),
        ("A D", "A D I U", False),
        ("C D", "A B C D I U", False),
        ("A D E", "A D E I J U", False),
        ("I", "A D I U", False),
        ("J", "A D E I J U", False),
        ("U", "U", False),
        ("C X", "A B C X", True),
        ("C Y", "A B C Y", True),
        ("B Y", "A B Y", False),
        ("E G", "E G U", True),
        ("F", "F", False),
        ("W", "V W", False),
    ],
)
def test_the_classes_that_follow_from_given_classes(given, names, clash):
    schema = Reasoner(triples(CLASSES))._engine._schema
    found = Kinds(schema)

    def term(name):
        return f"<http://example.org/{name}>"

    kind = found.of(frozenset(schema.cls(term(name)) for name in given.split()))
    assert {name for name in kind.names if "owl#" not in name} == set(map(term, names.split()))
    assert (kind.clash is not None) is clash
    assert kind.base is kind
    assert [value for _, value in kind.values] == ([term("v")] if "V" in names else [])
    assert kind.value_terms == {value for _, value in kind.values}
    one_by_one = found.nothing
    for name in given.split():
        one_by_one = found.add_given(one_by_one, schema.cls(term(name)))
    assert one_by_one is kind
    for name in given.split():
        one_by_one = found.without(one_by_one, schema.cls(term(name)))
    assert (one_by_one.mask, one_by_one.base) == (kind.mask, found.nothing)


def test_an_enumerated_individual_begins_in_its_class():
    found = kinds(CLASSES)
    names = found.individual("<http://example.org/i>").names
    assert "<http://example.org/One>" in names
    assert found.individual("<http://example.org/k>") is found.nothing
