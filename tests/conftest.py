"""Whole systems for tests: spawned processes, real Zenoh peers on loopback, each on a port of its own.

A start takes seconds, so tests share four systems per worker. `flat_map` and `empty_map` (without a
simulator), `flat_scene` and `empty_scene` (with it) give each module one of two systems with a clean map.
`robot_scene` and `full_system` are as the modules before have left them: each module uses names of its own,
and removes what it has added. `shared_systems.py` starts them when they are needed and stops them when the
next tests do not use them. Restarts, security and fleets start their own by `running`.
"""

from __future__ import annotations

import atexit
import contextlib
import faulthandler
import functools
import io
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest
from hypothesis import HealthCheck, settings

from semmap.nodes.extern.cli.app import execute
from semmap.nodes.extern.client import Client, connect
from semmap.nodes.kb_node.reasoner import compiled
from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from semmap.nodes.kb_node.storage.journal import FILENAME
from semmap.nodes.kb_node.storage.seed import seed
from semmap.nodes.runtime.loop import Node
from semmap.nodes.runtime.memory import uncollected
from semmap.nodes.supervisor.ports import free_endpoint
from semmap.ontology import FLAT_TTL, HOUSEHOLD_TTL, model_shapes, vocabulary
from semmap.schemas import errors, keys
from semmap.schemas.replies import SystemStatus
from tests import tiers
from tests.depth import IS_THOROUGH, tries
from tests.shared_systems import SharedSystem, is_one_running, stop_unused

# A shell that starts pytest in the background has it ignore Ctrl-C, and so would what it spawns.
signal.signal(signal.SIGINT, signal.default_int_handler)

