"""The methods of a client are the commands: their fields, documentation and replies."""

from __future__ import annotations

import inspect

import numpy as np
import pytest

from semmap.nodes.extern.client import Client, _prepare
from semmap.nodes.extern.client_commands import CommandMethods
from semmap.nodes.extern.command_method import CommandMethod
from semmap.schemas import commands, errors, replies
from semmap.schemas.entities import Entity

UNSIGNED = {"source": "operator", "agent": ""}
NOT_A_METHOD = {"watch", "renew", "backup"}
"""Commands of a standing query, and parts of a file: `Client.watch` and `Client.backup` send them."""


def test_every_command_is_a_method_of_the_client():
    verbs = {
        name.replace("_", "-")
        for name, verb in vars(CommandMethods).items()
        if isinstance(verb, CommandMethod)
    }
    assert verbs == {*commands.COMMANDS, "list-as"} - NOT_A_METHOD


def test_a_method_has_the_fields_the_documentation_and_the_reply_of_its_command():
    signature = inspect.signature(Client.add)
    assert list(signature.parameters)[:4] == ["self", "class_", "name", "at"]
    assert signature.parameters["name"].annotation == "Name | None"
    assert signature.return_annotation is replies.Changed
    assert Client.add.__doc__ == commands.Add.__doc__
    assert Client.add.__qualname__ == "CommandMethods.add"


def test_a_method_that_converts_its_reply_has_its_type():
    assert inspect.signature(Client.picture).return_annotation is bytes
    assert inspect.signature(Client.list).return_annotation == tuple[Entity, ...]
    assert inspect.signature(Client.remove).return_annotation is replies.Changed


def test_a_client_signs_what_does_not_say_its_own():
    signature = {"source": "perception", "agent": "bob"}
    signed = _prepare(commands.Clear(), signature)
    assert (signed.source, signed.agent) == ("perception", "bob")
    assert _prepare(commands.Clear(agent="ann", source="file"), signature).agent == "ann"


def test_numbers_of_numpy_are_sent_as_numbers():
    at, yaw = np.array([1.0, 2.0, 0.5]), np.float32(0.5)
    assert _prepare(commands.Move("cup1", at, yaw), UNSIGNED) == commands.Move("cup1", (1.0, 2.0, 0.5), 0.5)
    mixed = (np.float64(1.0), np.int64(2), 0.5)
    assert _prepare(commands.Move("cup1", mixed), UNSIGNED).at == (1.0, 2.0, 0.5)


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (commands.Move("cup1", (1.0, 2.0)), "at"),
        (commands.StepOnce(-1.0), "seconds"),
        (commands.History(limit=0), "limit"),
        (commands.Get(object()), "is not a number, a string or a sequence"),
    ],
)
def test_an_unknown_field_is_rejected_before_it_is_sent(command, said):
    with pytest.raises(errors.BadRequest, match=said):
        _prepare(command, UNSIGNED)


def test_a_time_gets_the_offset_of_this_machine():
    asked = _prepare(commands.List(as_of="2026-03-01T12:30"), UNSIGNED)
    assert asked.as_of.startswith("2026-03-01T12:30")
    assert len(asked.as_of) == len("2026-03-01T12:30+0100")
    assert _prepare(commands.List(as_of=7), UNSIGNED).as_of == 7
