"""An ABox that is changed step by step is the one that the rules make of what is then asserted."""

import pytest

from tests.kb_node.reasoner.test_worlds import THEMES, follow


@pytest.mark.parametrize("theme", THEMES.values(), ids=list(THEMES))
def test_a_changed_abox_has_what_the_rules_make(theme):
    for seed in range(4):
        follow(seed, 8, theme)
