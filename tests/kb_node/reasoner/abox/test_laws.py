"""An incrementally changed ABox equals the closure of its asserted facts."""

import pytest

from semmap.nodes.kb_node.reasoner.abox import abox
from semmap.nodes.kb_node.reasoner.tbox import axioms
from tests.kb_node.reasoner.test_worlds import THEMES, follow


@pytest.mark.parametrize("theme", THEMES.values(), ids=list(THEMES))
def test_a_changed_abox_equals_the_closure(theme):
    for seed in range(4):
        follow(seed, 8, theme)


@pytest.mark.parametrize("theme", ["transitive", "equalities"])
def test_properties_with_many_others_below_them_give_the_same_conclusions(monkeypatch, theme):
    monkeypatch.setattr(axioms, "WIDE", 0)
    monkeypatch.setattr(abox, "MANY", 1)
    for seed in range(30, 33):
        follow(seed, 8, THEMES[theme])
