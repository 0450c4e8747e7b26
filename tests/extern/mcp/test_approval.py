"""Approval of changes with a client that records the commands, while the host cancels the call."""

import threading
from types import SimpleNamespace

import pytest

from semmap.nodes.extern.mcp import arguments as a
from semmap.nodes.extern.mcp.approval import CANCELLED, Approval
from semmap.nodes.extern.mcp.changes import Changes
from semmap.nodes.extern.mcp.requests import Summary
from semmap.schemas import errors
from semmap.schemas.approvals import Request
from semmap.schemas.commands import Submit
from semmap.schemas.replies import Changed

SUMMARY = Summary(text="undo commit 3", reason="why")


class Recorder:
    """A client whose requests are pending until they are withdrawn, which `withdrawn` replies to."""

    def __init__(self, decision="waiting", withdrawn="withdrawn"):
        self.decision = decision
        self.withdrawn = withdrawn
        self.sent = []

    def history(self, **_):
        by = {"source": "agent", "agent": "tester"}
        return [SimpleNamespace(seq=3, **by, changes=(), changed=(), removed=(), reason="")]

    def send(self, command, **_):
        self.sent.append(command)
        if not isinstance(command, Submit):
            return Changed(names=("cup1",), text="undone", commit=None if command.dry_run else 9)
        if command.withdraw and isinstance(self.withdrawn, Exception):
            raise self.withdrawn
        decision = self.withdrawn if command.withdraw else self.decision
        return Request(number=1, agent="a", text="t", stamp_ns=1, decision=decision, by="ann")


@pytest.fixture
def cancelled():
    event = threading.Event()
    event.set()
    token = CANCELLED.set(event)
    yield
    CANCELLED.reset(token)


@pytest.mark.usefixtures("cancelled")
@pytest.mark.parametrize("approve", [False, True])
def test_a_cancelled_undo_is_not_sent(approve):
    client = Recorder("approved")
    with pytest.raises(errors.Busy, match="cancelled"):
        Changes("tester", approve=approve).undo(client, a.Undo(commit=3))
    assert all(isinstance(sent, Submit) or sent.dry_run for sent in client.sent)


@pytest.mark.usefixtures("cancelled")
@pytest.mark.parametrize(
    ("withdrawn", "is_requested"),
    [("withdrawn", False), ("approved", True), (errors.Refused("there is no request with the id"), False)],
)
def test_a_cancelled_call_can_be_repeated_whatever_became_of_its_request(withdrawn, is_requested):
    """Busy keeps the proposal. A request that was approved meanwhile is not counted a second time."""
    own = Approval("tester", per_min=1.0, required=True, patience_s=60.0)
    with pytest.raises(errors.Busy, match="cancelled"):
        own.require(Recorder(withdrawn=withdrawn), "mcp-1", SUMMARY)
    if is_requested:
        assert own.require(Recorder("approved"), "mcp-1", SUMMARY).decision == "approved"
    else:
        with pytest.raises(errors.Busy, match="rate limit"):
            own.require(Recorder("approved"), "mcp-1", SUMMARY)


def test_when_the_server_ends_only_pending_requests_are_withdrawn_and_none_is_made():
    own, client = Approval("tester", per_min=60.0, required=True, patience_s=0.0), Recorder()
    own.require(Recorder("approved"), "mcp-1", SUMMARY)
    own.require(client, "mcp-2", SUMMARY)
    client.sent.clear()
    own.withdraw_all(client)
    assert [(sent.id, sent.withdraw) for sent in client.sent] == [("mcp-2", True)]
    with pytest.raises(errors.Busy, match="ended"):
        own.require(client, "mcp-2", SUMMARY)


def test_at_the_end_nothing_is_sent_after_a_withdrawal_without_a_reply():
    own = Approval("tester", per_min=60.0, required=True, patience_s=0.0)
    client = Recorder(withdrawn=errors.NoAnswer("no response on semmap/cmd"))
    for name in ("mcp-1", "mcp-2"):
        own.require(client, name, SUMMARY)
    client.sent.clear()
    own.withdraw_all(client)
    assert len(client.sent) == 1
