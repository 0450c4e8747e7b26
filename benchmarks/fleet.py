"""The cost of a fleet: robots whose commits are mirrored into a SPARQL server, and queries across them.

`python -m benchmarks.fleet [--robots 50] [--entities 100] [--json FILE]`

Each robot is a real semantic map with a journal on disk, in this process, on Zenoh in a namespace of its own:
it publishes its commits and answers what the mirror asks. `semmap fleet mirror` and `oxigraph serve` are
processes of their own. Processor time is given beside the clock, which a busy machine disturbs more.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import random
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from statistics import median, quantiles
from typing import Any, Final

import psutil

from benchmarks.kb.made import entities
from semmap.nodes import bus
from semmap.nodes.extern.fleet import facts as f
from semmap.nodes.extern.fleet.query import sparql as ask_mirror
from semmap.nodes.extern.fleet.server import SparqlServer
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.kb_node.storage.seed import seed
from semmap.nodes.supervisor.ports import free_endpoint
from semmap.ontology import HOUSEHOLD_TTL
from semmap.schemas import keys
from semmap.schemas.bridge import CopyQuery, MapCopy, Recall
from semmap.schemas.commits import Edit, Transaction

SIZES: Final = (5, 10, 25, 50)
_STEADY_S: Final = 8.0
_A_SECOND: Final = 1.0
"""Commits per second of each robot in the steady state."""
_BURST: Final = 40
"""Commits of each robot in a burst."""
_BIN: Final = Path(sys.executable).parent
QUERIES: Final = {
    "chairs of all robots within 100 m of a spot": """SELECT ?robot ?s ?x ?y {
        ?robot fleet:poses ?poses . GRAPH ?robot { ?s a dm:Chair }
        GRAPH ?poses { ?s fleet:x ?x ; fleet:y ?y }
        FILTER(?x > -100 && ?x < 100 && ?y > -100 && ?y < 100) }""",
    "how many things of each class, by robot": """SELECT ?robot ?class (COUNT(?s) AS ?n) {
        GRAPH ?robot { ?s a ?class ; dm:hasPosition ?p } } GROUP BY ?robot ?class""",
    "who has the thing called e7": "SELECT ?robot { GRAPH ?robot { :e7 a ?class } }",
}


class Robot:
    """A map with a journal that publishes its commits."""

    def __init__(self, number: int, folder: Path, size: int, router: str) -> None:
        self.name = f"robot{number}"
        folder.mkdir()
        seed(folder, HOUSEHOLD_TTL, None)
        self._journal = Journal(folder / "journal.sqlite")
        self.map = SemanticMap(self._journal)
        self._past = HistoryReader(self._journal)
        self._dice, self._size = random.Random(number), size
        self._lock = threading.Lock()
        self.stamps: dict[int, float] = {}
        """The publication time of each commit, by its number."""
        triples = tuple(triple for star in entities(size, self._dice) for triple in star)
        self.map.commit(Transaction(id="load", source="file", insert=triples))
        self._stack = contextlib.ExitStack()
        session = self._stack.enter_context(
            bus.open_session(bus.Network(connect=(router,), namespace=self.name))
        )
        self._publisher = bus.publisher(session, keys.COMMIT)
        bus.serve(session, keys.BRIDGE, self._answer)
        self._token = bus.declare_presence(session, "kb_node")

    def commit(self, number: int) -> int:
        """Move one of its things; return the number of published bytes."""
        from semmap.schemas import codec

        name = f"e{self._dice.randrange(self._size)}"
        at = (self._dice.uniform(-500, 500), self._dice.uniform(-500, 500), 0.0)
        with self._lock:
            commit = self.map.commit(
                Transaction(id=f"{number}", source="operator", edit=(Edit(name=name, at=at),))
            )
            assert commit is not None
            content = codec.encode(commit)
            self.stamps[commit.seq] = time.monotonic()
            self._publisher.put(content, encoding=codec.encoding_of(commit))
        return len(content)

    def _answer(self, request: bus.Request) -> None:
        with self._lock:
            if request.verb == Recall.VERB:
                request.reply(self._past.commits(request.read(Recall).seqs))
                return
            content = request.read(CopyQuery).content
            map_id, begun_ns = self._journal.origin()
            request.reply(
                MapCopy(
                    map_id=map_id,
                    begun_ns=begun_ns,
                    seq=self.map.seq,
                    digest=self.map.digest,
                    stamp_ns=begun_ns,
                    triples=tuple(self.map.abox()) if content else (),
                    entities=tuple(self.map.entities()) if content else (),
                )
            )

    def close(self) -> None:
        """Close the session."""
        self._stack.close()
        self._journal.close()


class Watcher:
    """Queries the server for the last commit of each robot's copy."""

    def __init__(self, query_url: str, robots: list[Robot]) -> None:
        self._server, self._robots = SparqlServer(query_url), robots
        self._seen = {robot.name: robot.map.seq for robot in robots}

    def arrivals(self) -> list[float]:
        """Return the ages of the commits since the last call [s], within the polling interval."""
        known, now = self._known(), time.monotonic()
        found: list[float] = []
        for robot in self._robots:
            at = known.get(robot.name, 0)
            found += [now - robot.stamps[seq] for seq in range(self._seen[robot.name] + 1, at + 1)]
            self._seen[robot.name] = max(at, self._seen[robot.name])
        return found

    def wait(self) -> None:
        """Wait until every copy has its robot's last commit."""
        wanted = {robot.name: robot.map.seq for robot in self._robots}
        while not wanted.items() <= self._known().items():
            time.sleep(0.05)

    def _known(self) -> dict[str, int]:
        facts = f.read(self._server.query(f.QUERY).rows)
        return {name: one.commit or 0 for name, one in facts.items()}


