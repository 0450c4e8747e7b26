"""Every conclusion and every rejection in a random world has a valid and minimal explanation."""

import random

import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from tests.kb_node.reasoner import proofs
from tests.kb_node.reasoner.test_worlds import THEMES
from tests.kb_node.reasoner.worlds import World


def grown(seed, theme):
    """Return a random world after some changes, and its reasoner. Checks the explanations of rejections."""
    world = World(seed, theme)
    while Closure(world.asserted).clash is not None:
        seed += 100
        world = World(seed, theme)
    reasoner = Reasoner(world.asserted)
    for _ in range(15):
        change = world.change()
        try:
            reasoner.apply(delete=change.delete, insert=change.insert)
        except Inconsistent as refusal:
            proofs.check(refusal.explanation, world.after(change))
        else:
            world.accept(change)
    return world, reasoner


@pytest.mark.parametrize("theme", THEMES.values(), ids=list(THEMES))
def test_conclusions_and_rejections_are_explained(theme):
    for seed in range(4):
        world, reasoner = grown(seed, theme)
        found = sorted(reasoner.inferred())
        for fact in random.Random(seed).sample(found, min(5, len(found))):
            proofs.check(reasoner.explain(fact), world.asserted)


def test_an_asserted_fact_is_its_own_support():
    _, reasoner = grown(1, THEMES["everything"])
    for fact in sorted(reasoner.asserted()):
        explanation = reasoner.explain(fact)
        assert list(explanation.support) == [fact]
        assert not explanation.steps
