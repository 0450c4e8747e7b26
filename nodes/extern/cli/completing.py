"""Completion of the command line in a shell: verbs and options by click, and names by asking the system.

A system that does not answer at once has nothing to complete with; nothing is ever said of that.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import suppress
from typing import Any

import click
from click.shell_completion import CompletionItem, get_completion_class

from nodes import bus
from nodes.extern.connection import endpoint, identity
from nodes.supervisor import presence
from schemas import commands, errors
from schemas.entities import ClassInfo, Entity

SHELLS = ("bash", "zsh", "fish")
_VARIABLE = "_SEMMAP_COMPLETE"
_MEET_S = 0.5
_ANSWER_S = 1.0


def script(app: click.Command, shell: str) -> str:
    """What a shell must evaluate so that it completes `semmap`."""
    found = get_completion_class(shell)
    assert found is not None
    return found(app, {}, "semmap", _VARIABLE).source()


def _entities(where: str) -> Iterable[CompletionItem]:
    found = _ask(where, "list", commands.List(), tuple[Entity, ...])
    return (CompletionItem(entity.name, help=entity.class_) for entity in found)


def _classes(where: str) -> Iterable[CompletionItem]:
    found = _ask(where, "classes", commands.Classes(), tuple[ClassInfo, ...])
    return (CompletionItem(row.name, help=row.labels.get("en")) for row in found if row.spatial)


def _ask(where: str, verb: str, command: Any, kind: Any) -> Any:
    here, who = presence.is_loopback(where), identity(None)
    network = bus.Network(
        connect=(where if who is None else bus.over_tls(where),),
        mode="peer" if here and who is None else "client",
        patience_s=0.0 if here else _MEET_S,
        identity=who,
    )
    with bus.open_session(network) as session:
        prefix = network.commands
        return bus.ask(session, prefix, verb, command, kind, timeout_s=_ANSWER_S, patience_s=_MEET_S)


def _completing(
    find: Callable[[str], Iterable[CompletionItem]],
) -> Callable[[click.Context, click.Parameter, str], list[CompletionItem]]:
    def complete(context: click.Context, _: click.Parameter, incomplete: str) -> list[CompletionItem]:
        with suppress(errors.SemmapError):
            where = context.params.get("where") or endpoint()
            items = sorted(find(where), key=lambda item: str(item.value))
            return [item for item in items if str(item.value).startswith(incomplete)]
        return []

    return complete


entity_names = _completing(_entities)
"""For a parameter that names an entity."""
class_names = _completing(_classes)
"""For a parameter that names a class of things in space."""
