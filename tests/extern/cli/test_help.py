"""The help of each command: a first sentence that fits on a line, and an example that can be typed."""

import shlex

import click
import pytest

from semmap.nodes.extern.cli.all_commands import app
from semmap.nodes.extern.cli.common import InputPath

_MOST = 60
"""Characters; as many fit beside the longest command in a terminal of 80 columns."""
_LINE = 78
"""Characters of an example, at most."""


def _commands(group, before=()):
    context = click.Context(group)
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        yield " ".join((*before, name)), command
        if isinstance(command, click.Group):
            yield from _commands(command, (*before, name))


COMMANDS = [
    pytest.param(name, command, id=name)
    for name, command in [*_commands(app), ("help", app.commands["help"])]
]


@pytest.mark.parametrize(("_", "command"), COMMANDS)
def test_its_first_sentence_is_short_enough_to_be_whole(_, command):
    summary = command.get_short_help_str(1000)
    assert 10 < len(summary) <= _MOST
    assert summary[-1] in ".?"
    assert command.get_short_help_str(_MOST) == summary


@pytest.mark.parametrize(("name", "command"), COMMANDS)
def test_its_help_ends_with_an_example_that_begins_with_the_command(name, command):
    example = command.example
    assert shlex.split(example)[: 1 + len(name.split())] == ["semmap", *name.split()]
    assert len(example) + 2 <= _LINE
    page = command.get_help(click.Context(command, info_name=name, terminal_width=_LINE))
    assert page.endswith(f"\nExample:\n  {example}")


@pytest.mark.parametrize(("name", "command"), COMMANDS)
def test_the_arguments_and_options_of_its_example_exist(monkeypatch, name, command):
    monkeypatch.setattr(InputPath, "convert", click.Path.convert)  # the files of examples do not exist
    words = shlex.split(command.example)[1 + len(name.split()) :]
    command.make_context(name, words)  # raises a UsageError otherwise
    if not isinstance(command, click.Group):
        options = {
            option for parameter in command.params for option in (*parameter.opts, *parameter.secondary_opts)
        }
        assert {word for word in words if word.startswith("--")} <= options
