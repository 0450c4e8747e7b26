"""The table of roles covers every command."""

from __future__ import annotations

import pytest

from semmap.schemas import roles
from semmap.schemas.calls import reply_type
from semmap.schemas.commands import COMMANDS, Add, Clear, Get, Load, Remove
from semmap.schemas.replies import Changed
from semmap.schemas.role_names import ROLES


def test_every_command_defines_its_roles():
    assert {verb for verb, kind in COMMANDS.items() if "ROLES" not in vars(kind)} == set()
    assert {verb: kind.ROLES for verb, kind in COMMANDS.items()} == roles.COMMANDS


def test_every_change_takes_more_than_a_viewer():
    """Commands that return a commit or move the scene."""
    changes = {verb for verb, kind in COMMANDS.items() if reply_type(kind) is Changed}
    assert changes
    for verb in changes | {"move", "pause", "step", "reset"}:
        assert not {"viewer", "robot"} & roles.COMMANDS[verb], verb


@pytest.mark.parametrize("role", ROLES)
def test_everybody_may_ask(role):
    assert roles.refusal(role, Get(name="x")) is None


@pytest.mark.parametrize(
    ("command", "allowed"),
    [
        (Add(class_="Cup"), {"operator", "admin", "node"}),
        (Add(class_="Cup", source="perception"), {"operator", "perception", "admin", "node"}),
        (Remove(names=("x",), source="scene"), {"node"}),
        (Clear(), {"operator", "admin", "node"}),
        (Clear(source="perception"), {"operator", "admin", "node"}),
        (Load(content=b""), {"operator", "admin", "node"}),
        (Load(content=b"", tbox=True), {"admin", "node"}),
    ],
)
def test_who_may_change(command, allowed):
    assert {role for role in ROLES if roles.refusal(role, command) is None} == allowed


def test_a_refusal_says_whose_word_it_takes():
    assert roles.refusal("viewer", Load(content=b"", tbox=True)) == (
        "role 'viewer' of your certificate may not use 'load --tbox'; required role: 'admin'"
    )
    assert "may not use the source operator; use perception" in roles.refusal("perception", Add(class_="Cup"))


def test_what_is_not_in_the_table_is_for_nodes(monkeypatch):
    monkeypatch.delitem(roles.COMMANDS, "get")
    assert roles.refusal("admin", Get(name="x"))
    assert roles.refusal("node", Get(name="x")) is None


def test_a_role_that_there_is_not_may_nothing():
    assert all(roles.refusal("janitor", kind) for kind in (Get(name="x"), Clear()))
    assert roles.followed("janitor") == ()


def test_a_rejected_subscription_names_the_next_step():
    assert roles.not_subscribing("viewer", "semmap/**") == (
        "role 'viewer' of your certificate may not subscribe to 'semmap/**'; use one of: semmap/jena/commit,"
        f" semmap/jena/entity/*/*, semmap/jena/query/*, semmap/sim/poses and"
        f" {len(roles.followed('viewer')) - 4} more"
    )
    assert roles.not_subscribing("agent", "semmap/**").endswith("; use a certificate with another role")
