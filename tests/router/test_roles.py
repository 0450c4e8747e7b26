"""For every role and every key of the table: what is granted works, and nothing else does.

Over a router with mutual TLS. What is refused makes no sound, so each refusal stands beside a grant that has
just been heard, by the same way and after it, which would have been overtaken.
"""

from __future__ import annotations

import pytest
import zenoh

from semmap.schemas import keys, roles
from semmap.schemas.role_names import ROLES
from semmap.schemas.roles import GRANTS
from tests.conftest import PATIENCE_S, until
from tests.router.conftest import Heard

FOLLOWED = {grant.key: grant.roles for grant in GRANTS if grant.may == "follow"}
PUBLISHED = {grant.key: grant.roles for grant in GRANTS if grant.may == "publish"}
ASKED = {grant.key: grant.roles for grant in GRANTS if grant.may == "ask"}


def concrete(key_expr):
    """Return a key of a key expression."""
    return key_expr.replace("*", "x")


def may(role, key, table):
    """Return whether any row of the table grants it."""
    return any(
        role in granted and zenoh.KeyExpr(row).includes(zenoh.KeyExpr(key)) for row, granted in table.items()
    )


BY_EVERYBODY = keys.health_key(keys.WEB)
"""All clients may publish and follow it."""
BY_A_NODE = keys.health_key("after")
"""Nodes may publish it, and all clients may follow it."""


def settle(sessions, *names):
    """Wait until the router has all messages of these sessions, and they have all of the router.

    Then it knows their subscribers, and publishers know theirs. Without subscribers they would send nothing.
    """
    for name in names:
        with Heard(sessions["coordinator"], BY_EVERYBODY) as heard:
            heard.hears(sessions[name], BY_EVERYBODY)
    for name in names:
        with Heard(sessions[name], BY_A_NODE) as heard:
            heard.hears(sessions["coordinator"], BY_A_NODE)


@pytest.mark.parametrize("key_expr", FOLLOWED)
@pytest.mark.parametrize("role", ROLES)
def test_following(sessions, role, key_expr):
    key = concrete(key_expr)
    with Heard(sessions[role], key_expr, BY_A_NODE) as heard, Heard(sessions["coordinator"], key) as witness:
        settle(sessions, role, "coordinator", "kb_node")
        witness.hears(sessions["kb_node"], key)
        heard.hears(sessions["kb_node"], key, BY_A_NODE)
        assert (key in heard.keys) == (role in FOLLOWED[key_expr])


@pytest.mark.parametrize("key_expr", PUBLISHED)
@pytest.mark.parametrize("role", ROLES)
def test_publishing(sessions, role, key_expr):
    key = concrete(key_expr)
    with Heard(sessions["coordinator"], key_expr, BY_EVERYBODY) as heard:
        settle(sessions, "coordinator", role)
        heard.hears(sessions[role], key, BY_EVERYBODY)
        assert (key in heard.keys) == (role in PUBLISHED[key_expr])


@pytest.fixture(scope="module")
def served(sessions):
    """Nodes serve all commands, and reply with the key."""

    def answer(query):
        with query:
            query.reply(query.key_expr, str(query.key_expr))

    prefixes = {**keys.SERVED_BY, keys.commands_as(): "coordinator"}
    queryables = [sessions[node].declare_queryable(f"{p}/*", answer) for p, node in prefixes.items()]
    settle(sessions, *set(prefixes.values()))
    settle(sessions, *ROLES)
    yield
    for queryable in queryables:
        queryable.undeclare()


def asked(session, key, patience_s=PATIENCE_S):
    """Return the replies to a query."""
    return [reply.ok.payload.to_string() for reply in session.get(key, timeout=patience_s) if reply.ok]


@pytest.mark.parametrize(
    "key",
    [
        *(key for key in ASKED if "*" not in key),
        *(f"{prefix}/{verb}" for prefix in keys.SERVED_BY for verb in ("commit", "add", "spawn")),
    ],
)
@pytest.mark.parametrize("role", ROLES)
def test_asking(sessions, served, role, key):
    assert asked(sessions["node"], key) == [key]
    assert asked(sessions[role], key) == ([key] if may(role, key, ASKED) else [])


