import multiprocessing
import time

import pytest

from nodes.supervisor.watchdog import ENDLESS_S, SILENT_S, Watchdog, cpu_seconds


class World:
    """A clock, and a process that uses a share of a core."""

    def __init__(self, share):
        self.now_s = 1000.0
        self.share = share
        self.watchdog = Watchdog(clock=lambda: self.now_s, cpu_of=lambda _: self.now_s * self.share)

    def pass_time(self, seconds):
        """Those who hang meanwhile."""
        found = []
        for _ in range(int(seconds)):
            self.now_s += 1.0
            found += self.watchdog.hanging()
        return found


def test_who_is_heard_of_does_not_hang():
    world = World(0.0)
    for _ in range(100):
        world.watchdog.heard("kb_node", 1)
        assert world.pass_time(1) == []


def test_who_is_silent_and_idle_hangs_and_is_given_time_again():
    world = World(0.001)
    world.watchdog.heard("kb_node", 1)
    assert world.pass_time(SILENT_S) == []
    assert world.pass_time(2) == [("kb_node", "silent for 31 s")]
    assert world.pass_time(SILENT_S - 2) == []


def test_who_is_silent_over_work_does_not_hang():
    world = World(0.1)  # of a core that others want, too
    world.watchdog.heard("kb_node", 1)
    assert world.pass_time(ENDLESS_S - SILENT_S) == []


def test_work_that_ends_in_idleness_is_a_hang():
    world = World(0.5)
    world.watchdog.heard("kb_node", 1)
    assert world.pass_time(100) == []
    used_s, world.share = world.now_s * 0.5, 0.0
    world.watchdog._cpu_of = lambda _: used_s
    assert [node for node, _ in world.pass_time(40)] == ["kb_node"]


def test_no_work_is_endless():
    world = World(1.0)
    world.watchdog.heard("kb_node", 1)
    ((node, reason),) = world.pass_time(ENDLESS_S + SILENT_S)
    assert (node, reason.endswith("though at work")) == ("kb_node", True)


def spin():
    while True:
        pass


@pytest.mark.parametrize("work", [spin, time.sleep])
def test_the_cpu_time_of_a_process(work):
    process = multiprocessing.get_context("fork").Process(
        target=work, args=() if work is spin else (60,), daemon=True
    )
    process.start()
    try:
        before = cpu_seconds(process.pid)
        time.sleep(1.0)
        used = cpu_seconds(process.pid) - before
        assert used > 0.05 if work is spin else used < 0.05
    finally:
        process.kill()
        process.join()
    assert cpu_seconds(process.pid) == 0.0
