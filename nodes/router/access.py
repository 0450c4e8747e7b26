"""Builds Zenoh's access control from the table of roles and the names of certificates.

A rule applies to a message only if its key expression includes that of the message, so everything is denied
first. Declarations are forwarded as they were declared: a client without the declaration of the queryable
`semmap/as/*/cmd/*` never finds a server of its own commands.

If the system has a namespace, the rules are for whole keys including it.

`ingress` is what the router accepts from a client, `egress` what it forwards to it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Final, Literal

from semmap.nodes.identity.register import Member
from semmap.schemas import keys, roles
from semmap.schemas.role_names import Role

Flow = Literal["ingress", "egress"]

_EVERY_MESSAGE: Final = (
    *("put", "delete", "declare_subscriber", "query", "reply", "declare_queryable"),
    *("liveliness_token", "liveliness_query", "declare_liveliness_subscriber"),
)
_EVERYTHING: Final = f"{keys.ROOT}/**"
_PRESENCE: Final = keys.live_key("*")
_BRANCHES: Final = sorted({f"{'/'.join(grant.key.split('/')[:2])}/**" for grant in roles.GRANTS})
"""Every branch of keys except that of commands under a name."""
_LOSSLESS: Final = frozenset(topic.key for topic in keys.TOPICS if topic.qos == "lossless")


def access_control(members: Iterable[Member], namespace: str = "") -> dict[str, Any]:
    """Return the value of Zenoh's `access_control` for these members and their roles.

    `namespace` is that of the sessions: the name of a robot, or `*` for all robots that share the router.
    """
    by_role: dict[Role, list[str]] = {}
    for member in members:
        by_role.setdefault(member.role, []).append(member.name)
    rules: list[dict[str, Any]] = []
    policies: list[dict[str, Any]] = []
    subjects: list[dict[str, Any]] = []
    for role, names in by_role.items():
        of_role = _of_node() if role == "node" else _of_outsider(role)
        policies.append(_policy(rules, role, of_role, [f"as {name}" for name in names]))
        for name in names:
            subjects.append({"id": f"as {name}", "cert_common_names": [name]})
            policies.append(_policy(rules, f"as {name}", _of_name(name), [f"as {name}"]))
    for rule in rules if namespace else ():
        rule["key_exprs"] = [f"{namespace}/{key}" for key in rule["key_exprs"]]
        if "liveliness_query" in rule["messages"]:  # a query for all robots has no namespace
            rule["key_exprs"].append(keys.robots_live())
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": subjects,
        "policies": policies,
    }


Rule = tuple[Flow, tuple[str, ...], Sequence[str]]
"""A flow, kinds of messages, key expressions."""


def _of_name(name: str) -> list[Rule]:
    """Return the rules for commands under a client's own name.

    The router of another host forwards commands of the clients it has admitted, each under its own name.
    """
    mine = f"{keys.commands_as() if name == keys.ROUTER else keys.commands_as(name)}/*"
    return [("ingress", ("query",), [mine]), ("egress", ("reply",), [mine])]


def _of_outsider(role: Role) -> list[Rule]:
    followed, published = roles.granted(role, "follow"), roles.granted(role, "publish")
    asked = roles.granted(role, "ask")
    recovered = [keys.recovery(key) for key in followed if key in _LOSSLESS]
    seen = [_PRESENCE, *recovered]
    return [
        ("ingress", ("declare_subscriber",), [*followed, *recovered]),
        ("egress", ("put", "delete"), [*followed, *recovered]),
        ("ingress", ("query",), [*asked, *recovered]),
        ("egress", ("reply",), [*asked, *followed, *recovered]),
        ("egress", ("declare_queryable",), [*_declared(asked), f"{keys.commands_as()}/*", *recovered]),
        ("ingress", ("declare_liveliness_subscriber", "liveliness_query"), seen),
        ("egress", ("liveliness_token",), seen),
        ("ingress", ("liveliness_token",), [keys.live_key(keys.WEB), keys.session_key()]),
        ("ingress", ("put",), published),
        ("egress", ("declare_subscriber",), [*published, keys.HEALTH.key]),
    ]


def _of_node() -> list[Rule]:
    """Return the rules of a node, which may do everything except send commands under another name."""
    recovered = keys.recovery(_EVERYTHING)
    everything = [_EVERYTHING, _PRESENCE, keys.session_key(), recovered]
    but_queries = tuple(message for message in _EVERY_MESSAGE if message != "query")
    return [
        ("ingress", but_queries, everything),
        ("ingress", ("query",), [*_BRANCHES, recovered]),
        ("egress", _EVERY_MESSAGE, everything),
    ]


def _declared(asked: Iterable[str]) -> list[str]:
    """Return the queryables of these keys as nodes declare them: for all verbs of a prefix."""
    return list(dict.fromkeys(f"{key.rpartition('/')[0]}/*" for key in asked))


def _policy(
    rules: list[dict[str, Any]], name: str, allowed: Iterable[Rule], subjects: list[str]
) -> dict[str, Any]:
    """Add the rules with ids made of `name`, and return the policy that assigns them to the subjects."""
    ids = []
    for number, (flow, messages, key_exprs) in enumerate(allowed):
        if not key_exprs:
            continue
        ids.append(f"{name} {number}")
        rules.append(
            {
                "id": ids[-1],
                "permission": "allow",
                "flows": [flow],
                "messages": list(messages),
                "key_exprs": list(key_exprs),
            }
        )
    return {"rules": ids, "subjects": subjects}