@pytest.mark.parametrize("role", ROLES)
def test_commands_are_sent_under_the_own_name_only(sessions, served, role):
    own = f"{keys.commands_as(role)}/get"
    assert asked(sessions[role], own) == [own]
    for other in {*ROLES, "kb_node"} - {role}:
        assert asked(sessions[role], f"{keys.commands_as(other)}/get") == []


@pytest.mark.parametrize("role", [role for role in ROLES if role != "node"])
@pytest.mark.parametrize(
    "key_expr", ["semmap/as/*/cmd/get", "semmap/as/**", "semmap/**", "**", "semmap/*/get"]
)
def test_a_wildcard_reaches_no_queryable(sessions, served, role, key_expr):
    replies = sessions[role].get(key_expr, target=zenoh.QueryTarget.ALL, timeout=PATIENCE_S)
    assert [str(r.ok.key_expr) for r in replies if r.ok and str(r.ok.key_expr).startswith("semmap")] == []


@pytest.mark.parametrize("role", [role for role in ROLES if role != "node"])
@pytest.mark.parametrize(
    "key",
    [f"{keys.CMD}/add", f"{keys.commands_as()}/add", "semmap/as/operator/cmd/add", f"{keys.BRIDGE}/commit"],
)
def test_outsiders_serve_nothing(sessions, served, role, key):
    """Their queryables, even complete ones, are never queried."""
    stolen = []

    def steal(query):
        stolen.append(str(query.key_expr))
        query.drop()

    concrete_key = key.replace("*", "operator")
    queryable = sessions[role].declare_queryable(key, steal, complete=True)
    try:
        settle(sessions, role, "node")
        for target in (
            zenoh.QueryTarget.ALL,
            zenoh.QueryTarget.ALL_COMPLETE,
            zenoh.QueryTarget.BEST_MATCHING,
        ):
            list(sessions["node"].get(concrete_key, target=target, timeout=PATIENCE_S))
        assert stolen == []
    finally:
        queryable.undeclare()


def there(session):
    """Return the present nodes by Zenoh, which sometimes returns none."""
    return [str(r.ok.key_expr) for r in session.liveliness().get(keys.live_key("*")) if r.ok]


@pytest.mark.parametrize("role", [role for role in ROLES if role != "node"])
def test_outsiders_cannot_declare_the_presence_of_nodes(sessions, role):
    forged, true = keys.live_key("sim_node", "forged"), keys.live_key("sim_node", "true")
    tokens = [
        sessions[role].liveliness().declare_token(forged),
        sessions["sim_node"].liveliness().declare_token(true),
    ]
    try:
        settle(sessions, role, "sim_node", "coordinator")
        until(lambda: true in there(sessions["coordinator"]), "the node is seen")
        assert forged not in there(sessions["coordinator"])
    finally:
        for token in tokens:
            token.undeclare()
        settle(sessions, role, "sim_node", "coordinator")


@pytest.mark.parametrize("role", ROLES)
def test_all_clients_see_which_nodes_are_there(sessions, role):
    token = sessions["kb_node"].liveliness().declare_token(keys.live_key("kb_node", "1"))
    try:
        settle(sessions, "kb_node")
        until(lambda: there(sessions[role]) == [keys.live_key("kb_node", "1")], "the node is seen")
    finally:
        token.undeclare()
        settle(sessions, "kb_node")


def test_the_table_has_every_key():
    """A new topic or prefix must define who may use it."""
    topics = {topic.key for topic in keys.TOPICS}
    of_the_page = {keys.health_key(keys.WEB)}  # the page announces itself, for any member it acts for
    assert topics == set(FOLLOWED) == set(PUBLISHED) - of_the_page
    assert {f"{prefix}/*" for prefix in keys.SERVED_BY} <= set(ASKED)
    assert roles.granted("viewer", "publish") == (keys.health_key(keys.WEB),)
