"""Access control: the tables from which the router's rules and the checks of commands are derived.

The router grants each identity access to its own `semmap/as/<name>/cmd/*`, and to other keys according to
`GRANTS`. The coordinator, which decodes commands, rejects those that `COMMANDS` does not grant to the
sender's role. `COMMANDS` is derived from the definitions of the commands.
"""

from __future__ import annotations

from typing import Final, Literal, NamedTuple, get_args

from semmap.schemas import commands, keys
from semmap.schemas.commands import Command, Load
from semmap.schemas.entities import Source
from semmap.schemas.errors import enumerated
from semmap.schemas.role_names import ADMINS, ANYBODY, NODES, ROLES, Role, Roles
from semmap.schemas.wording import few

COMMANDS: Final[dict[str, Roles]] = {name: kind.ROLES for name, kind in commands.COMMANDS.items()}
"""Command to the roles that may send it; `load --tbox` requires an admin."""

SOURCES: Final[dict[Role, frozenset[Source]]] = {
    "perception": frozenset(("perception",)),
    "operator": frozenset(("operator", "file", "perception", "agent")),
    "admin": frozenset(("operator", "file", "perception", "agent")),
    "node": frozenset(get_args(Source)),
}
"""The sources that each role may give in commands that change the map."""


class Grant(NamedTuple):
    """The roles that may query (`ask`), subscribe to (`follow`) or publish a key expression."""

    may: Literal["ask", "follow", "publish"]
    key: str
    roles: Roles


def _topic(topic: keys.Topic, *, follow: Roles = ANYBODY, publish: Roles = NODES) -> tuple[Grant, Grant]:
    return Grant("follow", topic.key, follow), Grant("publish", topic.key, publish | NODES)


GRANTS: Final[tuple[Grant, ...]] = (
    *_topic(keys.COMMIT),
    *_topic(keys.COMMIT_EFFECTS, follow=NODES),
    *_topic(keys.ENTITY),
    *_topic(keys.QUERY),
    *_topic(keys.POSES, publish=frozenset(("robot",))),
    *_topic(keys.LIVE_POSE, publish=frozenset(("robot",))),
    *_topic(keys.LIVE_POSES),
    *_topic(keys.ROBOT_STATE, publish=frozenset(("robot",))),
    *_topic(keys.FRAME, publish=frozenset(("robot",))),
    *_topic(keys.HEALTH),
    Grant("publish", keys.health_key(keys.WEB), ANYBODY),
    *_topic(keys.OBSERVATIONS, publish=frozenset(("perception",))),
    *_topic(keys.CLOUD, publish=frozenset(("perception",))),
    *_topic(keys.DETECTIONS, publish=frozenset(("perception",))),
    *_topic(keys.MASKS, publish=frozenset(("perception",))),
    *_topic(keys.CAMERA, publish=frozenset(("robot",))),
    *_topic(keys.ACK, follow=NODES),
    Grant("ask", f"{keys.BRIDGE}/snapshot", ANYBODY),
    Grant("ask", f"{keys.BRIDGE}/recall", ANYBODY),
    Grant("ask", f"{keys.BRIDGE}/copy", ANYBODY),
    Grant("ask", f"{keys.BRIDGE}/shapes-of", ANYBODY),
    Grant("ask", f"{keys.BRIDGE}/*", NODES),
    Grant("ask", f"{keys.SIM}/snapshot", ANYBODY),
    Grant("ask", f"{keys.SIM}/surfaces", ANYBODY),
    Grant("ask", f"{keys.SIM}/world", ANYBODY),
    Grant("ask", f"{keys.SIM}/*", NODES),
    Grant("ask", f"{keys.PERCEPTION}/*", NODES),
    Grant("ask", f"{keys.CMD}/*", NODES),
)
"""All grants, except those of all roles: commands under the own name, and liveliness tokens."""


def granted(role: Role, may: Literal["ask", "follow", "publish"]) -> tuple[str, ...]:
    """Return the key expressions that a role may query, subscribe to or publish."""
    return tuple(grant.key for grant in GRANTS if grant.may == may and role in grant.roles)


def followed(role: str) -> tuple[str, ...]:
    """Return the key expressions that a role may subscribe to; none for an unknown role."""
    return tuple(grant.key for grant in GRANTS if grant.may == "follow" and role in grant.roles)


def may_publish(role: str, topic: keys.Topic) -> bool:
    """Return whether a role may publish on a topic."""
    return any(g.may == "publish" and g.key == topic.key and role in g.roles for g in GRANTS)


def not_publishing(role: str, topic: keys.Topic) -> str:
    """Return the error text for publishing on a topic without permission."""
    allowed = [
        f"'{r}'" for g in GRANTS if g.may == "publish" and g.key == topic.key for r in ROLES if r in g.roles
    ]
    others = enumerated([r for r in allowed if r != "'node'"] or ["'node'"])
    return f"role '{role}' of your certificate may not publish on {topic.key}; required role: {others}"


def not_subscribing(role: str, keyexpr: str) -> str:
    """Return the error text for subscribing to a key expression without permission."""
    allowed = followed(role)
    instead = f"use one of: {few(allowed, most=5)}" if allowed else "use a certificate with another role"
    return f"role '{role}' of your certificate may not subscribe to '{keyexpr}'; {instead}"


def default_source(role: str) -> Source:
    """Return the default source of a client with this role."""
    return "perception" if role == "perception" else "operator"


def refusal(role: str, command: Command) -> str | None:
    """Return the error text if a role may not send `command`, else None."""
    if isinstance(command, Load) and command.tbox:
        name, allowed = "load --tbox", ADMINS
    else:
        name, allowed = command.VERB, COMMANDS.get(command.VERB, NODES)
    if role not in allowed:
        others = enumerated([f"'{r}'" for r in ROLES if r in allowed and r != "node"] or ["'node'"])
        return f"role '{role}' of your certificate may not use '{name}'; required role: {others}"
    sources = SOURCES.get(role)
    if command.VERB in _SIGNED and sources is not None and command.source not in sources:
        only = enumerated(sorted(sources))
        return f"role '{role}' of your certificate may not use the source {command.source}; use {only}"
    return None


_SIGNED: Final = frozenset(name for name, roles in COMMANDS.items() if roles != ANYBODY)
"""The commands whose source is checked."""
