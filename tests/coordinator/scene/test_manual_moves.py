import pytest

from semmap.nodes.coordinator.scene import manual_moves
from semmap.nodes.coordinator.scene.manual_moves import Attribution, ManualMoves
from semmap.schemas import errors
from semmap.schemas.commands import Move

MOVE = Move(name="cup1", at=(1.0, 2.0, 0.0), agent="ann")
ANN = Attribution("move", "ann", "cup1 was moved by hand")
PHYSICS = Attribution("", "", "cup1 came to rest")


def mover(released: ManualMoves) -> Attribution:
    with released.attribution_of("cup1") as hand:
        return hand


class Clock:
    now_s = 0.0

    def monotonic(self) -> float:
        return self.now_s


@pytest.fixture(autouse=True)
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(manual_moves, "time", clock)
    return clock


@pytest.fixture
def released():
    released = ManualMoves()
    released.register(MOVE)
    return released


def test_a_move_is_forgotten_when_the_map_has_followed(released):
    assert mover(released) == ANN
    assert mover(released) == PHYSICS


def test_a_move_is_kept_while_the_map_does_not_respond(released, clock):
    for _ in range(3):
        clock.now_s += 50.0
        with pytest.raises(errors.NoAnswer), released.attribution_of("cup1"):
            raise errors.NoAnswer("it is being restarted")
    assert mover(released) == ANN
    assert mover(released) == PHYSICS


def test_a_move_is_forgotten_when_the_map_rejects_the_pose(released):
    with pytest.raises(errors.Refused), released.attribution_of("cup1"):
        raise errors.Refused("it may not stand there")
    assert mover(released) == PHYSICS


def test_a_body_that_moves_for_too_long_is_not_attributed(released, clock):
    clock.now_s += 61.0
    assert mover(released) == PHYSICS


def test_a_new_move_replaces_one_that_is_not_committed(released):
    def while_it_is_told():
        released.register(Move(name="cup1", at=(1.0, 2.0, 0.0), agent="bob"))
        raise errors.NoAnswer("it is being restarted")

    with pytest.raises(errors.NoAnswer), released.attribution_of("cup1"):
        while_it_is_told()
    assert mover(released).agent == "bob"


def test_bodies_moved_together_are_committed_together(released, clock):
    tray = Move(name="tray1", at=(1.0, 2.0, 0.0), agent="ann")
    released.register(tray, ["bowl1", "apple1"])
    assert released.group_of("cup1") == released.group_of("unknown") == frozenset()
    assert released.group_of("apple1") == {"tray1", "bowl1", "apple1"}
    with pytest.raises(errors.NoAnswer), released.attribution_of("tray1", "apple1"):
        raise errors.NoAnswer("it is being restarted")
    assert released.group_of("bowl1") == {"tray1", "bowl1", "apple1"}
    with released.attribution_of("tray1", "apple1") as hand:
        assert (hand.agent, hand.reason) == ("ann", "tray1 was moved by hand")
    assert released.group_of("bowl1") == frozenset()


def test_a_body_that_is_moved_again_leaves_the_group(released):
    released.register(Move(name="tray1", at=(1.0, 2.0, 0.0)), ["bowl1", "apple1"])
    released.register(Move(name="apple1", at=(1.0, 2.0, 0.0)))
    assert released.group_of("tray1") == {"tray1", "bowl1"}
    assert released.group_of("apple1") == frozenset()


def test_a_group_that_moves_for_too_long_is_committed_one_by_one(released, clock):
    released.register(Move(name="tray1", at=(1.0, 2.0, 0.0)), ["bowl1"])
    clock.now_s += 61.0
    assert released.group_of("tray1") == frozenset()