# Containers often forbid bytecode; each of the many spawned processes would compile all modules again.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# On a busy machine the clock says nothing of the code: no deadlines, and input may take its time to be made.
settings.register_profile(
    "semmap",
    deadline=None,
    max_examples=tries(100),
    derandomize=not IS_THOROUGH,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("semmap")

tiers.forbid_processes()

# Most maps of tests have one of a few TBoxes, whose closures are computed once in a process.
_close_schema = functools.lru_cache(maxsize=32)(Closure)
compiled.Closure = lambda triples: _close_schema(tuple(triples))  # type: ignore[assignment,misc]

_BIN = Path(sys.executable).parent
_START_S = 120.0
_END_S = 30.0
PATIENCE_S = 60.0


@contextlib.contextmanager
def handling(node: Node) -> Iterator[None]:
    """Run the node's event loop in a thread."""
    thread = threading.Thread(target=node.run)
    thread.start()
    try:
        yield
    finally:
        node.stop()
        thread.join(timeout=PATIENCE_S)
    assert not thread.is_alive()


def until(condition: Callable[[], Any], what: str) -> Any:
    """Wait until `condition()` is true and return its value; fail after a timeout.

    The report then includes where each thread of this process was, with the captured output.
    """
    deadline, pause_s = time.monotonic() + PATIENCE_S, 0.005
    while time.monotonic() < deadline:
        if result := condition():
            return result
        time.sleep(pause_s)
        pause_s = min(2 * pause_s, 0.1)
    faulthandler.dump_traceback()
    return pytest.fail(f"timeout after {PATIENCE_S:g} s: {what}")


class System:
    """A running `semmap up`."""

    def __init__(self, data: Path, endpoint: str, process: subprocess.Popen[str]) -> None:
        self.data = data
        self.endpoint = endpoint
        self.process = process
        self.begun: str | None = None
        """Which map `begin_anew` gave last."""
        self.said: list[str] = []
        """The output so far."""
        self.is_ready = threading.Event()
        """It has said that it is ready, or ended."""

    def cli(self, *words: str | Path, status: int = 0) -> str:
        """Run `semmap WORDS` and return its output; require the exit status, and one line for an error."""
        out, err = io.StringIO(), io.StringIO()
        with (
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
            pytest.MonkeyPatch.context() as m,
        ):
            m.setenv("SEMMAP_CONNECT", self.endpoint)
            ended = execute([*map(str, words)])
        assert ended == status, (words, out.getvalue(), err.getvalue())
        if status:
            assert len(err.getvalue().strip().splitlines()) == 1, err.getvalue()
            assert err.getvalue().startswith("semmap: ")
        return out.getvalue() + err.getvalue()

    @contextlib.contextmanager
    def spawned(self, *words: str, **streams: int) -> Iterator[subprocess.Popen[str]]:
        """Run `semmap WORDS` as a process, which is ended with Ctrl-C."""
        environment = {**os.environ, "SEMMAP_CONNECT": self.endpoint}
        command: list[str | Path] = [_BIN / "semmap", *words]
        with subprocess.Popen(
            command, env=environment, stdout=subprocess.PIPE, text=True, **streams
        ) as process:
            try:
                yield process
            finally:
                process.send_signal(signal.SIGINT)
                _await_end(process)

    def client(self) -> contextlib.AbstractContextManager[Client]:
        """Return a client of this system."""
        return connect(self.endpoint)

    def pid(self, node: str) -> int:
        """Return the process of a node, after its first heartbeat."""
        with self.client() as client:
            found = until(lambda: [n for n in client.status().nodes if n.node == node], f"a beat of {node}")
            return int(found[0].pid)

    def open_map(self, folder: Path) -> None:
        """Continue with a copy of the map in `folder`: its history, its TBox and its commit numbers.

        All nodes are restarted, so nothing of the present map is left in any of them. The supervisor stays.
        """
        self.begun = None
        with self.client() as client:
            old = until(lambda: self._find_ready(client), "all nodes are ready")
            _replace_map(folder, self.data)
            # The coordinator goes last: it must not meet the old knowledge base again.
            for node in sorted(old, key="coordinator".__eq__):
                os.kill(old[node], signal.SIGKILL)

            def is_opened() -> bool:
                new = self._find_ready(client)
                is_restarted = new.keys() == old.keys() and not set(new.values()) & set(old.values())
                status = _ask_status(client) if is_restarted else None
                wanted = True if "sim_node" in new else None  # None also before the scene is known
                return status is not None and status.in_agreement is wanted

            until(is_opened, "all nodes are ready with the other map")

    def _find_ready(self, client: Client) -> dict[str, int]:
        """Return the processes of all nodes by name; none unless all are ready and work on the present map.

        What a heartbeat says may be of a process that was killed since, so the one that has the journal open
        is looked at.
        """
        status = _ask_status(client)
        # A heartbeat that a test sends may have any name and process id.
        nodes = [] if status is None else [node for node in status.nodes if node.node in keys.NODES]
        if any(node.state != "ready" for node in nodes):
            return {}
        pids = {node.node: int(node.pid) for node in nodes}
        try:
            files = {file.path for file in psutil.Process(pids["kb_node"]).open_files()}
            is_alive = all(psutil.pid_exists(pid) for pid in pids.values())
        except (KeyError, psutil.Error):
            return {}
        return pids if is_alive and str((self.data / FILENAME).resolve()) in files else {}

    def begin_anew(self, abox: str) -> None:
        """Have the map be as a first `semmap up --abox ABOX` makes it, `ABOX` being flat or none."""
        if not self._is_as_begun(abox):
            self.open_map(_begun(abox))
            self.begun = abox

    def await_scene(self) -> None:
        """Wait until the coordinator knows the scene, and it agrees with the map."""
        with self.client() as client:
            until(lambda: (status := _ask_status(client)) and status.in_agreement, "map and scene agree")

    def _is_as_begun(self, abox: str) -> bool:
        if self.begun != abox:
            return False
        with self.client() as client:
            status = _ask_status(client)
            return status is not None and status.commit == 1 and not status.problems

    def stop(self) -> None:
        """Send Ctrl-C and wait for the end."""
        self.process.send_signal(signal.SIGINT)
        _await_end(self.process)


@contextlib.contextmanager
def running(data: Path, *words: str | Path, endpoint: str | None = None) -> Iterator[System]:
    """`semmap up` with these words, ready; stopped at the end.

    Maps with the shipped TBox and ABox are copied, because creating them takes most of the start.
    """
    endpoint = endpoint or free_endpoint()
    said = [*map(str, words)]
    if (abox := _begins_with(data, said)) is not None:
        shutil.copytree(_begun(abox), data, dirs_exist_ok=True)
    command: list[str | Path] = [_BIN / "semmap", "up", "--data", str(data), "--listen", endpoint, *said]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    system = System(data, endpoint, process)
    reader = threading.Thread(target=_read, args=(system,), daemon=True)
    reader.start()
    try:
        _await_ready(system)
        yield system
    finally:
        if process.poll() is None:
            system.stop()
        reader.join(PATIENCE_S)  # a process that keeps the pipe open is found by the check for leftovers


_STALE = ("--stale", "3")
"""A busy machine publishes live poses and frames less than 3 s apart."""
_ROBOT_WORLD = Path(__file__).with_name("robot_world.xml")


@pytest.fixture(autouse=True)
def process_is_as_before() -> Iterator[None]:
    """Forget the names that a test's maps have given to individuals, and fail a test that leaves shapes.

    Both are kept for the process, so a later test would depend on which ones have run before.
    """
    given, library = dict(vocabulary._GIVEN), dict(model_shapes.shapes())
    yield
    vocabulary._GIVEN.clear()
    vocabulary._GIVEN.update(given)
    left, is_library = model_shapes.added_shapes(), model_shapes.shapes() == library
    if left != model_shapes.AddedShapes() or not is_library:
        left.own.clear()
        model_shapes.exchange_world(model_shapes.WorldShapes())
        model_shapes.shapes().clear()
        model_shapes.shapes().update(library)
        pytest.fail("the test leaves shapes in semmap.ontology.model_shapes: restore them")


@pytest.fixture(scope="session")
def _shared_map(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SharedSystem]:
    """One system per worker without a simulator."""
    yield from _share("_shared_map", tmp_path_factory, "--no-sim", "--no-record", *_STALE)


@pytest.fixture(scope="session")
def _shared_scene(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SharedSystem]:
    """One system per worker with a simulator."""
    yield from _share("_shared_scene", tmp_path_factory, "--no-record", *_STALE)


@pytest.fixture(scope="session")
def _shared_robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SharedSystem]:
    """One system per worker with a robot."""
    words = ("--robot", "porter", "--robot-at", "-2", "0", "0", "--world", str(_ROBOT_WORLD))
    yield from _share("_shared_robot", tmp_path_factory, "--no-record", *_STALE, *words)


