"""`semmap up`: seeds the map, starts the nodes, reports when they are ready, monitors and stops them."""

from __future__ import annotations

import contextlib
import fcntl
import math
import os
import resource
import shlex
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.identity import SUPERVISOR, Identity
from semmap.nodes.runtime.web_token import new_token
from semmap.nodes.supervisor import presence, registry
from semmap.nodes.supervisor.control import FILES, LONGEST_STOP_S, SILENT_S, Supervisor
from semmap.nodes.supervisor.notices import Notices
from semmap.nodes.supervisor.ports import find_live_view, find_web_port, require_free
from semmap.nodes.supervisor.readiness import NO_REPLY, missing
from semmap.nodes.supervisor.settings import Replay, Settings
from semmap.nodes.supervisor.watchdog import StoppedProcesses, Watchdog
from semmap.ontology import EMPTY_WORLD, FLAT_WORLD
from semmap.ontology.model_shapes import varieties_of
from semmap.schemas import errors, keys, wording
from semmap.schemas.calls import reply_type
from semmap.schemas.commands import Classes, Get, List, Status
from semmap.schemas.endpoints import WEB_TOKEN_VARIABLE
from semmap.schemas.entities import Entity
from semmap.schemas.health import Health

_START_TIMEOUT_S = 120.0
_ANSWERS_WITHIN_S = 30.0
"""A supervisord that does not reply for this time hangs. Until then the nodes continue."""
_COLUMN = max(map(len, keys.NODES))
_LOOK_S = 0.2
_COMPLETE_WITHIN_S = 3.0
"""Seconds; a heartbeat is published once a second."""
_KNOWN_WITHIN_S = 30.0
"""Seconds within which a coordinator on a busy machine knows the other nodes and the scene."""
_WAITS_S = 3.0
"""Seconds; a node that waits longer may wait for another host."""
_RUNS = ("STARTING", "RUNNING")


def up(settings: Settings, say: Callable[[str], None]) -> None:
    """Run the system in the foreground until SIGINT, SIGTERM or `semmap down`.

    Raises the reason if a node cannot start, and InternalError if supervisord ends by itself. All processes
    are stopped at the end. Processes left behind by a killed `up` are ended first.
    """
    settings = structs.replace(settings, started_ns=time.time_ns())
    supervisor = Supervisor(Path(settings.data))
    with alone(supervisor.data):
        if supervisor.end_leftovers():
            say(f"{'cleanup':<{_COLUMN}} ended processes left running by an earlier semmap up")
        require_free(settings.listen)
        require_files()
        if settings.record and settings.secure is None:  # all users of this machine can open a live view
            settings = structs.replace(settings, live_view=find_live_view())
        token = new_token(os.environ.get(WEB_TOKEN_VARIABLE, "")) if settings.web else ""
        if settings.web:
            settings = structs.replace(settings, web_port=find_web_port(settings.web_port))
        with presence.announced(settings.reachable):
            if seeded := supervisor.seed(settings, lambda since_s: say(_describe_seeding(settings, since_s))):
                say(f"{'map':<{_COLUMN}} {seeded}")
            notices = Notices(supervisor.notices)
            process = supervisor.start(settings, web_token=token)
            try:
                with registry.entered(
                    data=supervisor.data,
                    listen=settings.listen,
                    reachable=settings.reachable,
                    pid=process.pid,
                    namespace=settings.namespace,
                ):
                    _Foreground(supervisor, settings, process, notices, say, token).run()
            finally:
                _stop(process)
                supervisor.end_leftovers()
                notices.close()
                say("stopped")


@contextlib.contextmanager
def alone(data: Path) -> Iterator[None]:
    """Hold the lock of the data folder, which the kernel releases however this process ends.

    Raises Refused if another `semmap up` has it, BadFile if it cannot be created.
    """
    supervisor = Supervisor(data)
    try:
        data.mkdir(parents=True, exist_ok=True)
        held = os.open(supervisor.lock, os.O_RDWR | os.O_CREAT, 0o600)
    except OSError as error:
        raise errors.BadFile(f"cannot store data in {data}: {error.strerror}") from None
    try:
        fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    except BlockingIOError:
        down = f"semmap down --data {shlex.quote(str(supervisor.data))}"
        raise errors.Refused(
            f"a system is already running on {supervisor.data}; stop it with: {down}"
        ) from None
    finally:
        os.close(held)


