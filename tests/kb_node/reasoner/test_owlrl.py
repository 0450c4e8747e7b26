"""The engine beside owlrl, an implementation of the same rules by others, where owlrl follows them."""

import random

import owlrl
import pytest
import rdflib

from nodes.kb_node.reasoner import Inconsistent, Reasoner
from nodes.kb_node.reasoner.terms import SAME_AS, TYPE
from tests.kb_node.reasoner.graphs import CLASSES, EVERYTHING, OBJECT_PROPERTIES, triples

INDIVIDUALS = [f":i{n}" for n in range(7)]


def _map(seed):
    """A random consistent map of 25 facts, and the reasoner that holds it."""
    random_ = random.Random(seed)
    reasoner = Reasoner(triples(EVERYTHING))
    facts = []
    while len(facts) < 25:
        s, o = random_.choice(INDIVIDUALS), random_.choice(INDIVIDUALS)
        cls, prop = random_.choice(CLASSES), random_.choice(OBJECT_PROPERTIES)
        fact = random_.choice(
            (f"{s} a :{cls}", f"{s} :{prop} {o}", f"{s} :{prop} {o}", f"{s} owl:sameAs {o}")
        )
        try:
            reasoner.apply(insert=triples(fact + " ."))
        except Inconsistent:
            continue
        facts.append(fact)
    return " .\n".join(facts) + " .", reasoner


def _by_owlrl(turtle):
    graph = rdflib.Graph().parse(data="".join(f"{s} {p} {o} .\n" for s, p, o in triples(turtle)), format="nt")
    owlrl.DeductiveClosure(owlrl.OWLRL_Semantics).expand(graph)
    return {tuple(term.n3() for term in fact) for fact in graph}


def _about_individuals(facts):
    names = {f"<http://example.org/{name[1:]}>" for name in INDIVIDUALS}
    return {
        (s, p, o)
        for s, p, o in facts
        if s in names
        and (p != SAME_AS or s != o)
        and (p.startswith("<http://example.org/") or p == SAME_AS or (p == TYPE and "example.org" in o))
    }


@pytest.mark.parametrize("seed", range(3))
def test_the_same_follows_as_with_owlrl(seed):
    abox, reasoner = _map(seed)
    ours = _about_individuals({*reasoner.asserted(), *reasoner.inferred()})
    assert ours == _about_individuals(_by_owlrl(EVERYTHING + abox))
