"""A compiled TBox gives the same conclusions as the rule table."""

import pytest

from tests.kb_node.reasoner.test_worlds import THEMES, follow


@pytest.mark.parametrize("theme", THEMES.values(), ids=list(THEMES))
def test_a_compiled_schema_equals_the_rules(theme):
    for seed in range(20, 25):
        follow(seed, 4, theme)
