"""Proofs of one shape are found once: each is the same as one that is searched again."""

from itertools import permutations

import pytest

from semmap.nodes.kb_node.reasoner.explain.proof import Prover
from semmap.nodes.kb_node.reasoner.explain.words import Words
from tests.kb_node.reasoner.graphs import triple, triples
from tests.kb_node.reasoner.swrl import graph

TBOX = triples("""
:d a owl:FunctionalProperty . :mass a owl:DatatypeProperty ; rdfs:domain :Thing ; rdfs:range xsd:float .
:Heavy owl:equivalentClass [ owl:onProperty :mass ; owl:hasValue "9.5"^^xsd:float ] .
:Small owl:equivalentClass [ owl:onProperty :n ; owl:someValuesFrom xsd:byte ] .
:e rdfs:domain :Thing . :on rdfs:subPropertyOf :near . :near a owl:SymmetricProperty .
:House owl:hasKey ( :mass ) .
""")
RULE = graph("mass(x, v), b.greaterThan(v, 2) -> Big(x)")


def mass(*texts, name="a"):
    return " ".join(f':{name} :mass "{text}"^^xsd:float .' for text in texts)


CASES = {
    "numbers": [
        (mass("1.5"), ":a a :Thing"),
        (mass("2.5", name="b"), ":b a :Thing"),
        (":a :e 1 .", ":a a :Thing"),
        (':a :e "x"^^:unknown .', ":a a :Thing"),
        (':a :e "y"^^:unknown .', ":a a :Thing"),
    ],
    "a number in another spelling": [
        (mass("1.5"), ':a :mass "1.50"^^xsd:float'),
        (mass("2.5"), ':a :mass "2.50"^^xsd:float'),
        (':a :n "1"^^xsd:integer .', ':a :n "01"^^xsd:integer'),
        (':a :n "2"^^xsd:integer .', ':a :n "02"^^xsd:integer'),
    ],
    "a number that the TBox names": [
        (mass("9.5"), ":a a :Heavy"),
        (mass("9.50"), ":a a :Heavy"),
        (mass("9.5", name="b"), ":b a :Heavy"),
        (mass("9.50", "1.5"), ":a a :Heavy"),
        (mass("1.5", "9.50"), ":a a :Heavy"),
        (mass("1.5"), ":a a :Thing"),
        (mass("9.5"), ":a a :Thing"),
    ],
    "numbers by datatype": [(":a :n 5 .", ":a a :Small"), (":b :n 7 .", ":b a :Small")],
    "numbers that a rule compares": [(mass("3.5"), ":a a :Big"), (mass("4.5", name="b"), ":b a :Big")],
    "edges": [
        (":a :on :b .", ":b :near :a"),
        (":b :on :a .", ":a :near :b"),
        (":a :on :a .", ":a :near :a"),
        (":a :on :b .", ":a :near :b"),
        (":a :on :c .", ":c :near :a"),
    ],
    "two values": [
        (mass("1.5") + mass("1.5", name="b") + ":a a :House . :b a :House .", ":a owl:sameAs :b"),
        (mass("2.5") + mass("2.50", name="b") + ":a a :House . :b a :House .", ":a owl:sameAs :b"),
        (mass("2.5", name="c") + mass("2.50") + ":c a :House . :a a :House .", ":c owl:sameAs :a"),
    ],
    "contradictions": [
        (':a :d "1.5"^^xsd:float , "2.5"^^xsd:float .', None),
        (':b :d "3.5"^^xsd:float , "2.5"^^xsd:float .', None),
        (":a :d 1 , 2 .", None),
        (":b :d 3 , 2 .", None),
        (':b :d "a" , "b" .', None),
        (mass("x"), None),
        (mass("y"), None),
    ],
}


@pytest.mark.parametrize("cases", CASES.values(), ids=CASES)
def test_a_proof_of_a_known_shape_is_the_same_as_a_new_one(cases):
    words = Words.of(TBOX)
    rules = RULE if cases is CASES["numbers that a rule compares"] else []
    parsed = [([*triples(facts), *TBOX, *rules], goal and triple(goal)) for facts, goal in cases]
    new = [Prover(words).prove(facts, goal) for facts, goal in parsed]
    assert [proof.conclusion for proof in new] == [goal for _, goal in parsed]
    for one, other in permutations(range(len(parsed)), 2):
        shared = Prover(words)
        for at in (one, other):
            assert shared.prove(*parsed[at]) == new[at]


def test_what_does_not_follow_has_no_proof():
    for facts, goal in ((mass("1.5"), ":a a :Big"), (mass("1.5"), ":a a :Heavy"), (mass("1.5"), None)):
        with pytest.raises(ValueError, match="does not follow"):
            Prover(Words.of(TBOX)).prove([*triples(facts), *TBOX, *RULE], goal and triple(goal))
