"""Completion of the command line in a shell: verbs and options by click, and names by asking the system.

A system that does not answer at once has nothing to complete with; nothing is ever said of that.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Literal

import click
from click.shell_completion import CompletionItem, get_completion_class

from semmap.schemas import errors

SHELLS = ("bash", "zsh", "fish")
_VARIABLE = "_SEMMAP_COMPLETE"


def script(app: click.Command, shell: str) -> str:
    """What a shell must evaluate so that it completes `semmap`."""
    found = get_completion_class(shell)
    if found is None:
        raise errors.InternalError(f"no completion for the shell '{shell}'")
    return found(app, {}, "semmap", _VARIABLE).source()


def _completer(
    kind: Literal["entities", "classes"],
) -> Callable[[click.Context, click.Parameter, str], list[CompletionItem]]:
    def complete(context: click.Context, _: click.Parameter, incomplete: str) -> list[CompletionItem]:
        from semmap.nodes.extern.cli import known_names  # most words are completed without asking

        with suppress(errors.SemmapError):
            found = known_names.KINDS[kind](context.params.get("where"))
            named = sorted((name, help or "") for name, help in found if name.startswith(incomplete))
            return [CompletionItem(name, help=help or None) for name, help in named]
        return []

    return complete


entity_names = _completer("entities")
"""For a parameter that names an entity."""
class_names = _completer("classes")
"""For a parameter that names a class of things in space."""
