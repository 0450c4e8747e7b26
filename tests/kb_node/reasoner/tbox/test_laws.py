"""A compiled TBox means what its axioms mean: what follows by it is what the rules make."""

import pytest

from tests.kb_node.reasoner.test_worlds import THEMES, follow


@pytest.mark.parametrize("theme", THEMES.values(), ids=list(THEMES))
def test_a_compiled_schema_means_what_the_rules_make_of_it(theme):
    for seed in range(20, 25):
        follow(seed, 4, theme)
