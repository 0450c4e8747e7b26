"""Conclusions of each kind of axiom and rule are explained, also over equal individuals."""

import random

import pytest

from semmap.nodes.kb_node.reasoner import Reasoner
from tests.kb_node.reasoner import proofs
from tests.kb_node.reasoner.abox.test_rule_matching import CASES
from tests.kb_node.reasoner.abox.test_saturation import CONSISTENT
from tests.kb_node.reasoner.graphs import triples
from tests.kb_node.reasoner.swrl import graph


def check_an_explanation(tbox, facts):
    """Check the explanation of a random conclusion, if any, of facts that were inserted one by one."""
    reasoner = Reasoner(tbox)
    for fact in facts:
        reasoner.apply(insert=[fact])
    if found := sorted(reasoner.inferred()):
        fact = random.Random(1).choice(found)
        explanation = reasoner.explain(fact)
        assert explanation.conclusion == fact
        proofs.check(explanation, [*tbox, *facts])


@pytest.mark.parametrize(("axioms", "facts"), CONSISTENT.values(), ids=CONSISTENT)
def test_a_conclusion_is_explained(axioms, facts):
    check_an_explanation(triples(f"{axioms} ." if axioms else ""), triples(f"{facts} ."))


@pytest.mark.parametrize(("rules", "axioms", "facts"), CASES.values(), ids=CASES)
def test_a_conclusion_of_a_rule_is_explained(rules, axioms, facts):
    check_an_explanation(graph(*rules, axioms=axioms), triples(f"{facts} ."))
