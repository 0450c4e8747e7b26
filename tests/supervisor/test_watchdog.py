import multiprocessing
import os
import signal
import subprocess
import sys
import time

import psutil
import pytest

from semmap.nodes.supervisor.watchdog import (
    ENDLESS_S,
    SILENT_S,
    UNHEARD_S,
    Stopped,
    StoppedProcesses,
    Watchdog,
    stopped_processes,
    work_seconds,
)
from tests.conftest import PATIENCE_S, until


class World:
    """A fake clock, and processes with a given CPU share."""

    def __init__(self, share):
        self.now_s = 1000.0
        self.share = share
        self.worked_s = 0.0
        self.watchdog = Watchdog(clock=lambda: self.now_s, work_of=lambda _: self.worked_s)
        self.watchdog.run_as({"kb_node": 1})

    def beat(self, pid=1):
        return self.watchdog.heard("kb_node", pid)

    def pass_time(self, seconds, step_s=0.25):
        """The nodes that hang in the meantime."""
        found = []
        for _ in range(int(seconds / step_s)):
            self.now_s += step_s
            self.worked_s += self.share * step_s
            found += self.watchdog.hanging()
        return found


def test_a_node_with_heartbeats_does_not_hang():
    world = World(0.0)
    for _ in range(100):
        assert world.beat()
        assert world.pass_time(1) == []


def test_a_silent_idle_node_hangs_within_five_seconds_and_gets_time_again():
    world = World(0.001)
    world.beat()
    assert world.pass_time(SILENT_S) == []
    ((node, pid, reason),) = world.pass_time(1)
    assert (node, pid, reason) == ("kb_node", 1, "silent for 4 s")
    assert world.pass_time(SILENT_S - 1) == []


def test_a_new_process_has_time_to_start():
    world = World(0.0)
    assert world.pass_time(UNHEARD_S) == []
    assert [hang.pid for hang in world.pass_time(1)] == [1]


def test_another_process_has_time_to_start_again():
    world = World(0.0)
    world.beat()
    world.pass_time(SILENT_S - 1)
    world.watchdog.run_as({"kb_node": 2})
    assert world.pass_time(UNHEARD_S) == []
    assert [hang.pid for hang in world.pass_time(1)] == [2]


@pytest.mark.parametrize("pid", [2, 0, -1])
def test_heartbeats_of_another_process_are_ignored(pid):
    world = World(0.0)
    world.beat()
    for _ in range(4):
        assert not world.beat(pid)
        assert world.pass_time(1) == []
    assert not world.beat(pid)
    assert [hang.pid for hang in world.pass_time(1)] == [1]


def test_heartbeats_of_an_unknown_node_are_ignored():
    world = World(0.0)
    assert not world.watchdog.heard("x", 1)
    assert world.pass_time(2) == []


def test_a_node_that_does_not_run_does_not_hang():
    world = World(0.0)
    world.beat()
    world.watchdog.run_as({})
    assert world.pass_time(100) == []


def test_a_silent_working_node_does_not_hang():
    world = World(0.1)  # of a core that others want, too
    world.beat()
    assert world.pass_time(ENDLESS_S - SILENT_S) == []


def test_a_node_that_waits_for_a_disk_does_not_hang():
    world = World(0.0)
    world.beat()
    world.worked_s = float("inf")
    assert world.pass_time(100) == []


def test_work_that_ends_in_idleness_is_a_hang():
    world = World(0.5)
    world.beat()
    assert world.pass_time(100) == []
    world.share = 0.0
    assert [hang.node for hang in world.pass_time(2 * SILENT_S)] == ["kb_node"]


def test_no_work_is_endless():
    world = World(1.0)
    world.beat()
    ((_, _, reason),) = world.pass_time(ENDLESS_S + SILENT_S)
    assert reason.endswith("though at work")


def test_a_delayed_watchdog_counts_no_silence():
    world = World(0.0)
    world.beat()
    world.now_s += 100.0
    assert world.pass_time(SILENT_S) == []


