"""An incrementally changed ABox equals the closure of its asserted facts."""

import pytest

from tests.kb_node.reasoner.test_worlds import THEMES, follow


@pytest.mark.parametrize("theme", THEMES.values(), ids=list(THEMES))
def test_a_changed_abox_equals_the_closure(theme):
    for seed in range(4):
        follow(seed, 8, theme)
