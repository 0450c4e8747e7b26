import pytest

from semmap.nodes.extern.mcp.limits import Rate


class Clock:
    now = 100.0

    def __call__(self):
        return self.now


def test_a_burst_passes_and_then_the_rate_holds():
    clock = Clock()
    rate = Rate(2.0, 3.0, clock)
    assert [rate.wait_s() for _ in range(4)] == [0.0, 0.0, 0.0, 0.5]
    clock.now += 0.5
    assert rate.wait_s() == 0.0
    assert rate.wait_s() == pytest.approx(0.5)


def test_who_comes_again_when_told_is_served():
    clock = Clock()
    rate = Rate(7.0, 1.0, clock)
    for _ in range(100):
        rate.wait_s()
        clock.now += rate.wait_s() + 1e-9
        assert rate.wait_s() == 0.0


def test_what_was_not_used_does_not_add_up_beyond_the_burst():
    clock = Clock()
    rate = Rate(10.0, 2.0, clock)
    clock.now += 1000.0
    assert [rate.wait_s() > 0.0 for _ in range(3)] == [False, False, True]
