"""Processes that are killed, or stopped so that they hang."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import psutil

from semmap.nodes.supervisor.control import Supervisor
from semmap.schemas import errors
from tests.faults.ground import PATIENCE_S, Ground, wait_for
from tests.faults.table import Fault

NOTICED_S = 5.0
_QUERY = "SELECT ?thing { ?thing a dm:Cup } LIMIT 1"
ALL = ("--abox", "none", "--world", "empty")
SEES = ("--perception", "--camera-hz", "0")


def kill(node: str, ground: Ground) -> None:
    pid = all_pids_of(ground.data)[node]
    os.kill(pid, signal.SIGKILL)
    wait_for(lambda: pids_of(ground.data).get(node, pid) != pid, f"{node} is back")


def stop(node: str, ground: Ground) -> None:
    """A hanging node is restarted within seconds, and no other node is."""
    before = all_pids_of(ground.data)
    os.kill(before[node], signal.SIGSTOP)
    began_s = time.monotonic()
    wait_for(lambda: not _runs(before[node]), f"{node} hangs and is ended")
    noticed_s = time.monotonic() - began_s
    assert noticed_s < NOTICED_S, f"{node} hung for {noticed_s:.1f} s"
    wait_for(lambda: node in pids_of(ground.data), f"{node} is back")
    ground.observe(NOTICED_S)
    now = all_pids_of(ground.data)
    others = {other: (pid, now.get(other)) for other, pid in before.items() if other != node}
    assert all(was == is_ for was, is_ in others.values()), (
        f"other nodes than {node} were restarted: {others}"
    )


def kill_supervisord(ground: Ground) -> None:
    """`semmap up` ends with an error, and no process is left."""
    pids, up = all_pids_of(ground.data), ground.system.process
    os.kill(_supervisord(ground), signal.SIGKILL)
    assert up.wait(30) not in (0, None)
    _require_gone(pids)
    ground.start()


def stop_supervisord(ground: Ground) -> None:
    """The same if it hangs."""
    pids, up = all_pids_of(ground.data), ground.system.process
    os.kill(_supervisord(ground), signal.SIGSTOP)
    assert up.wait(60) not in (0, None)
    _require_gone({**pids, "supervisord": _supervisord(ground)})
    ground.start()


def stop_sparql(ground: Ground) -> None:
    """Changes and `status` go on, the query that waits is rejected in time, and the next one is answered."""
    with ground.client() as client, ThreadPoolExecutor(1) as thread:
        client.sparql(_QUERY)
        kb_node = psutil.Process(all_pids_of(ground.data)["kb_node"])
        stopped = [p for p in kb_node.children(recursive=True) if "semmap.nodes.kb_node.sparql" in _words(p)]
        assert stopped
        for process in stopped:
            process.suspend()
        began_s = time.monotonic()
        waiting = thread.submit(client.sparql, _QUERY)
        seen = len(ground.load.added)
        refused = waiting.exception(PATIENCE_S)
        assert isinstance(refused, errors.Refused), refused
        assert "repeat" in str(refused)
        noticed_s = time.monotonic() - began_s
        assert noticed_s < NOTICED_S, f"the SPARQL process was stopped for {noticed_s:.1f} s"
        assert client.sparql(_QUERY).rows
        assert len(ground.load.added) > seen
        assert ground.nodes()["kb_node"].pid == kb_node.pid
        assert not any(_runs(process.pid) for process in stopped)


def _words(process: psutil.Process) -> str:
    return " ".join(process.cmdline())


def kill_up(ground: Ground) -> None:
    """No process is left running for long."""
    pids, up = all_pids_of(ground.data), ground.system.process
    up.kill()
    up.wait(30)
    _require_gone(pids)
    ground.start()


def kill_up_and_start_at_once(ground: Ground) -> None:
    """The next `semmap up` takes over, also from a hanging node."""
    pids, up = all_pids_of(ground.data), ground.system.process
    os.kill(pids["kb_node"], signal.SIGSTOP)
    up.kill()
    up.wait(30)
    ground.start()
    assert not any(map(_runs, pids.values()))


def kill_everybody_above_and_go_down(ground: Ground) -> None:
    """`semmap down` finds a hanging node that was left behind."""
    pids, up = all_pids_of(ground.data), ground.system.process
    supervisord = _supervisord(ground)
    up.kill()
    os.kill(supervisord, signal.SIGKILL)
    while _runs(supervisord):
        time.sleep(0.001)
    os.kill(pids["kb_node"], signal.SIGSTOP)  # not before: the kernel ends whom it sees stopped and orphaned
    up.wait(30)
    down: list[str | Path] = [Path(sys.executable).with_name("semmap"), "down", "--data", str(ground.data)]
    status = subprocess.run(down, timeout=60, capture_output=True).returncode
    assert status in (0, 3), status  # 3 where the kernel has ended it before `semmap down` looked
    assert not any(map(_runs, pids.values()))
    assert subprocess.run(down, timeout=60, capture_output=True).returncode == 3
    ground.start()


def stop_up(ground: Ground) -> None:
    """If `semmap up` itself is delayed, it does not take nodes for hanging."""
    before = all_pids_of(ground.data)
    ground.system.process.send_signal(signal.SIGSTOP)
    ground.observe(2 * NOTICED_S)
    ground.system.process.send_signal(signal.SIGCONT)
    ground.observe(NOTICED_S)
    assert all_pids_of(ground.data) == before


def all_pids_of(data: Path) -> dict[str, int]:
    """Return the processes once supervisord replies and each node runs, which may take time."""

    def all_run() -> dict[str, int]:
        pids = pids_of(data)
        return pids if pids.keys() >= set(Supervisor(data).settings.nodes) else {}

    found: dict[str, int] = wait_for(all_run, "every node runs")
    return found


def pids_of(data: Path) -> dict[str, int]:
    """Return the processes of the nodes of a data folder; none if supervisord does not reply."""
    with contextlib.suppress(Exception):
        processes = Supervisor(data).processes()
        return {node: info["pid"] for node, info in processes.items() if info["statename"] == "RUNNING"}
    return {}


def _supervisord(ground: Ground) -> int:
    return int((ground.data / "supervisord.pid").read_text())


def _runs(pid: int) -> bool:
    try:
        return bool(psutil.Process(pid).status() != psutil.STATUS_ZOMBIE)
    except psutil.Error:
        return False


def _require_gone(pids: dict[str, int]) -> None:
    wait_for(lambda: not any(map(_runs, pids.values())), "nothing is left behind", within_s=10.0)


def _of(what: Callable[[str, Ground], None], node: str) -> Callable[[Ground], None]:
    return partial(what, node)


PROCESSES = (
    Fault("coordinator killed", _of(kill, "coordinator"), often=20, in_short=1),
    Fault("kb_node killed", _of(kill, "kb_node"), often=20, in_short=1),
    Fault("sim_node killed", _of(kill, "sim_node"), words=ALL),
    Fault("coordinator stopped", _of(stop, "coordinator"), words=ALL, in_short=1),
    Fault("kb_node stopped", _of(stop, "kb_node"), words=ALL),
    Fault("sim_node stopped", _of(stop, "sim_node"), words=ALL),
    Fault("recorder stopped", _of(stop, "recorder"), words=ALL),
    Fault("perception_node stopped", _of(stop, "perception_node"), words=(*ALL, *SEES), often=2),
    Fault("web stopped", _of(stop, "web"), words=(*ALL, "--web", "--web-port", "0"), often=2),
    Fault("semmap up stopped for 10 s", stop_up, often=1),
    Fault("supervisord killed", kill_supervisord, often=2, in_short=1),
    Fault("supervisord stopped", stop_supervisord, often=1),
    Fault("SPARQL process stopped", stop_sparql, often=2),
    Fault("semmap up killed", kill_up, often=2),
    Fault("semmap up killed while kb_node hangs, then up", kill_up_and_start_at_once, often=2),
    Fault("everybody above killed while kb_node hangs, then down", kill_everybody_above_and_go_down, often=1),
)