class Pausing:
    """A fake clock, and processes that are stopped or not."""

    def __init__(self):
        self.now_s = 1000.0
        self.stopped = {}
        self.search = StoppedProcesses(clock=lambda: self.now_s, stopped_among=lambda _: self.stopped)

    def pass_time(self, seconds, step_s=0.25):
        """The processes that stay stopped in the meantime."""
        found = []
        for _ in range(int(seconds / step_s)):
            self.now_s += step_s
            found += self.search.find({"kb_node": 1})
        return [(hang.node, hang.pid) for hang in found]


def test_a_process_of_a_node_that_stays_stopped_is_found_within_five_seconds():
    world = Pausing()
    world.pass_time(10)
    world.stopped = {Stopped(7, 0.5): "kb_node"}
    assert world.pass_time(SILENT_S - 1) == []
    assert world.pass_time(2)[0] == ("kb_node", 7)


def test_a_process_that_continues_is_not_found():
    world = Pausing()
    for _ in range(10):
        world.stopped = {Stopped(7, 0.5): "kb_node"}
        assert world.pass_time(SILENT_S - 1) == []
        world.stopped = {}
        assert world.pass_time(2) == []


def test_a_process_that_works_between_the_looks_is_not_found():
    """As under cpulimit, which stops and continues a process many times a second."""
    world = Pausing()
    for tick in range(10):
        world.stopped = {Stopped(7, tick / 100): "kb_node"}
        assert world.pass_time(1) == []


def test_a_pause_of_the_whole_system_is_not_counted():
    world = Pausing()
    world.stopped = {Stopped(7, 0.5): "kb_node"}
    assert world.pass_time(1) == []
    world.now_s += 1000.0
    assert world.pass_time(1) == []


def test_stopped_processes_belong_to_the_node_that_started_them():
    """A node that is stopped itself is not listed, and nothing of another group is."""
    fork = "import subprocess, sys; subprocess.Popen([sys.executable, '-c', 'input()']).wait()"
    words = [sys.executable, "-c", fork]
    nodes = [subprocess.Popen(words, stdin=subprocess.PIPE, start_new_session=True) for _ in range(2)]
    try:
        for node in nodes:
            until(lambda node=node: psutil.Process(node.pid).children(), "its child is there")
        (child,) = psutil.Process(nodes[0].pid).children()
        assert stopped_processes({"kb_node": nodes[0].pid}) == {}
        for node in nodes:
            os.killpg(node.pid, signal.SIGSTOP)
        until(
            lambda: (
                [
                    (process.pid, node)
                    for process, node in stopped_processes({"kb_node": nodes[0].pid}).items()
                ]
                == [(child.pid, "kb_node")]
            ),
            "it is listed",
        )
    finally:
        for node in nodes:
            os.killpg(node.pid, signal.SIGKILL)
            node.communicate()


def spin():
    while True:
        pass


def cpu_seconds(pid):
    times = psutil.Process(pid).cpu_times()
    return times.user + times.system


def test_the_work_of_a_process():
    """A working process and a sleeping one."""
    fork = multiprocessing.get_context("fork")
    busy = fork.Process(target=spin, daemon=True)
    idle = fork.Process(target=time.sleep, args=(2 * PATIENCE_S,), daemon=True)
    for process in (idle, busy):
        process.start()
    try:
        began = {process.pid: work_seconds(process.pid) for process in (idle, busy)}
        until(lambda: work_seconds(busy.pid) - began[busy.pid] > 0.5, "it has worked")
        assert work_seconds(idle.pid) - began[idle.pid] < 0.05
    finally:
        for process in (idle, busy):
            process.kill()
            process.join()
    assert work_seconds(busy.pid) == 0.0


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells of waiting for a core")
def test_a_process_that_waits_for_a_core_is_working():
    core = min(os.sched_getaffinity(0))
    loop = f"import os; os.sched_setaffinity(0, {{{core}}}); print(flush=True)\nwhile True: pass"
    several = [subprocess.Popen([sys.executable, "-c", loop], stdout=subprocess.PIPE) for _ in range(5)]
    try:
        for process in several:
            process.stdout.read(1)
        one = several[0].pid
        work_s, cpu_s = work_seconds(one), cpu_seconds(one)
        until(
            lambda: work_seconds(one) - work_s > 2.0 * (cpu_seconds(one) - cpu_s) + 0.3,
            "its waiting counts as work",
        )
    finally:
        for process in several:
            process.kill()
            process.communicate()
