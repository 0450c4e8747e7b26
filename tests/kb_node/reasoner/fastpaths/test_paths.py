"""Copies of the same facts: the result does not depend on the fast paths."""

import pytest

from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.reasoner.fastpaths import batches, paths
from semmap.nodes.kb_node.reasoner.terms import DIFFERENT_FROM, SAME_AS, TYPE, is_literal
from tests.kb_node.reasoner.abox.test_rule_matching import CASES, REJECTED
from tests.kb_node.reasoner.abox.test_saturation import CONSISTENT, CONTRADICTORY
from tests.kb_node.reasoner.fastpaths.test_rules import outcome, state
from tests.kb_node.reasoner.graphs import triples
from tests.kb_node.reasoner.swrl import graph

BY_AXIOMS = {
    name: (triples(f"{axioms} ." if axioms else ""), facts)
    for name, (axioms, facts) in (CONSISTENT | CONTRADICTORY).items()
}
BY_RULES = {
    name: (graph(*rules, axioms=axioms), facts) for name, (rules, axioms, facts) in (CASES | REJECTED).items()
}


@pytest.fixture
def _for_few(monkeypatch):
    """Also use the fast paths for many facts if there are few."""
    monkeypatch.setattr(paths, "MANY", 2)
    monkeypatch.setattr(paths, "MANY_DELETED", 2)
    monkeypatch.setattr(batches, "_MANY", 2)


def copies(tbox, facts, number):
    """Return the facts several times, with other individuals except those of the TBox."""
    shared = {term for fact in tbox for term in fact}

    def renamed(term, i):
        return term if term in shared or is_literal(term) else f"{term[:-1]}_{i}>"

    return [
        [(renamed(s, i), p, o if p == TYPE else renamed(o, i)) for s, p, o in facts] for i in range(number)
    ]


def changes(facts_of):
    """Yield changes of copies: singly and together, in part and as a whole, asserted and computed."""
    first, second, third, *more, fifth, sixth = facts_of
    for facts in (first, second):
        yield {"change": ([], facts)}
    yield {"change": ([], [fact for facts in (third, *more) for fact in facts])}
    yield {"change": (second, [])}
    yield {"change": ([], second)}
    yield {"change": ([*second, *third], [])}
    given = [
        [fact for fact in facts if fact[1] in (TYPE, SAME_AS, DIFFERENT_FROM)] for facts in (fifth, sixth)
    ]
    edges = [
        [fact for fact in facts if fact[1] not in (TYPE, SAME_AS, DIFFERENT_FROM)] for facts in (fifth, sixth)
    ]
    yield {"change": ([], given[0] + given[1])}
    yield {"computed": ([], edges[0] + edges[1])}
    yield {"computed": (edges[0], [])}
    yield {"computed": (edges[1], edges[0])}
    yield {"computed": (edges[0], [])}
    yield {"change": (first[::2], [])}
    yield {"change": (first[1::2], first[::2])}
    yield {"change": ([fact for facts in (first, *more) for fact in facts], [])}


@pytest.mark.usefixtures("_for_few")
@pytest.mark.parametrize(("tbox", "facts"), (BY_AXIOMS | BY_RULES).values(), ids=BY_AXIOMS | BY_RULES)
def test_the_result_for_copies_does_not_depend_on_the_fast_paths(tbox, facts):
    fast, slow = Reasoner(tbox), Reasoner(tbox, fast=False)
    for change in changes(copies(tbox, triples(f"{facts} ."), 6)):
        found = outcome(fast, **change)
        assert (found == "rejected") == (outcome(slow, **change) == "rejected"), change
        assert state(fast) == state(slow), change
