"""The actions with a client that records the commands."""

from types import SimpleNamespace
from typing import Any

import pytest

from semmap.nodes.extern.mcp import actions as actions_
from semmap.nodes.extern.mcp import approval
from semmap.nodes.extern.mcp import arguments as a
from semmap.nodes.extern.mcp.actions import Actions
from semmap.nodes.extern.mcp.approval import Approval
from semmap.nodes.extern.mcp.limits import Limits
from semmap.nodes.extern.mcp.permissions import Permissions
from semmap.schemas import errors
from semmap.schemas.approvals import Request
from semmap.schemas.commands import Close, Drive, Open, Submit
from semmap.schemas.replies import Moved


class Recorder:
    """A client whose requests for approval have the decision `decision`."""

    def __init__(self, decision="approved", *, failures=(), meanwhile=lambda: None):
        self.decision = decision
        self.sent = []
        self.failures = [*failures]
        self.meanwhile = meanwhile

    def get(self, name):
        name = {"fridge": "fridge1"}.get(name, name)
        return SimpleNamespace(name=name, types=("Robot",), pose=None, live=None)

    def send(self, command, **_):
        self.sent.append(command)
        if self.failures and isinstance(command, self.failures[0][0]):
            raise self.failures.pop(0)[1]
        if isinstance(command, Submit):
            self.meanwhile()
            return Request(number=1, agent="a", text="t", stamp_ns=1, decision=self.decision, by="ann")
        return Moved(name=command.name, text="on its way", commit=7 if command.wait else None)


def actions(*, required=False):
    own = Approval("tester", per_min=600.0, required=required, patience_s=0.0)
    return Actions("tester", Permissions(Limits()), own)


@pytest.fixture(autouse=True)
def newest(monkeypatch):
    for module in (approval, actions_):
        monkeypatch.setattr(module, "newest", lambda client: 5)


SIGNED: Any = {"source": "agent", "agent": "tester", "reason": "why"}


@pytest.mark.parametrize(
    ("tool", "arguments", "command"),
    [
        ("open", a.Open(name="fridge1", reason="why"), Open(name="fridge1", wait=True, **SIGNED)),
        (
            "open",
            a.Open(name="fridge1", to=0.5, joint="door", reason="why"),
            Open(name="fridge1", to=0.5, joint="door", wait=True, **SIGNED),
        ),
        ("close", a.Close(name="fridge1", reason="why"), Close(name="fridge1", wait=True, **SIGNED)),
        (
            "drive",
            a.Drive(name="r1", to=((1.0, 2.0),), yaw=1.0, reason="why"),
            Drive(name="r1", to=((1.0, 2.0),), yaw=1.0, **SIGNED),
        ),
        ("drive", a.Drive(name="r1", stop=True, reason="why"), Drive(name="r1", stop=True, **SIGNED)),
    ],
)
def test_an_action_is_sent_as_its_command(tool, arguments, command):
    client = Recorder()
    reply = getattr(actions(), tool)(client, arguments)
    assert client.sent == [command]
    assert reply.head["done"] == (command.wait or getattr(command, "stop", False))
    assert ("then" in reply.head) == (not reply.head["done"])
    assert reply.last == (7 if command.wait else 5)


def test_an_action_is_sent_with_the_name_of_the_entity_that_is_checked_and_approved():
    """The scene does not know labels and classes, and a body may be named like one."""
    own, client = actions(required=True), Recorder()
    own.open(client, a.Open(name="fridge", reason="why"))
    submit, opening = client.sent
    assert submit.text == "open fridge1"
    assert opening.name == "fridge1"


def test_one_approval_is_for_one_of_two_parallel_calls():
    own, client = actions(required=True), Recorder()
    driving = a.Drive(name="r1", to=((1.0, 2.0),), wait=True, reason="why")
    parallel = Recorder()
    client.meanwhile = lambda: own.drive(parallel, driving)
    with pytest.raises(errors.Busy, match="another call executes this action"):
        own.drive(client, driving)
    (one,), (other, _) = client.sent, parallel.sent
    assert one.id == other.id


def executed_after(failure):
    """Return how many approvals a repeated drive needs after this failure, and the texts of the failure."""
    own, client = actions(required=True), Recorder(failures=[failure])
    driving = a.Drive(name="r1", to=((1.0, 2.0),), wait=True, reason="why")
    with pytest.raises(errors.SemmapError) as error:
        own.drive(client, driving)
    assert own.drive(client, driving).head["done"]
    return len({sent.id for sent in client.sent if isinstance(sent, Submit)}), error.value.text


def test_an_approval_is_kept_if_the_action_was_not_executed():
    assert executed_after((Drive, errors.Busy("later")))[0] == 1
    assert executed_after((Submit, errors.NoAnswer("no reply"))) == (1, "no reply")


def test_an_approval_is_spent_if_the_action_may_have_been_executed():
    count, text = executed_after((Drive, errors.NoAnswer("no reply")))
    assert count == 2
    assert text.startswith("no reply; the action may have been executed")
    assert text.endswith("requires approval again")


def test_the_limits_are_checked_again_after_an_approval():
    own, client = actions(required=True), Recorder()
    checked = []
    own._permissions.require_action = lambda client, entity, path: checked.append((entity.name, path))
    own.drive(client, a.Drive(name="r1", to=((1.0, 2.0),), reason="why"))
    assert checked == [("r1", ((1.0, 2.0),))] * 2


def test_an_action_waits_for_approval_and_is_requested_again_after_it_is_done():
    own, client = actions(required=True), Recorder("waiting")
    opening = a.Open(name="fridge1", reason="why")
    assert own.open(client, opening).head["done"] is False
    client.decision = "approved"
    assert own.open(client, opening).head["approved_by"] == "ann"
    first = {sent.id for sent in client.sent if isinstance(sent, Submit)}
    own.open(client, opening)
    both = {sent.id for sent in client.sent if isinstance(sent, Submit)}
    assert (len(first), len(both)) == (1, 2)


def test_a_rejected_action_is_not_sent_and_can_be_requested_again():
    own, client = actions(required=True), Recorder("rejected")
    for _ in range(2):
        with pytest.raises(errors.Refused, match="was rejected by ann"):
            own.close(client, a.Close(name="fridge1", reason="why"))
    assert len({sent.id for sent in client.sent}) == 2
    assert all(isinstance(sent, Submit) for sent in client.sent)


def test_a_robot_is_stopped_without_approval():
    client = Recorder("waiting")
    assert actions(required=True).drive(client, a.Drive(name="r1", stop=True, reason="why")).head["done"]


@pytest.mark.parametrize(
    ("note", "is_done"),
    [
        ("no commit: fridge1 rests at its committed pose", True),
        ("no commit yet: fridge1 is still moving; the map is updated when it rests", False),
    ],
)
def test_an_action_without_a_commit_is_done_if_none_will_follow(note, is_done):
    client = Recorder()
    client.send = lambda command: Moved(name=command.name, text="open", notes=(note,))
    reply = actions().open(client, a.Open(name="fridge1", reason="why"))
    assert reply.head["done"] == is_done
