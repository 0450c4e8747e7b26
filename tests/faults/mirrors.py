"""A mirror of the map, or the SPARQL server it writes to, is killed while commits arrive."""

from __future__ import annotations

import contextlib
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from semmap.nodes.extern.fleet import query
from semmap.schemas import errors
from tests.extern.fleet.sparql_servers import Oxigraph, oxigraph, spelled
from tests.faults.ground import Ground, wait_for
from tests.faults.table import SMALL, Fault

_ROBOT = "robot1"
_KILLS = 3


def _kill_again_and_again(ground: Ground, *, server_too: bool) -> None:
    """At the end the graph equals the robot's export, at the same commit, and its history is unbroken."""
    told: list[str] = []
    with tempfile.TemporaryDirectory() as folder, oxigraph(Path(folder)) as server:
        for _ in range(_KILLS):
            with _mirror(ground, server, told):
                time.sleep(random.uniform(1.0, 2.0))
                if server_too:
                    server.kill()
                    time.sleep(random.uniform(0.0, 0.5))
                    server.start()
                    time.sleep(random.uniform(0.5, 1.0))
        assert ground.reckon() == (0, 0)
        with _mirror(ground, server, told):
            _require_same(ground, server)
    ground.load_again()
    assert sum("first copy" in line for line in told) <= 1, told
    assert not any("history differs" in line or "was reset" in line for line in told), told


@contextlib.contextmanager
def _mirror(ground: Ground, server: Oxigraph, told: list[str]) -> Iterator[None]:
    """Run `semmap fleet mirror`, and end it with kill -9."""
    command: list[str | Path] = [
        Path(sys.executable).with_name("semmap"),
        "fleet",
        "mirror",
        "--connect",
        ground.endpoint,
    ]
    where = ["--sparql-update", server.update_url]
    with tempfile.TemporaryFile("w+") as said:
        with subprocess.Popen([*command, *where], stdout=said, stderr=said) as process:
            try:
                yield
            finally:
                process.send_signal(signal.SIGKILL)
        said.seek(0)
        told += said.read().splitlines()


def _require_same(ground: Ground, server: Oxigraph) -> None:
    with ground.client() as client:
        document = client.export("ntriples")

        def is_there() -> bool:
            with contextlib.suppress(errors.NoAnswer):
                answer = query.sparql("ASK {}", server.query_url, _ROBOT, reachable=False)
                return answer.robots[0].commit == document.seq
            return False

        wait_for(is_there, "the mirror is where the robot is")
        assert client.status().commit == document.seq
        there, expected = server.graph(_ROBOT), spelled(document.content)
        assert there == expected, (sorted(there - expected)[:3], sorted(expected - there)[:3])


FLEET = (*SMALL, "--namespace", _ROBOT)

MIRRORS: tuple[Fault, ...] = tuple(
    Fault(name, strike, often=2, in_short=in_short, words=FLEET)
    for name, strike, in_short in (
        ("fleet mirror killed, 3 times", partial(_kill_again_and_again, server_too=False), 0),
        (
            "fleet mirror and SPARQL server killed, 3 times",
            partial(_kill_again_and_again, server_too=True),
            1,
        ),
    )
)
