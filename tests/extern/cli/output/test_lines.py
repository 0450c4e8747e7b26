"""Replies as plain lines."""

import pytest

from nodes.extern.cli.output import lines
from schemas.replies import Changed


@pytest.mark.parametrize(("count", "shown"), [(0, 0), (1, 1), (20, 20), (21, 19), (700, 19)])
def test_of_many_consequences_a_few_are_shown_and_the_rest_counted(count, shown):
    facts = tuple(f"cup{i} type Cup" for i in range(count))
    text, *rest = lines.changed(Changed(commit=None, text="it would be", no_longer_follows=facts))
    assert text == "it would be"
    assert rest[:shown] == [f"  would no longer follow: {fact}" for fact in facts[:shown]]
    assert rest[shown:] == [f"  would no longer follow: {count - shown} more facts"] * (count > shown)
