import pytest

from semmap.nodes.coordinator.access.approvals import Approvals
from semmap.schemas import agents, errors
from semmap.schemas.commands import Approve, Submit


class Clock:
    now = 1_000

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def approvals(clock):
    return Approvals(clock)


def asked(approvals, id="a", agent="robot", **fields):
    return approvals.submit(Submit(id=id, source="agent", agent=agent, text="add a cup", **fields))


def test_a_request_waits_and_is_listed(approvals):
    made = asked(approvals, follows=("cup1 isOn table1",))
    assert (made.number, made.decision) == (1, "waiting")
    assert approvals.approve(Approve()) == (made,)


def test_the_same_id_is_the_same_request(approvals):
    assert asked(approvals) == asked(approvals)
    assert asked(approvals, agent="another").number == 2


def test_a_decision_is_made_once_and_reported(approvals):
    asked(approvals)
    asked(approvals, id="b")
    approvals.approve(Approve(number=1, agent="cli/ann"))
    approvals.approve(Approve(number=2, agent="cli/ann", reject=True))
    assert (asked(approvals).decision, asked(approvals).by) == ("approved", "cli/ann")
    assert asked(approvals, id="b").decision == "rejected"
    assert approvals.approve(Approve()) == ()
    with pytest.raises(errors.Refused, match="request 1 is not waiting"):
        approvals.approve(Approve(number=1, reject=True))


def test_a_pending_request_is_withdrawn_and_a_decided_one_stays(approvals):
    asked(approvals)
    asked(approvals, id="b")
    approvals.approve(Approve(number=2, agent="cli/ann"))
    assert asked(approvals, withdraw=True).decision == "withdrawn"
    assert asked(approvals, id="b", withdraw=True).decision == "approved"
    assert approvals.approve(Approve()) == ()
    with pytest.raises(errors.Refused, match="request 1 is not waiting"):
        approvals.approve(Approve(number=1, agent="cli/ann"))
    with pytest.raises(errors.Refused, match="there is no request with the id 'a'"):
        asked(approvals, withdraw=True)
    assert asked(approvals).number == 3


@pytest.mark.parametrize("source", ["agent", "perception", "scene"])
def test_only_an_operator_decides(approvals, source):
    asked(approvals)
    with pytest.raises(errors.Refused, match="only an operator"):
        approvals.approve(Approve(number=1, source=source))
    assert asked(approvals).decision == "waiting"


def test_no_client_decides_its_own_request(approvals):
    bob = agents.proved("bob")
    asked(approvals, agent=bob)
    with pytest.raises(errors.Refused, match="your own"):
        approvals.approve(Approve(number=1, agent=bob))
    assert approvals.approve(Approve(number=1, agent=agents.proved("ann")))[0].by == "ann"


def test_an_undecided_request_expires_after_an_hour(approvals, clock):
    asked(approvals)
    clock.now += 3_601 * 10**9
    assert approvals.approve(Approve()) == ()
    assert asked(approvals).number == 2


def test_requests_of_one_agent_are_limited(approvals):
    for number in range(10):
        asked(approvals, id=f"{number}")
    with pytest.raises(errors.Refused, match="10 of your requests"):
        asked(approvals, id="one more")
    assert asked(approvals, id="9").number == 10
    approvals.approve(Approve(number=1))
    assert asked(approvals, id="one more").number == 11


def test_all_requests_are_limited(approvals):
    for number in range(100):
        asked(approvals, id=f"{number}", agent=f"robot{number // 10}")
    with pytest.raises(errors.Refused, match="100 requests already wait"):
        asked(approvals, agent="another")


def test_all_that_wait_are_rejected_at_once(approvals):
    ann = agents.proved("ann")
    asked(approvals), asked(approvals, id="b"), asked(approvals, agent=ann)
    found = approvals.approve(Approve(reject=True, all=True, agent=ann))
    assert [(request.number, request.decision) for request in found] == [(1, "rejected"), (2, "rejected")]
    assert [request.agent for request in approvals.approve(Approve())] == [ann]


@pytest.mark.parametrize("fields", [{}, {"reject": True, "number": 1}])
def test_all_is_for_rejecting_only(approvals, fields):
    asked(approvals)
    with pytest.raises(errors.BadRequest, match="all goes with reject"):
        approvals.approve(Approve(all=True, **fields))
    assert asked(approvals).decision == "waiting"


def test_the_error_without_waiting_requests(approvals):
    with pytest.raises(errors.Refused, match="request 1 is not waiting; no request is waiting"):
        approvals.approve(Approve(number=1))


def test_a_request_has_an_id(approvals):
    with pytest.raises(errors.BadRequest, match="id"):
        asked(approvals, id="")