@pytest.fixture(scope="session")
def _shared_full(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SharedSystem]:
    """One system per worker with all nodes."""
    yield from _share("_shared_full", tmp_path_factory)


def _share(fixture: str, temporary: pytest.TempPathFactory, *words: str) -> Iterator[SharedSystem]:
    """Make the system of a fixture available; it is started with these words when a module needs it."""
    shared = SharedSystem(fixture, lambda abox: _begin(temporary.mktemp(fixture), abox, *words))
    yield shared
    shared.stop()


@contextlib.contextmanager
def _begin(data: Path, abox: str, *words: str) -> Iterator[System]:
    """A system with the shipped flat, or with an empty map; it simulates the flat or the given world."""
    shutil.copytree(_begun(abox), data, dirs_exist_ok=True)
    with running(data, *words) as system:
        system.begun = abox
        yield system


@pytest.fixture(scope="module")
def flat_map(_shared_map: SharedSystem) -> System:
    """A system without a simulator whose map is the shipped flat, at commit 1."""
    return _shared_map.begin_anew("flat")


@pytest.fixture(scope="module")
def empty_map(_shared_map: SharedSystem) -> System:
    """A system without a simulator whose map is empty, at commit 1."""
    return _shared_map.begin_anew("none")


@pytest.fixture(scope="module")
def flat_scene(_shared_scene: SharedSystem) -> System:
    """A system with a simulator whose map is the shipped flat, at commit 1."""
    system = _shared_scene.begin_anew("flat")
    system.await_scene()
    return system


