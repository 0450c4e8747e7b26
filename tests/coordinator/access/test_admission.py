"""A client is identified by the key or its claim, and no claim looks like a certified name."""

from __future__ import annotations

import pytest

from semmap.nodes.coordinator.access.admission import Admission, admit_claimed
from semmap.nodes.identity import authority
from semmap.schemas import agents, errors
from semmap.schemas.commands import Add, Get


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("keys") / "K"
    authority.init(folder)
    authority.add(folder, "bob", "operator")
    authority.add(folder, "gone", "operator")
    authority.revoke(folder, "gone")
    return folder


@pytest.fixture
def admission(folder):
    return Admission(folder)


def test_the_agent_is_the_certified_name_whatever_the_command_has(admission):
    for said in ("", "alice", "@alice", "@bob"):
        signed = admission.admit_certified("bob", Add(class_="Cup", agent=said))
        assert agents.is_proved(signed.agent)
        assert agents.name_of(signed.agent) == "bob"


def test_a_claim_never_looks_like_a_certified_name():
    assert admit_claimed("", Add(class_="Cup", agent="bob")).agent == "bob"
    with pytest.raises(errors.BadRequest, match="marks certified names"):
        admit_claimed("", Add(class_="Cup", agent="@bob"))


@pytest.mark.parametrize("who", ["*", "b*b", "$*", "**"])
def test_a_wildcard_is_not_a_name(admission, who):
    with pytest.raises(errors.Refused, match="is a pattern"):
        admission.admit_certified(who, Get(name="x"))


@pytest.mark.parametrize("who", ["gone", "unknown"])
def test_a_revoked_member_is_rejected(admission, who):
    with pytest.raises(errors.NoAnswer, match=who):
        admission.admit_certified(who, Get(name="x"))


def test_an_added_member_is_known_immediately(admission, folder):
    authority.add(folder, "kim", "viewer")
    assert admission.admit_certified("kim", Get(name="x"))
    with pytest.raises(errors.Refused, match="role 'viewer' of your certificate may not use 'add'"):
        admission.admit_certified("kim", Add(class_="Cup"))
