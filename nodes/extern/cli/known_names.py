"""The names of entities and classes of a running system, for completion, with a short timeout."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from semmap.nodes import bus
from semmap.nodes.extern.connection import identity, namespace, resolve_endpoint
from semmap.nodes.supervisor import presence
from semmap.schemas import commands
from semmap.schemas.entities import ClassInfo, Entity

_DISCOVERY_S = 0.5
_ANSWER_S = 1.0

Named = Iterable[tuple[str, str | None]]
"""Names, each with a description."""


def _entities(where: str | None) -> Named:
    found = _ask(where, "list", commands.List(), tuple[Entity, ...])
    return [(entity.name, entity.class_) for entity in found]


def _classes(where: str | None) -> Named:
    found = _ask(where, "classes", commands.Classes(), tuple[ClassInfo, ...])
    return [(row.name, row.labels.get("en")) for row in found if row.spatial]


KINDS: Mapping[str, Callable[[str | None], Named]] = {"entities": _entities, "classes": _classes}
"""Functions that query the system at an endpoint, or the default system. They raise NoAnswer."""


def _ask(where: str | None, verb: str, command: Any, reply_type: Any) -> Any:
    where = resolve_endpoint(where, namespace(None))
    here, who = presence.is_loopback(where), identity(None)
    network = bus.Network(
        connect=(where if who is None else bus.to_tls(where),),
        namespace=namespace(None, where),
        patience_s=0.0 if here else _DISCOVERY_S,
        identity=who,
    )
    with bus.open_session(network) as session:
        prefix = network.commands
        return bus.ask(
            session, prefix, verb, command, reply_type, timeout_s=_ANSWER_S, patience_s=_DISCOVERY_S
        )
