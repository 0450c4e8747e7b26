"""Who asks is proved by the key, or merely claimed; and no claim looks like a proof."""

from __future__ import annotations

import pytest

from semmap.nodes.coordinator.admission import Admission, claimed
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


def test_the_agent_is_who_asks_whatever_the_command_says(admission):
    for said in ("", "alice", "@alice", "@bob"):
        signed = admission.proved("bob", Add(class_="Cup", agent=said))
        assert agents.is_proved(signed.agent)
        assert agents.name_of(signed.agent) == "bob"


def test_a_claim_never_looks_like_a_proof():
    assert claimed("", Add(class_="Cup", agent="bob")).agent == "bob"
    with pytest.raises(errors.BadRequest, match="marks names that a certificate has proved"):
        claimed("", Add(class_="Cup", agent="@bob"))


@pytest.mark.parametrize("who", ["*", "b*b", "$*", "**"])
def test_a_wildcard_is_nobody(admission, who):
    with pytest.raises(errors.Refused, match="not one name"):
        admission.proved(who, Get(name="x"))


@pytest.mark.parametrize("who", ["gone", "unknown"])
def test_who_is_not_admitted_gets_no_answer(admission, who):
    with pytest.raises(errors.NoAnswer, match=who):
        admission.proved(who, Get(name="x"))


def test_who_is_added_is_known_at_once(admission, folder):
    authority.add(folder, "kim", "viewer")
    assert admission.proved("kim", Get(name="x"))
    with pytest.raises(errors.Refused, match="may not use 'add'"):
        admission.proved("kim", Add(class_="Cup"))
