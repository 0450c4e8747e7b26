"""Computed and suppressed facts have the consequences that asserted facts have."""

import pytest

from tests.kb_node.reasoner.abox.test_rule_matching import CASES
from tests.kb_node.reasoner.abox.test_saturation import CONSISTENT, CONTRADICTORY
from tests.kb_node.reasoner.graphs import triples
from tests.kb_node.reasoner.orders import check_computed
from tests.kb_node.reasoner.swrl import graph


@pytest.mark.parametrize(("axioms", "facts"), CONSISTENT.values(), ids=CONSISTENT)
def test_computed_facts_have_the_conclusions_of_the_rules(axioms, facts):
    assert check_computed(triples(f"{axioms} ." if axioms else ""), triples(f"{facts} .")) == 0


@pytest.mark.parametrize(("rules", "axioms", "facts"), CASES.values(), ids=CASES)
def test_computed_facts_match_swrl_rules(rules, axioms, facts):
    assert check_computed(graph(*rules, axioms=axioms), triples(f"{facts} .")) == 0


@pytest.mark.parametrize(("axioms", "facts"), CONTRADICTORY.values(), ids=CONTRADICTORY)
def test_a_contradiction_with_a_computed_fact_is_rejected(axioms, facts):
    assert check_computed(triples(f"{axioms} ."), triples(f"{facts} .")) > 0
