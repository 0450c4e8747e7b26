"""The wait for moving contents or parts is limited in simulated time."""

from msgspec import structs

from semmap.nodes.coordinator.reconciler.rest_waits import CALM_S, RestWaits
from tests.coordinator.reconciler.test_reconcile import at, body

ROBOT = body("robot1", at(1.0))


def test_it_ends_when_enough_simulated_time_has_passed():
    waits = RestWaits()
    assert waits.must_wait("robot1", {"robot1"}, 10.0)
    assert waits.must_wait("robot1", {"robot1"}, 10.0 + CALM_S - 0.01)
    assert not waits.must_wait("robot1", {"robot1"}, 10.0 + CALM_S)


def test_each_thing_has_a_wait_of_its_own_which_can_be_ended():
    waits = RestWaits()
    assert waits.must_wait("robot1", {"robot1"}, 0.0)
    assert waits.must_wait("chest1", {"apple1"}, CALM_S)
    assert not waits.must_wait("robot1", {"robot1"}, CALM_S)
    waits.end("robot1")
    assert waits.must_wait("robot1", {"robot1"}, CALM_S)
    waits.end("nothing1")


def test_a_simulator_that_begins_again_begins_the_wait_again():
    waits = RestWaits()
    assert waits.must_wait("robot1", {"robot1"}, 100.0)
    assert waits.must_wait("robot1", {"robot1"}, 1.0)
    assert not waits.must_wait("robot1", {"robot1"}, 1.0 + CALM_S)


def test_a_body_that_moves_again_or_is_gone_is_waited_for_from_its_next_rest():
    for bodies in ({"robot1": structs.replace(ROBOT, resting=False)}, {}):
        waits = RestWaits()
        waits.must_wait("robot1", {"robot1"}, 0.0)
        waits.forget_moving({"robot1": ROBOT})
        assert not waits.must_wait("robot1", {"robot1"}, CALM_S)
        waits.forget_moving(bodies)
        assert waits.must_wait("robot1", {"robot1"}, CALM_S)
