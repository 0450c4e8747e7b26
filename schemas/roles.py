"""Who may do what: the one table from which the router's rules are made, and by which commands are judged.

The router admits everybody to their own `semmap/as/<name>/cmd/*` and to the other keys as `GRANTS` says; the
coordinator, which can read commands, refuses those that `COMMANDS` does not grant to the role of who asks.
"""

from __future__ import annotations

from typing import Final, Literal, NamedTuple, get_args

from semmap.schemas import keys
from semmap.schemas.commands import Command, Load
from semmap.schemas.entities import Source
from semmap.schemas.errors import enumerated

Role = Literal["viewer", "operator", "perception", "robot", "admin", "node"]
ROLES: Final[tuple[Role, ...]] = get_args(Role)
Roles = frozenset[Role]

ANYBODY: Final[Roles] = frozenset(ROLES)
_OPERATORS: Final[Roles] = frozenset(("operator", "admin", "node"))
_OBSERVERS: Final[Roles] = _OPERATORS | {"perception"}
_ADMINS: Final[Roles] = frozenset(("admin", "node"))
_NODES: Final[Roles] = frozenset(("node",))

_VERBS: Final[dict[Roles, tuple[str, ...]]] = {
    ANYBODY: (
        *(
            "list",
            "get",
            "check",
            "infer",
            "explain",
            "could",
            "relations",
            "understand",
            "tell",
            "find",
            "diff",
            "when",
            "export",
            "classes",
            "properties",
        ),
        *("status", "history", "last-seen", "sparql", "watch", "renew", "picture", "floorplan", "route"),
        "frames",
        "learned",
    ),
    _OBSERVERS: ("add", "update", "set", "unset", "batch", "remove"),
    _OPERATORS: (
        "clear",
        "load",
        "undo",
        "track",
        "attach",
        "detach",
        "learn",
        "forget",
        "submit",
        "approve",
        "move",
        "drive",
        "open",
        "close",
        "pause",
        "step",
        "reset",
    ),
    _ADMINS: ("backup", "compact"),
}
COMMANDS: Final[dict[str, Roles]] = {verb: roles for roles, verbs in _VERBS.items() for verb in verbs}
"""Verb to the roles that may ask for it; `load --tbox` takes an admin."""

SOURCES: Final[dict[Role, frozenset[Source]]] = {
    "perception": frozenset(("perception",)),
    "operator": frozenset(("operator", "file", "perception", "agent")),
    "admin": frozenset(("operator", "file", "perception", "agent")),
    "node": frozenset(get_args(Source)),
}
"""What those who change the map may sign as."""


class Grant(NamedTuple):
    """Roles that may ask (a query), follow (subscribe to) or publish a key expression."""

    may: Literal["ask", "follow", "publish"]
    key: str
    roles: Roles


def _topic(topic: keys.Topic, *, follow: Roles = ANYBODY, publish: Roles = _NODES) -> tuple[Grant, Grant]:
    return Grant("follow", topic.key, follow), Grant("publish", topic.key, publish | _NODES)


GRANTS: Final[tuple[Grant, ...]] = (
    *_topic(keys.COMMIT),
    *_topic(keys.COMMIT_EFFECTS, follow=_NODES),
    *_topic(keys.ENTITY),
    *_topic(keys.QUERY),
    *_topic(keys.POSES, publish=frozenset(("robot",))),
    *_topic(keys.LIVE_POSE, publish=frozenset(("robot",))),
    *_topic(keys.LIVE_POSES),
    *_topic(keys.FRAME, publish=frozenset(("robot",))),
    *_topic(keys.HEALTH),
    Grant("publish", keys.health_key(keys.WEB), ANYBODY),
    *_topic(keys.OBSERVATIONS, publish=frozenset(("perception",))),
    *_topic(keys.CLOUD, publish=frozenset(("perception",))),
    *_topic(keys.DETECTIONS, publish=frozenset(("perception",))),
    *_topic(keys.MASKS, publish=frozenset(("perception",))),
    *_topic(keys.CAMERA, publish=frozenset(("robot",))),
    *_topic(keys.ACK, follow=_NODES),
    Grant("ask", f"{keys.BRIDGE}/snapshot", ANYBODY),
    Grant("ask", f"{keys.BRIDGE}/recall", ANYBODY),
    Grant("ask", f"{keys.BRIDGE}/copy", ANYBODY),
    Grant("ask", f"{keys.BRIDGE}/*", _NODES),
    Grant("ask", f"{keys.SIM}/snapshot", ANYBODY),
    Grant("ask", f"{keys.SIM}/surfaces", ANYBODY),
    Grant("ask", f"{keys.SIM}/world", ANYBODY),
    Grant("ask", f"{keys.SIM}/*", _NODES),
    Grant("ask", f"{keys.PERCEPTION}/*", _NODES),
    Grant("ask", f"{keys.CMD}/*", _NODES),
)
"""Everything but commands under one's own name and the presence of nodes, which everybody sees."""


def granted(role: Role, may: Literal["ask", "follow", "publish"]) -> tuple[str, ...]:
    """The key expressions that a role may ask, follow or publish."""
    return tuple(grant.key for grant in GRANTS if grant.may == may and role in grant.roles)


def followed(role: str) -> tuple[str, ...]:
    """The key expressions that somebody may follow; nothing for a role that there is not."""
    return tuple(grant.key for grant in GRANTS if grant.may == "follow" and role in grant.roles)


def may_publish(role: str, topic: keys.Topic) -> bool:
    """Whether somebody of this role may publish on a topic."""
    return any(g.may == "publish" and g.key == topic.key and role in g.roles for g in GRANTS)


def not_publishing(role: str, topic: keys.Topic) -> str:
    """Why somebody may not publish on a topic, in a sentence."""
    allowed = [
        f"'{r}'" for g in GRANTS if g.may == "publish" and g.key == topic.key for r in ROLES if r in g.roles
    ]
    others = enumerated([r for r in allowed if r != "'node'"] or ["'node'"])
    return f"your certificate ({role}) may not publish on {topic.key}; that takes the role {others}"


def default_source(role: str) -> Source:
    """What a client of this role signs as, unless it says otherwise."""
    return "perception" if role == "perception" else "operator"


def refusal(role: str, command: Command) -> str | None:
    """Why somebody of this role may not ask for `command`, in a sentence; None if they may."""
    if isinstance(command, Load) and command.tbox:
        verb, allowed = "load --tbox", _ADMINS
    else:
        verb, allowed = command.VERB, COMMANDS.get(command.VERB, _NODES)
    if role not in allowed:
        others = enumerated([f"'{r}'" for r in ROLES if r in allowed and r != "node"] or ["'node'"])
        return f"your certificate ({role}) may not {verb}; that takes the role {others}"
    sources = SOURCES.get(role)
    if command.VERB in _SIGNED and sources is not None and command.source not in sources:
        only = enumerated(sorted(sources))
        return f"your certificate ({role}) may not speak as {command.source}; it may change the map as {only}"
    return None


_SIGNED: Final = frozenset(verb for roles, verbs in _VERBS.items() if roles != ANYBODY for verb in verbs)
