"""Errors between a client and a system of different versions."""

from __future__ import annotations

import pytest

from semmap.nodes import bus
from semmap.nodes.extern.client import connect
from semmap.nodes.runtime import version
from semmap.schemas import commands, errors, keys, replies
from tests.conftest import free_endpoint

STATUS = replies.SystemStatus(
    truth="map", commit=1, entities=0, bodies=0, in_agreement=None, nodes=(), version="0.9.1"
)


def old_status():
    return {name: getattr(STATUS, name) for name in STATUS.__struct_fields__ if name != "version"}


@pytest.fixture
def client_of(request):
    """A client of a system that answers `get` in this way, and `status` in that."""
    endpoint = free_endpoint()
    answer, status = request.param

    def receive(asked):
        if asked.verb == "status":
            asked.reply(status())
        elif isinstance(reply := answer(), errors.SemmapError):
            asked.refuse(reply)
        else:
            asked.reply(reply)

    network = bus.Network(mode="peer", connect=(), listen=(endpoint,))
    with bus.open_session(network) as session, connect(endpoint) as client:
        bus.serve(session, keys.CMD, receive)
        yield client


@pytest.mark.parametrize(
    "client_of",
    [
        (lambda: errors.UnknownVerb("unknown verb 'get'"), lambda: STATUS),
        (lambda: errors.BadRequest("malformed message: there is no field 'name'"), lambda: STATUS),
        (lambda: errors.SemmapError("what a newer version calls an error"), lambda: STATUS),
        (lambda: {"name": "cup1", "colour": "red"}, lambda: STATUS),
    ],
    indirect=True,
)
def test_a_misunderstanding_is_reported_with_both_versions(client_of):
    with pytest.raises(errors.SemmapError) as caught:
        client_of.get("cup1")
    ours = version.version()
    assert caught.value.text.endswith(f"; the system runs semmap 0.9.1, this client is {ours}")
    assert len(caught.value.text.splitlines()) == 1


@pytest.mark.parametrize("client_of", [(lambda: errors.UnknownVerb("no"), old_status)], indirect=True)
def test_the_first_version_does_not_say_which_it_is(client_of):
    with pytest.raises(errors.UnknownVerb, match=r"no; the system runs semmap before 0\.2\.0, this"):
        client_of.get("cup1")


@pytest.mark.parametrize(
    "client_of",
    [
        (lambda: errors.UnknownName("no entity is named 'cup1'"), lambda: STATUS),
        (lambda: errors.BadFile("it is not an image"), lambda: STATUS),
        (
            lambda: errors.UnknownVerb("no entity is named 'cup1'"),
            lambda: {**old_status(), "version": version.version()},
        ),
        (lambda: errors.UnknownVerb("no entity is named 'cup1'"), lambda: errors.SemmapError("busy")),
    ],
    indirect=True,
)
def test_what_has_nothing_to_do_with_versions_is_reported_as_it_is(client_of):
    with pytest.raises(errors.SemmapError) as caught:
        client_of.get("cup1")
    assert "the system runs" not in caught.value.text


@pytest.mark.parametrize("client_of", [(lambda: None, lambda: {**old_status(), "weather": 1})], indirect=True)
def test_a_status_with_unknown_fields_is_reported(client_of):
    with pytest.raises(errors.BadRequest, match=r"no field 'weather'.*; the system runs semmap before"):
        client_of.status()


def test_a_field_that_is_wrong_before_it_is_sent_is_not_the_system_s():
    with pytest.raises(errors.BadRequest) as caught:
        connect_nowhere().send(commands.StepOnce(-1.0))
    assert "the system runs" not in caught.value.text


def connect_nowhere():
    from semmap.nodes.extern.client import Client

    client = Client.__new__(Client)
    client._signature = {"source": "operator", "agent": ""}
    return client
