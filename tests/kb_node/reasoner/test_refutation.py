"""Assumptions are always reverted, and a refutation is a proof."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.refutation import refute, why_different
from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from semmap.nodes.kb_node.reasoner.tbox.axioms import NotCompilable
from semmap.nodes.kb_node.reasoner.terms import DIFFERENT_FROM, SAME_AS
from tests.kb_node.reasoner.facts import ANY_FACT
from tests.kb_node.reasoner.graphs import EVERYTHING, household, triple, triples

BASE = triples(EVERYTHING)


def _snapshot(reasoner):
    """Return all query results of a reasoner, and its nodes."""
    engine = reasoner._engine
    return set(reasoner.asserted()), set(reasoner.inferred()), len(reasoner), set(engine._abox.store.numbers)


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(ANY_FACT, max_size=6), st.lists(ANY_FACT, min_size=1, max_size=8))
def test_an_assumption_leaves_no_trace(facts, supposed):
    check_assuming(facts, supposed)


@pytest.mark.long
@settings(max_examples=500, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(ANY_FACT, max_size=6), st.lists(ANY_FACT, min_size=1, max_size=8))
def test_any_of_many_assumptions_leaves_no_trace(facts, supposed):
    check_assuming(facts, supposed)


def check_assuming(facts, supposed):
    reasoner = Reasoner(BASE)
    for fact in facts:
        try:
            reasoner.apply(insert=[fact])
        except Inconsistent:
            continue
    before = _snapshot(reasoner)
    for triple_ in supposed:
        why = refute(reasoner, triple_)
        assert (why is None) == (Closure([*reasoner.asserted(), triple_]).clash is None)
        if why is not None:
            check(why, set(reasoner.asserted()))
        assert _snapshot(reasoner) == before


def check(why, asserted):
    """The assumption contradicts the support, and the support is minimal."""
    assert set(why.support) <= asserted
    assert Closure([*why.support, why.supposed]).clash is not None
    for left_out in why.support:
        rest = [fact for fact in why.support if fact != left_out]
        assert Closure([*rest, why.supposed]).clash is None
    assert why.text.endswith(".")
    assert "http" not in why.text


def _fail_while_assuming(reasoner, *supposed):
    with reasoner.assuming(supposed):
        assert reasoner.holds(triple(":i1 a :F"))
        raise ZeroDivisionError


def test_assumptions_nest_and_end_with_an_error():
    reasoner = Reasoner(BASE)
    before = _snapshot(reasoner)
    with reasoner.assuming([triple(":i0 a :B")]):
        with pytest.raises(ZeroDivisionError):
            _fail_while_assuming(reasoner, triple(":i0 :p :i1"), triple(":i0 a :B"))
        assert reasoner.holds(triple(":i0 a :A"))
        assert not reasoner.holds(triple(":i1 a :F"))
        with pytest.raises(Inconsistent), reasoner.assuming([triple(":i0 a :X"), triple(":i0 a :Y")]):
            pass
    assert _snapshot(reasoner) == before


def test_axioms_are_assumed_in_a_new_engine_and_the_old_one_is_restored():
    reasoner = Reasoner(BASE)
    engine = reasoner._engine
    with (
        pytest.raises(NotCompilable),
        reasoner.assuming([triple(":B rdfs:subClassOf :G")], allow_recompute=False),
    ):
        pass
    with reasoner.assuming([triple(":B rdfs:subClassOf :G"), triple(":i0 a :B")]):
        assert reasoner.holds(triple(":i0 a :G"))
    assert reasoner._engine is engine
    assert not reasoner.holds(triple(":i0 a :B"))


def test_why_two_individuals_are_different():
    reasoner = Reasoner([*household(), *triples(':a dm:mass "1"^^xsd:float . :b dm:mass "2"^^xsd:float .')])
    why = why_different(reasoner, triple(":a owl:differentFrom :b"))
    assert (why.conclusion[1], why.supposed[1]) == (DIFFERENT_FROM, SAME_AS)
    assert why.text == (
        "a is different from b, because a has mass 1 (asserted), b has mass 2 (asserted), "
        "and nothing has more than one mass."
    )
    check(why, set(reasoner.asserted()))
    assert why_different(reasoner, triple(":a owl:differentFrom :c")) is None
    assert why_different(reasoner, triple(":a owl:sameAs :b")) is None