@contextlib.contextmanager
def _started(*command: object, ready: str = "") -> Iterator[psutil.Process]:
    process = subprocess.Popen([*map(str, command)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield psutil.Process(process.pid)
    finally:
        process.terminate()
        process.wait()


def _cpu_s(process: psutil.Process) -> float:
    times = process.cpu_times()
    return float(times.user + times.system)


def _steady(robots: list[Robot], watcher: Watcher, seconds: float) -> dict[str, float]:
    """Let every robot commit once a second, at different times."""
    lags: list[float] = []
    began_s = time.monotonic()
    made, sent = 0, 0
    end = threading.Event()

    def look() -> None:
        while not end.wait(0.02):
            lags.extend(watcher.arrivals())

    looking = threading.Thread(target=look)
    looking.start()
    gap_s = 1.0 / (_A_SECOND * len(robots))
    while (now := time.monotonic() - began_s) < seconds:
        if now < made * gap_s:
            time.sleep(made * gap_s - now)
        sent += robots[made % len(robots)].commit(made)
        made += 1
    lasted_s = time.monotonic() - began_s
    time.sleep(0.5)
    end.set()
    looking.join()
    watcher.wait()
    return {
        "commits_a_second": made / lasted_s,
        "bytes_a_commit": sent / made,
        "lag_p50_s": median(lags),
        "lag_p95_s": quantiles(lags, n=20)[-1],
    }


def measure(sizes: tuple[int, ...], size: int) -> list[dict[str, Any]]:
    """Return a row for each number of robots, and one for a burst of all of them."""
    rows: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        place, router = Path(folder), free_endpoint()
        stack.enter_context(bus.open_session(bus.Network(mode="router", listen=(router,), connect=())))
        url = f"http://127.0.0.1:{free_endpoint().rpartition(':')[2]}"
        serve = ("serve", "--location", place / "oxigraph", "--bind", url.removeprefix("http://"))
        server = stack.enter_context(_started(_BIN / "oxigraph", *serve))
        _await_server(url)
        robots: list[Robot] = []
        frames = [word for n in range(max(sizes)) for word in ("--frame", f"robot{n}={10 * n},0,0,0.5")]
        mirror_words = ("fleet", "mirror", "--sparql-update", f"{url}/update", "--connect", router, *frames)
        mirror = stack.enter_context(_started(_BIN / "semmap", *mirror_words))
        for count in sizes:
            while len(robots) < count:
                robot = Robot(len(robots), place / f"robot{len(robots)}", size, router)
                stack.callback(robot.close)
                robots.append(robot)
            watcher = Watcher(f"{url}/query", robots)
            watcher.wait()
            cpu = {"mirror": _cpu_s(mirror), "server": _cpu_s(server)}
            steady = _steady(robots, Watcher(f"{url}/query", robots), _STEADY_S)
            made = steady["commits_a_second"] * _STEADY_S
            row: dict[str, Any] = {"robots": count, **steady}
            row["mirror_ms_a_commit"] = 1e3 * (_cpu_s(mirror) - cpu["mirror"]) / made
            row["server_ms_a_commit"] = 1e3 * (_cpu_s(server) - cpu["server"]) / made
            row["server_mb"] = server.memory_info().rss / 1e6
            row["mirror_mb"] = mirror.memory_info().rss / 1e6
            row["disk_mb"] = (
                sum(p.stat().st_size for p in (place / "oxigraph").rglob("*") if p.is_file()) / 1e6
            )
            row["triples"] = sum(len(robot.map.abox()) for robot in robots)
            for name, query in QUERIES.items():
                row[f"{name} [ms]"], row[f"{name} [server's ms]"] = _query_ms(query, f"{url}/query", server)
            rows.append(row)
            print(json.dumps(row), file=sys.stderr, flush=True)
        rows.append(_burst(robots, Watcher(f"{url}/query", robots), mirror, server))
    return rows


def _burst(
    robots: list[Robot], watcher: Watcher, mirror: psutil.Process, server: psutil.Process
) -> dict[str, Any]:
    cpu = {"mirror": _cpu_s(mirror), "server": _cpu_s(server)}
    began_s = time.monotonic()
    for number in range(_BURST):
        for robot in robots:
            robot.commit(1_000_000 + number)
    made_s = time.monotonic() - began_s
    watcher.wait()
    lasted_s = time.monotonic() - began_s
    made = _BURST * len(robots)
    return {
        "robots": len(robots),
        "burst_commits": made,
        "made_in_s": made_s,
        "mirrored_in_s": lasted_s,
        "commits_a_second": made / lasted_s,
        "mirror_ms_a_commit": 1e3 * (_cpu_s(mirror) - cpu["mirror"]) / made,
        "server_ms_a_commit": 1e3 * (_cpu_s(server) - cpu["server"]) / made,
    }


def _query_ms(query: str, query_url: str, server: psutil.Process, times: int = 20) -> tuple[float, float]:
    """Measure queries by wall time (median) and the server's processor time (mean)."""
    took = []
    began_cpu_s = _cpu_s(server)
    for _ in range(times):
        began_s = time.perf_counter()
        ask_mirror(query, query_url, reachable=False)
        took.append(time.perf_counter() - began_s)
    return 1e3 * median(took), 1e3 * (_cpu_s(server) - began_cpu_s) / times


def _await_server(url: str) -> None:
    from semmap.schemas import errors

    deadline_s = time.monotonic() + 30.0
    while time.monotonic() < deadline_s:
        with contextlib.suppress(errors.NoAnswer):
            SparqlServer(f"{url}/query").query("ASK {}")
            return
        time.sleep(0.05)
    raise RuntimeError("oxigraph did not start")


def table(rows: list[dict[str, Any]]) -> str:
    """Return the rows in Markdown."""
    *steady, burst = rows
    words = list(steady[0])
    lines = ["| " + " | ".join(words) + " |", "|" + " --- |" * len(words)]
    lines += ["| " + " | ".join(f"{row[word]:.4g}" for word in words) + " |" for row in steady]
    said = ", ".join(f"{name} {value:.4g}" for name, value in burst.items())
    return "\n".join([*lines, "", f"burst: {said}"])


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.fleet", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("--robots", type=int, default=max(SIZES))
    parser.add_argument("--entities", type=int, default=100, help="of each robot")
    parser.add_argument("--json", type=Path)
    words = parser.parse_args()
    sizes = (*(n for n in SIZES if n < words.robots), words.robots)
    rows = measure(sizes, words.entities)
    print(table(rows))
    if words.json:
        words.json.write_text(json.dumps(rows, indent=2))


if __name__ == "__main__":
    main()
