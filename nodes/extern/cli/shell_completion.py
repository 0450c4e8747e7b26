"""Completion of the command line in a shell: commands and options by click, names by querying the system.

If the system does not respond in time, there are no completions and no error message.
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
    """Return the script that a shell evaluates to complete `semmap`."""
    found = get_completion_class(shell)
    if found is None:
        raise errors.InternalError(f"no completion for the shell '{shell}'")
    return found(app, {}, "semmap", _VARIABLE).source()


def _completer(
    kind: Literal["entities", "classes"],
) -> Callable[[click.Context, click.Parameter, str], list[CompletionItem]]:
    def complete(context: click.Context, _: click.Parameter, incomplete: str) -> list[CompletionItem]:
        from semmap.nodes.extern.cli import known_names  # most words are completed without a query

        with suppress(errors.SemmapError):
            found = known_names.KINDS[kind](context.params.get("where"))
            named = sorted((name, help or "") for name, help in found if name.startswith(incomplete))
            return [CompletionItem(name, help=help or None) for name, help in named]
        return []

    return complete


entity_names = _completer("entities")
"""The completion of a parameter that names an entity."""
class_names = _completer("classes")
"""The completion of a parameter that names a class of objects or places."""