class _Foreground:
    """Monitors the processes and their heartbeats."""

    def __init__(
        self,
        supervisor: Supervisor,
        settings: Settings,
        process: subprocess.Popen[bytes],
        notices: Notices,
        say: Callable[[str], None],
        web_token: str = "",
    ) -> None:
        self._web_token = web_token
        self._supervisor = supervisor
        self._settings = settings
        self._process = process
        self._notices = notices
        self._say = say
        self._answered_s = time.monotonic()
        self._pids: dict[str, int] = {}
        self._watchdog = Watchdog()
        self._stopped_processes = StoppedProcesses()
        self._stopping = False
        self._deadline_s = time.monotonic() + _START_TIMEOUT_S
        self._waits_from_s = time.monotonic() + _WAITS_S
        self._waits: set[tuple[str, str]] = set()
        """The messages already printed about nodes that wait."""
        self._is_replayed = False
        self._begun_s = self._reported_s = time.monotonic()

    def run(self) -> None:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, self._on_signal)
        greeted = False
        while not self._stopping and self._process.poll() is None:
            self._check_processes()
            for health in self._notices.wait(_LOOK_S):
                self._on_health(health)
            if not greeted and set(self._pids) == set(self._settings.nodes):
                greeted = True
                self._wait_until_complete()
                self._print_summary()
            if not greeted and time.monotonic() > self._deadline_s:
                late = sorted(set(self._settings.nodes) - set(self._pids))
                raise errors.NoAnswer(f"not ready after {_START_TIMEOUT_S:g} s: {', '.join(late)}")
            self._restart_hanging()
        if not self._stopping and self._process.returncode != 0:
            raise errors.InternalError(
                f"supervisord {_ending(self._process.returncode)}{self._supervisor.last_error()},"
                " and the nodes were stopped with it; restart with: semmap up"
            )

    def _on_signal(self, *_: object) -> None:
        self._stopping = True

    def _on_health(self, health: Health) -> None:
        if not self._watchdog.heard(health.node, health.pid):
            return
        if health.state == "starting":  # a large map takes time to load, with heartbeats
            self._deadline_s = time.monotonic() + _START_TIMEOUT_S
            self._report_waiting(health)
            self._report_progress(health)
        if health.node == "kb_node" and self._settings.replay is not None:
            self._report_replay(self._settings.replay, health)
        if health.state == "ready" and self._pids.get(health.node) != health.pid:
            again = " again" if health.node in self._pids else ""
            self._pids[health.node] = health.pid
            self._say(f"{health.node:<{_COLUMN}} ready{again}  pid {health.pid:<7} {health.detail}")
            for note in health.notes:
                self._say(f"{wording.note_subject(health.node):<{_COLUMN}} {note}")

    def _report_replay(self, replay: Replay, health: Health) -> None:
        """Print once that the replay is complete."""
        if health.commit == replay.until and not self._is_replayed:
            self._is_replayed = True
            self._say(f"{'map':<{_COLUMN}} replay complete at commit {replay.until}")

    def _report_waiting(self, health: Health) -> None:
        """In a part of a system, print once what a node waits for: it may be on a host that starts later."""
        message = health.node, health.detail
        is_long = time.monotonic() > self._waits_from_s
        if (
            self._settings.only
            and is_long
            and health.detail.startswith("waiting")
            and message not in self._waits
        ):
            self._waits.add(message)
            self._say(f"{health.node:<{_COLUMN}} {health.detail}")

    def _report_progress(self, health: Health) -> None:
        """Print regularly what a node does that is not ready yet."""
        now_s = time.monotonic()
        if health.detail and now_s - self._reported_s > SILENT_S:
            self._reported_s = now_s
            self._say(f"{health.node:<{_COLUMN}} {health.detail} ({now_s - self._begun_s:.0f} s)")

    def _check_processes(self) -> None:
        """Check the processes.

        Raises if a node has ended with an error that a restart would not fix, with its last log line, and if
        supervisord hangs.
        """
        try:
            processes = self._supervisor.processes()
            self._answered_s = time.monotonic()
        except errors.NoAnswer:
            if time.monotonic() - self._answered_s > _ANSWERS_WITHIN_S:
                self._process.kill()  # it would not process a signal to terminate, either
                raise errors.InternalError(
                    "supervisord: no response; it was ended with the nodes; restart with: semmap up"
                ) from None
            return
        self._watchdog.run_as(
            {node: info["pid"] for node, info in processes.items() if info["statename"] in _RUNS}
        )
        for node, info in processes.items():
            self._require_alive(node, info)

    def _require_alive(self, node: str, info: dict[str, Any]) -> None:
        # A process killed by a signal is also "exited" until it is restarted.
        gave_up = info["statename"] == "EXITED" and int(info["exitstatus"]) >= 0
        ended = gave_up or info["statename"] == "FATAL"
        if ended and not self._stopping and self._process.poll() is None:
            words = self._supervisor.last_log_line(node)
            raise errors.Refused(f"{node} exited: {words} (log: {self._supervisor.log_of(node)})")

    def _network(self) -> bus.Network:
        secure = self._settings.secure
        identity = None if secure is None else Identity.read(Path(secure) / SUPERVISOR)
        return bus.Network(
            connect=(self._settings.reachable,),
            namespace=self._settings.namespace,
            identity=identity,
            own_config=self._settings.zenoh_config,
        )

    def _restart_hanging(self) -> None:
        for hang in self._watchdog.hanging():
            self._say(f"{hang.node:<{_COLUMN}} {hang.reason}: restarting it")
            self._supervisor.replace(hang.pid)
        for hang in self._stopped_processes.find(self._watchdog.pids):
            self._say(f"{hang.node:<{_COLUMN}} {hang.reason}: ending it")
            with contextlib.suppress(ProcessLookupError):
                os.kill(hang.pid, signal.SIGKILL)

    def _wait_until_complete(self) -> None:
        """Wait until the coordinator knows every node and the bodies are placed, before reporting ready.

        The wait for bodies is short: with many, or with one that cannot be placed, the system is ready
        earlier. A busy machine may need longer until the coordinator replies and has received the scene.
        """
        with (
            contextlib.suppress(errors.SemmapError, OSError),
            bus.open_session(self._network()) as session,
        ):
            begun_s = self._reported_s = time.monotonic()
            known_within_s = _KNOWN_WITHIN_S if "coordinator" in self._pids else _COMPLETE_WITHIN_S
            while not self._stopping and self._process.poll() is None:
                waited_s = time.monotonic() - begun_s
                try:
                    status = bus.ask(session, keys.CMD, Status.VERB, Status(), reply_type(Status))
                except errors.NoAnswer:
                    self._report_missing(NO_REPLY, waited_s, known_within_s)
                    if waited_s > known_within_s:
                        raise
                    time.sleep(_LOOK_S)
                    continue
                keeps = status.truth != "perceived" and "sim_node" in self._pids
                waits_for = status.pending if keeps else ()  # moving bodies are not waited for
                unknown = missing(status, self._pids, with_scene=keeps)
                self._report_missing(unknown, waited_s, known_within_s)
                if waited_s > (known_within_s if unknown else _COMPLETE_WITHIN_S):
                    for waited in waits_for:
                        self._say(f"{'scene':<{_COLUMN}} not complete yet: {waited}")
                    break
                if not unknown and not waits_for:
                    break
                for health in self._notices.wait(0.05):
                    self._on_health(health)
            else:
                return
            self._report_truth(status.truth)
            self._report_models(session)
            self._report_robot_position(session)

    def _report_missing(self, unknown: str, waited_s: float, until_s: float) -> None:
        """Print regularly what the start waits for, and once if it is still missing when the wait ends."""
        now_s = time.monotonic()
        if not unknown:
            return
        if waited_s > until_s:
            self._say(f"{'system':<{_COLUMN}} not complete yet: waiting for {unknown}; see: semmap status")
        elif now_s - self._reported_s > SILENT_S:
            self._reported_s = now_s
            self._say(f"{'system':<{_COLUMN}} waiting for {unknown} ({now_s - self._begun_s:.0f} s)")

    def _report_truth(self, truth: str) -> None:
        """Warn if perception uses the simulator's cameras while the map defines the scene."""
        sees_the_simulator = {"sim_node", "perception_node"} <= {*self._settings.only}
        if sees_the_simulator and self._settings.camera_hz and truth != "perceived":
            self._say(
                f"{'perception':<{_COLUMN}} the coordinator runs with --truth {truth}, so the simulator's"
                " cameras only show the content of the map; start it with --truth perceived"
            )

    def _report_robot_position(self, session: bus.Session) -> None:
        """Report the position of a robot that the map already has at another place than `--robot-at`."""
        name, at = self._settings.robot_name, self._settings.robot_at
        if self._settings.robot is None or at is None or not self._settings.sim:
            return
        with contextlib.suppress(errors.SemmapError, OSError):
            robot = bus.ask(session, keys.CMD, Get.VERB, Get(name=name), reply_type(Get))
            if robot.pose is not None and math.dist(robot.pose.position_m, at) > self._settings.threshold_m:
                stands = ", ".join(f"{value:g}" for value in robot.pose.position_m)
                there = " ".join(f"{value:g}" for value in at)
                self._say(
                    f"{name:<{_COLUMN}} is at its last committed position ({stands}), not at --robot-at;"
                    f" to move it: semmap move {name} --at {there}"
                )

    def _report_models(self, session: bus.Session) -> None:
        """Report files in `--models` that no class uses, and features of models that are not supported."""
        if self._settings.models is None or not self._settings.sim:
            return
        from semmap.nodes.sim_node.models.model_reader import ModelReader  # and with it MuJoCo
        from semmap.nodes.sim_node.models.sources import ignored_files
        from semmap.nodes.sim_node.models.write_shapes import own_notes

        folder = Path(self._settings.models)
        with contextlib.suppress(errors.SemmapError, OSError):
            classes = bus.ask(session, keys.CMD, Classes.VERB, Classes(), reply_type(Classes))
            names = {name for c in classes for name in (c.model, *varieties_of(c.model))}
            if ignored_files(folder, names):
                listed = bus.ask(session, keys.CMD, List.VERB, List(), reply_type(List))
                names |= {entity.model for entity in listed if isinstance(entity, Entity)}
            if strange := ignored_files(folder, names):
                message = f"ignored, because no class has a model with this name: {', '.join(strange)}"
                self._say(f"{'models':<{_COLUMN}} {message}")
            with ModelReader() as reader:
                for note in own_notes(folder, names, reader):
                    self._say(f"{'models':<{_COLUMN}} {note}")

    def _print_summary(self) -> None:
        usual = self._settings.reachable == bus.DEFAULT_ENDPOINT
        connect = "" if usual else f" --connect {self._settings.reachable}"
        if self._settings.secure is not None:
            connect += f" --identity {shlex.quote(self._settings.secure)}/NAME"
        lines = {"zenoh": self._settings.reachable, "data": self._settings.data}
        if self._settings.namespace:
            lines = {"robot": self._settings.namespace} | lines
        if self._settings.record:
            lines["recording"] = f"{self._settings.data}/recordings"
        if self._settings.live_view is not None:
            lines["live view"] = f"rerun --connect rerun+http://{self._settings.live_view}/proxy"
        if self._settings.web:
            lines["page"] = f"http://127.0.0.1:{self._settings.web_port}/?token={self._web_token}"
        lines |= {"try": f"semmap list{connect}", "stop": "Ctrl-C"}
        self._say(f"{'system':<{_COLUMN}} ready in {time.monotonic() - self._begun_s:.0f} s")
        self._say("")
        for what, value in lines.items():
            self._say(f"{what:<{_COLUMN}} {value}")


def _describe_seeding(settings: Settings, since_s: float) -> str:
    """Return the progress message before any node runs."""
    world = Path(settings.world)
    doing = "loading the map"
    if settings.sim and world not in (FLAT_WORLD, EMPTY_WORLD):
        doing = f"compiling the world {world.name} and loading the map"
    return f"{'map':<{_COLUMN}} {doing} ({since_s:.0f} s)"


def require_files() -> None:
    """Raise Refused if this user may not open as many files as supervisord and the nodes need."""
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    if most != resource.RLIM_INFINITY and most < FILES:
        raise errors.Refused(
            f"a process may open {most} files here, and semmap needs {FILES:,}; raise the hard limit of open"
            f" files, for example in a new shell: ulimit -n {FILES}"
        )


def _ending(status: int) -> str:
    """Return in words how a process ended."""
    return f"was killed (signal {-status})" if status < 0 else f"ended with status {status}"


def _stop(process: subprocess.Popen[bytes]) -> None:
    """Stop supervisord and the nodes: within 5 seconds, unless the knowledge base is writing."""
    if process.poll() is None:
        process.terminate()
        try:
            process.wait(LONGEST_STOP_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
