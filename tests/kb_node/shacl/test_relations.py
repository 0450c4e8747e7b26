"""Which facts imply facts of other properties."""

import pytest

from semmap.nodes.kb_node.shacl.relations import Relations
from semmap.ontology import vocabulary as v
from tests.kb_node.home import turtle

TBOX = turtle(
    """
dm:on rdfs:subPropertyOf dm:touches ; owl:inverseOf dm:supports . dm:carries rdfs:subPropertyOf dm:supports .
dm:touches a owl:SymmetricProperty . dm:rests owl:equivalentProperty dm:on .
dm:over rdfs:subPropertyOf [ owl:inverseOf dm:under ] .
"""
)
A, B = v.iri(f"{v.ABOX}a"), v.iri(f"{v.ABOX}b")


@pytest.mark.parametrize(
    ("wanted", "given", "ends"),
    [
        ("on", "on", [(A, B)]),
        ("on", "rests", [(A, B)]),
        ("on", "carries", [(B, A)]),
        ("on", "touches", []),
        ("touches", "carries", [(A, B), (B, A)]),
        ("under", "over", [(B, A)]),
        ("over", "under", []),
    ],
)
def test_facts_of_a_property_follow_from_those_below_it(wanted, given, ends):
    relations = Relations.of([v.iri(v.TBOX + wanted)], TBOX)
    assert sorted(relations.select([(A, v.iri(v.TBOX + given), B)])) == ends
