"""What `--help` says of each verb in one line."""

import click
import pytest

from semmap.nodes.extern.cli.all_commands import app

_MOST = 60
"""Characters; as many fit beside the longest verb in a terminal of 80 columns."""


def _verbs(group, before=()):
    context = click.Context(group)
    for name in group.list_commands(context):
        verb = group.get_command(context, name)
        yield " ".join((*before, name)), verb
        if isinstance(verb, click.Group):
            yield from _verbs(verb, (*before, name))


@pytest.mark.parametrize("name_and_verb", list(_verbs(app)), ids=lambda pair: pair[0])
def test_its_first_sentence_is_short_enough_to_be_whole(name_and_verb):
    _, verb = name_and_verb
    said = verb.get_short_help_str(1000)
    assert 10 < len(said) <= _MOST
    assert said[-1] in ".?"
    assert verb.get_short_help_str(_MOST) == said
