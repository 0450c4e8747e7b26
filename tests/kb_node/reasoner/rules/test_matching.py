"""The order in which the atoms of a rule are matched, and the variables that facts bind."""

from itertools import product

import pytest

from semmap.nodes.kb_node.reasoner.rules.matching import (
    Access,
    bind,
    indexed,
    pattern,
    patterns,
    plan,
    unify,
)
from semmap.nodes.kb_node.reasoner.rules.rule_table import Rule

P, FACT = "<p>", ("<s>", "<p>", "<o>")
TWO_STEPS = (("?x", P, "?y"), ("?y", P, "?z"))


@pytest.mark.parametrize(
    ("data", "head", "first", "places", "accesses", "numbered"),
    [
        (
            TWO_STEPS, ("?x", P, "?z"), None, (0, 1),
            (Access((None, P, None), ((0, 0), (1, 2)), ()), Access((1, P, None), ((2, 2),), ())),
            (0, P, 2),
        ),
        (
            TWO_STEPS, ("?x", P, "?z"), 1, (1, 0),
            (Access((None, P, None), ((0, 0), (1, 2)), ()), Access((None, P, 0), ((2, 0),), ())),
            (2, P, 1),
        ),
        (
            (("?x", P, "?x"),), None, 0, (0,),
            (Access((None, P, None), ((0, 0),), ((0, 2),)),),
            None,
        ),
        (
            (("?a", P, "?b"), ("?c", "<q>", "<k>"), ("?b", "<r>", "?c")), ("?a", P, "<k>"), None, (1, 2, 0),
            (
                Access((None, "<q>", "<k>"), ((0, 0),), ()),
                Access((None, "<r>", 0), ((1, 0),), ()),
                Access((None, P, 1), ((2, 0),), ()),
            ),
            (2, P, "<k>"),
        ),
    ],
)  # fmt: skip
def test_the_plan_of_a_rule(data, head, first, places, accesses, numbered):
    rule = Rule("r", (), data, head)
    count = len({word for atom in data for word in atom if word[0] == "?"})
    assert plan(rule, data, first) == (rule, accesses, places, numbered, count)


@pytest.mark.parametrize(
    ("atom", "found"),
    [
        (("?x", P, "?y"), {"?x": "<s>", "?y": "<o>"}),
        (FACT, {}),
        (("?x", P, "?x"), None),
        (("?x", "<q>", "?y"), None),
        (("?x", P, "<s>"), None),
    ],
)
def test_the_variables_that_a_fact_binds(atom, found):
    assert unify(atom, FACT) == found


def test_the_patterns_of_a_fact():
    every = {tuple(choice) for choice in product(*((None, term) for term in FACT))}
    assert sorted(map(str, patterns(FACT))) == sorted(map(str, every))
    assert set(indexed(FACT)) == {p for p in every if p.count(None) in (1, 2)} - {("<s>", None, "<o>")}
    assert pattern(("?x", P, "<o>")) == (None, P, "<o>")


def test_the_rest_of_a_rule_after_its_first_schema_atom():
    rule = Rule(
        "r", (("?p", "<sub>", "?q"), ("?c", "<is>", "kind(?p)")), (("?x", "?p", "?y"),), ("?x", "?q", "?y")
    )
    assert bind(rule, {"?p": "<a>", "?q": "<b>"}, (FACT,)) == Rule(
        "r", (("?c", "<is>", "kind(<a>)"),), (("?x", "<a>", "?y"),), ("?x", "<b>", "?y"), (FACT,)
    )