@pytest.fixture(scope="module")
def empty_scene(_shared_scene: SharedSystem) -> System:
    """A system with a simulator whose map is empty, at commit 1."""
    system = _shared_scene.begin_anew("none")
    system.await_scene()
    return system


@pytest.fixture(scope="module")
def robot_scene(_shared_robot: SharedSystem) -> System:
    """A system with the robot `robot1`, and a body `stove` at (-8, 0), in a world without walls.

    Nothing but the robot and its gripper is in the map at first. The robot is where a module left it.
    """
    system = _shared_robot.use("none")
    with system.client() as client:
        robot = {"robot1", "robot1_gripper"}
        until(lambda: robot <= {entity.name for entity in client.list()}, "the robot is in the map")
    return system


@pytest.fixture(scope="module")
def full_system(_shared_full: SharedSystem) -> System:
    """A system with the shipped flat, a simulator and a recorder."""
    return _shared_full.use("flat")


def _ask_status(client: Client) -> SystemStatus | None:
    """Return the status, or None while the coordinator is not running."""
    try:
        return client.status()
    except errors.NoAnswer:
        return None


def _replace_map(folder: Path, data: Path) -> None:
    """Replace the map in `data` by a copy of that in `folder`; a process that has it open keeps the old."""
    copies = [(file, data / f"{file.name}.new") for file in folder.iterdir() if file.is_file()]
    for file, copy in copies:
        shutil.copyfile(file, copy)
    for old in data.glob(f"{FILENAME}-*"):
        old.unlink()
    shutil.rmtree(data / "sparql", ignore_errors=True)  # the query process's store of the old map
    for file, copy in copies:
        copy.replace(data / file.name)


def _begins_with(data: Path, words: list[str]) -> str | None:
    """The ABox that the map in `data` would begin with, if it is one of those that `_begun` has."""
    if (data / FILENAME).exists() or not {"--tbox", "--import", "--world", "--fresh"}.isdisjoint(words):
        return None
    if "--abox" not in words:
        return "flat"
    return "none" if words[words.index("--abox") + 1] == "none" else None


@functools.cache
def _begun(abox: str) -> Path:
    """A data folder as the first `semmap up` makes it; kept as long as this process lives."""
    folder = Path(tempfile.mkdtemp(prefix="semmap-begun-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    seed(folder, HOUSEHOLD_TTL, FLAT_TTL if abox == "flat" else None)
    return folder


def _read(system: System) -> None:
    """Read the output until its end: a full pipe would block the process."""
    assert system.process.stdout is not None
    with system.process.stdout as said:
        for line in said:
            system.said.append(line)
            if line.startswith("stop "):
                system.is_ready.set()
    system.is_ready.set()


def _await_ready(system: System) -> None:
    in_time = system.is_ready.wait(_START_S)
    if not in_time or system.process.poll() is not None or not _says_ready(system):
        why = "did not start" if in_time else f"did not start within {_START_S:g} s"
        pytest.fail(f"the system {why}:\n" + "".join(system.said))


def _says_ready(system: System) -> bool:
    return any(line.startswith("stop ") for line in system.said)


def _await_end(process: subprocess.Popen[str]) -> None:
    """Wait for a process to end; kill it and fail the test after a timeout."""
    try:
        process.wait(_END_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        pytest.fail(f"{process.args} did not end within {_END_S:g} s of Ctrl-C")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[None]:
    """Collect the tests without garbage collections, also later: the tests and their modules stay."""
    with uncollected(freeze=True):
        return (yield)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests that need real processes."""
    for item in items:
        if tiers.needs_process(item):
            item.add_marker("process")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Prevent the other tests from starting processes."""
    tiers.watch(item)
    try:
        return (yield)
    finally:
        tiers.watch(None)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(item: pytest.Item, nextitem: pytest.Item | None) -> Iterator[None]:
    """After a file, stop the shared systems that the next tests do not use."""
    yield
    if nextitem is not None and nextitem.path != item.path and is_one_running():
        items = item.session.items
        stop_unused(items[items.index(nextitem) :])
