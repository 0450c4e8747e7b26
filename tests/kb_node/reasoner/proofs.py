"""Checks of explanations."""

from semmap.nodes.kb_node.reasoner.rules.closure import Closure


def check(explanation, asserted):
    """Check that the support is asserted, sufficient and minimal, and that the steps prove the conclusion."""
    goal, support = explanation.conclusion, list(explanation.support)
    assert set(support) <= set(asserted)
    assert _reached(support, goal)
    for left_out in support:
        assert not _reached([fact for fact in support if fact != left_out], goal), f"{left_out} is not needed"
    known = set(support)
    for step in explanation.steps:
        assert set(step.premises) <= known
        known.add(step.conclusion)
    assert goal in known or not explanation.steps
    assert explanation.text.endswith(".")
    assert "http://" not in explanation.text


def _reached(some, goal):
    closure = Closure(some, mentions=goal or ())  # the goal may have another spelling of a value
    return closure.clash is not None if goal is None else closure.clash is None and closure.holds(goal)
