"""A graph with its closure, as it is read by patterns."""

import pytest

from semmap.nodes.kb_node.reasoner.rules.general import GeneralEngine
from semmap.nodes.kb_node.reasoner.terms import TYPE
from tests.kb_node.reasoner.graphs import triple, triples

GRAPH = """:A rdfs:subClassOf :B . :x a :A ; :p :y ; owl:sameAs :z ; :d 1.0 , "1.00"^^xsd:decimal .
:d rdfs:range xsd:decimal . :y :p [ a :C ] ."""
ENGINE = GeneralEngine(triples(GRAPH), computed=triples(":y a :A . :x :p :y ."))
X, Y, Z = (triple(f":{name} a :A")[0] for name in "xyz")
A, B = (triple(f":x a :{name}")[2] for name in "AB")


@pytest.mark.parametrize(
    ("fact", "holds"),
    [
        (":x a :B", True),
        (":z :p :y", True),
        (":y a :B", True),  # by a computed fact
        (":x :d 1", True),
        (":x :d 01.000", True),
        (":x :d 2", False),
        (":y :p :x", False),
    ],
)
def test_a_fact_holds_in_each_spelling(fact, holds):
    assert ENGINE.holds(triple(fact)) == holds


@pytest.mark.parametrize(
    ("pattern", "found"),
    [
        ((X, None, None), ":x a :B"),
        ((Z, None, None), ":z a :A , :B ; :p :y ; :d 1 ; owl:sameAs :x"),
        ((None, TYPE, B), ":x a :B . :y a :B . :z a :B"),
        ((None, *triple(":x :d 1")[1:]), ":z :d 1"),
        ((A, TYPE, None), ""),
    ],
)
def test_what_is_inferred_is_not_asserted(pattern, found):
    assert sorted(ENGINE.inferred(*pattern)) == sorted(triples(found + " ." if found else ""))


def test_what_is_known_of_a_graph():
    assert len(ENGINE) == len(triples(GRAPH))
    about = {p: sorted(objects) for p, objects in ENGINE.about(X).items()}
    assert {(p, o) for p, objects in about.items() for o in objects} == {
        t[1:] for t in triples(GRAPH) if t[0] == X
    }
    assert ENGINE.mentioned({X, Y, Z, B, "<urn:none>"}) == {X, Y, Z, B}
    assert set(ENGINE.equals(X)) == set(ENGINE.equals(Z)) == {X, Z}
    assert not ENGINE.equals(Y)
    assert ENGINE.types(Z) == {A, B}
    assert set(ENGINE.instances(B)) == {X, Y, Z}
    computed = triple(":y a :A")
    assert list(ENGINE.computed(None, None, None)) == list(ENGINE.computed(*computed)) == [computed]
    assert not list(ENGINE.computed(X, None, None))
    assert ENGINE.is_computed(computed)
    assert not ENGINE.is_computed(triple(":x :p :y"))
    assert ENGINE.contradiction() is None
