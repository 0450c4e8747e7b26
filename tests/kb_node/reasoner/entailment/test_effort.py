"""The limits of a search for a proof."""

from __future__ import annotations

from semmap.nodes.kb_node.reasoner.entailment.effort import Effort

ONE, TWO = ("a", "b", "c"), ("d", "e", "f")


def test_a_proof_has_a_thousand_assumptions_and_the_next_proof_as_many():
    effort = Effort()
    for _ in range(2):
        assert all(effort.may_assume() for _ in range(1000))
        assert not effort.may_assume()
        assert not effort.may_assume()
        effort.reset()


def test_nothing_is_assumed_after_the_time_limit():
    assert Effort(0.0).is_over
    assert not Effort(0.0).may_assume()
    assert not Effort(3600.0).is_over
    assert not Effort().is_over


def test_facts_are_recorded_once_and_in_order_if_traced():
    effort = Effort(traced=True)
    effort.note([TWO, ONE])
    effort.note([TWO])
    assert effort.is_traced
    assert effort.seen == [TWO, ONE]


def test_facts_are_not_recorded_if_not_traced():
    effort = Effort()
    effort.note([ONE])
    assert not effort.is_traced
    assert effort.seen == []


def test_assumptions_that_recompute_everything_are_allowed_by_default():
    assert Effort().allow_recompute
    assert not Effort(allow_recompute=False).allow_recompute
