"""Conclusions of each kind of axiom and rule are explained, also over equal individuals."""

import random

import pytest

from semmap.nodes.kb_node.reasoner import Reasoner
from tests.kb_node.reasoner import proofs
from tests.kb_node.reasoner.abox.test_rule_matching import CASES
from tests.kb_node.reasoner.abox.test_saturation import CONSISTENT
from tests.kb_node.reasoner.graphs import triples
from tests.kb_node.reasoner.swrl import graph

MOST = 3
"""The number of conclusions that are explained in each case."""


def check_explanations(tbox, facts):
    """Check explanations of some conclusions, of facts that were inserted one by one."""
    reasoner = Reasoner(tbox)
    for fact in facts:
        reasoner.apply(insert=[fact])
    found = sorted(reasoner.inferred())
    for fact in random.Random(1).sample(found, min(MOST, len(found))):
        explanation = reasoner.explain(fact)
        assert explanation.conclusion == fact
        proofs.check(explanation, [*tbox, *facts])


@pytest.mark.parametrize(("axioms", "facts"), CONSISTENT.values(), ids=CONSISTENT)
def test_a_conclusion_is_explained(axioms, facts):
    check_explanations(triples(f"{axioms} ." if axioms else ""), triples(f"{facts} ."))


@pytest.mark.parametrize(("rules", "axioms", "facts"), CASES.values(), ids=CASES)
def test_a_conclusion_of_a_rule_is_explained(rules, axioms, facts):
    check_explanations(graph(*rules, axioms=axioms), triples(f"{facts} ."))
