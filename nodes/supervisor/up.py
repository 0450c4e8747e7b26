"""`semmap up`: seeds the map, starts the nodes, reports when they are ready, watches and stops them."""

from __future__ import annotations

import contextlib
import fcntl
import math
import os
import re
import shlex
import signal
import socket
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
from semmap.nodes.supervisor.control import LONGEST_STOP_S, SILENT_S, Supervisor
from semmap.nodes.supervisor.notices import Notices
from semmap.nodes.supervisor.settings import Replay, Settings
from semmap.nodes.supervisor.watchdog import Watchdog
from semmap.ontology import EMPTY_WORLD, FLAT_WORLD
from semmap.ontology.model_shapes import varieties_of
from semmap.schemas import errors, keys
from semmap.schemas.calls import reply_type
from semmap.schemas.commands import Classes, Get, List, Status
from semmap.schemas.endpoints import WEB_TOKEN_VARIABLE
from semmap.schemas.entities import Entity
from semmap.schemas.health import Health

_START_TIMEOUT_S = 120.0
_ANSWERS_WITHIN_S = 5.0
"""A supervisord that does not answer for so long hangs."""
_LIVE_PORT = 9876
_COLUMN = max(map(len, keys.NODES))
_LOOK_S = 0.2
_INTRODUCED_S = 3.0
"""Seconds: hearts beat once a second."""
_WAITS_S = 3.0
"""Seconds: whoever waits for longer may do so for something on another host."""
_RUNS = ("STARTING", "RUNNING")


def up(settings: Settings, say: Callable[[str], None]) -> None:
    """Run the system in the foreground until SIGINT or SIGTERM, or until it is told to go `down`.

    Raises the reason when a node cannot start, and InternalError when supervisord ends by itself. Nothing is
    left running then. What an `up` that was killed has left behind is ended first.
    """
    supervisor = Supervisor(Path(settings.data))
    with alone(supervisor.data):
        if supervisor.end_leftovers():
            say(f"{'before':<{_COLUMN}} ended what an earlier semmap up had left running")
        _require_free(settings.listen)
        if settings.record and settings.secure is None:  # anybody on this machine may look at a live view
            settings = structs.replace(settings, live_view=_live_view())
        token = new_token(os.environ.get(WEB_TOKEN_VARIABLE, "")) if settings.web else ""
        if settings.web:
            settings = structs.replace(settings, web_port=_web_port(settings.web_port))
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

    Raises Refused when another `semmap up` has it, BadFile when there can be none.
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
    """Watches the processes and their heartbeats."""

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
        self._stopping = False
        self._deadline_s = time.monotonic() + _START_TIMEOUT_S
        self._waits_from_s = time.monotonic() + _WAITS_S
        self._waits: set[tuple[str, str]] = set()
        """What was said of a node that waits."""
        self._is_replayed = False
        self._begun_s = self._told_s = time.monotonic()

    def run(self) -> None:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, self._on_signal)
        greeted = False
        while not self._stopping and self._process.poll() is None:
            self._look()
            for health in self._notices.wait(_LOOK_S):
                self._hear(health)
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
                f"supervisord {_ending(self._process.returncode)}, and the nodes were stopped with it;"
                " start again with: semmap up"
            )

    def _on_signal(self, *_: object) -> None:
        self._stopping = True

    def _hear(self, health: Health) -> None:
        if not self._watchdog.heard(health.node, health.pid):
            return
        if health.state == "starting":  # a large map takes its time, and tells so
            self._deadline_s = time.monotonic() + _START_TIMEOUT_S
            self._tell_of_waiting(health)
            self._tell_what_takes_long(health)
        if health.node == "kb_node" and self._settings.replay is not None:
            self._tell_of_replay(self._settings.replay, health)
        if health.state == "ready" and self._pids.get(health.node) != health.pid:
            again = " again" if health.node in self._pids else ""
            self._pids[health.node] = health.pid
            self._say(f"{health.node:<{_COLUMN}} ready{again}  pid {health.pid:<7} {health.detail}")
            for note in health.notes:
                self._say(f"{'TBox':<{_COLUMN}} {note}")

    def _tell_of_replay(self, replay: Replay, health: Health) -> None:
        """Say once that all of it has been replayed."""
        if health.commit == replay.until and not self._is_replayed:
            self._is_replayed = True
            self._say(f"{'map':<{_COLUMN}} is as it was after commit {replay.until}, and stays so")

    def _tell_of_waiting(self, health: Health) -> None:
        """In a part of a system, say once for what a node waits: it may be on a host that is not up yet."""
        said = health.node, health.detail
        is_long = time.monotonic() > self._waits_from_s
        if (
            self._settings.only
            and is_long
            and health.detail.startswith("waiting")
            and said not in self._waits
        ):
            self._waits.add(said)
            self._say(f"{health.node:<{_COLUMN}} {health.detail}")

    def _tell_what_takes_long(self, health: Health) -> None:
        """Say now and then what a node does that is not ready yet."""
        now_s = time.monotonic()
        if health.detail and now_s - self._told_s > SILENT_S:
            self._told_s = now_s
            self._say(f"{health.node:<{_COLUMN}} {health.detail} ({now_s - self._begun_s:.0f} s)")

    def _look(self) -> None:
        """See which processes there are.

        A node that ended with an error which no restart mends ends the start, with its last words; so does a
        supervisord that hangs.
        """
        try:
            processes = self._supervisor.processes()
            self._answered_s = time.monotonic()
        except errors.NoAnswer:
            if time.monotonic() - self._answered_s > _ANSWERS_WITHIN_S:
                raise errors.InternalError(
                    "supervisord does not answer any more, and was ended with the nodes; start again with:"
                    " semmap up"
                ) from None
            return
        self._watchdog.run_as(
            {node: info["pid"] for node, info in processes.items() if info["statename"] in _RUNS}
        )
        for node, info in processes.items():
            self._require_alive(node, info)

    def _require_alive(self, node: str, info: dict[str, Any]) -> None:
        # Killed by a signal it is "exited", too, for the moment until it is restarted.
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

    def _wait_until_complete(self) -> None:
        """Let the coordinator know every node, and bodies stand, before anybody is told that all is ready.

        Not for long: where there are many bodies, or one cannot be as the map says, it is ready before.
        """
        with (
            contextlib.suppress(errors.SemmapError, OSError),
            bus.open_session(self._network()) as session,
        ):
            deadline_s = time.monotonic() + _INTRODUCED_S
            waits_for: tuple[str, ...] = ()
            while time.monotonic() < deadline_s:
                status = bus.ask(session, keys.CMD, Status.VERB, Status(), reply_type(Status))
                known = {node.pid for node in status.nodes if node.state == "ready"}
                keeps = status.truth != "perceived" and "sim_node" in self._pids
                waits_for = status.pending if keeps else ()  # bodies that move hold nothing up
                stands = not keeps or (status.in_agreement is not None and not waits_for)
                if stands and known >= {pid for node, pid in self._pids.items() if node != keys.WEB}:
                    break
                time.sleep(0.05)
            else:
                for waited in waits_for:
                    self._say(f"{'scene':<{_COLUMN}} not complete yet: {waited}")
            self._report_truth(status.truth)
            self._report_models(session)
            self._report_robot_position(session)

    def _report_truth(self, truth: str) -> None:
        """Say where perception looks at what the map itself has placed, as the coordinator elsewhere says."""
        sees_the_simulator = {"sim_node", "perception_node"} <= {*self._settings.only}
        if sees_the_simulator and self._settings.camera_hz and truth != "perceived":
            self._say(
                f"{'perception':<{_COLUMN}} with --truth {truth}, as the coordinator runs, the simulator's"
                " cameras only show what the map already says; start it with --truth perceived"
            )

    def _report_robot_position(self, session: bus.Session) -> None:
        """Say where a robot stands that is not new to the map, where another place was said for a new one."""
        name, at = self._settings.robot_name, self._settings.robot_at
        if self._settings.robot is None or at is None or not self._settings.sim:
            return
        with contextlib.suppress(errors.SemmapError, OSError):
            robot = bus.ask(session, keys.CMD, Get.VERB, Get(name=name), reply_type(Get))
            if robot.pose is not None and math.dist(robot.pose.position_m, at) > self._settings.threshold_m:
                stands = ", ".join(f"{value:g}" for value in robot.pose.position_m)
                there = " ".join(f"{value:g}" for value in at)
                self._say(
                    f"{name:<{_COLUMN}} stands where it last stood, at ({stands}), not at --robot-at;"
                    f" to put it there: semmap move {name} --at {there}"
                )

    def _report_models(self, session: bus.Session) -> None:
        """Say which of the files in `--models` are nobody's model, and what models could not bring along."""
        if self._settings.models is None or not self._settings.sim:
            return
        from semmap.nodes.sim_node.models.sources import passed_over  # and with it MuJoCo
        from semmap.nodes.sim_node.models.write_shapes import own_notes

        folder = Path(self._settings.models)
        with contextlib.suppress(errors.SemmapError, OSError):
            classes = bus.ask(session, keys.CMD, Classes.VERB, Classes(), reply_type(Classes))
            names = {name for c in classes for name in (c.model, *varieties_of(c.model))}
            if passed_over(folder, names):
                listed = bus.ask(session, keys.CMD, List.VERB, List(), reply_type(List))
                names |= {entity.model for entity in listed if isinstance(entity, Entity)}
            if strange := passed_over(folder, names):
                said = f"ignored, because no class has a model of that name: {', '.join(strange)}"
                self._say(f"{'models':<{_COLUMN}} {said}")
            for note in own_notes(folder, names):
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
        self._say("")
        for what, value in lines.items():
            self._say(f"{what:<{_COLUMN}} {value}")


def _describe_seeding(settings: Settings, since_s: float) -> str:
    """What is done before any node runs, and for how long it has been."""
    world = Path(settings.world)
    doing = "reading the map"
    if settings.sim and world not in (FLAT_WORLD, EMPTY_WORLD):
        doing = f"compiling the world {world.name}, and reading the map"
    return f"{'map':<{_COLUMN}} {doing} ({since_s:.0f} s)"


def _require_free(endpoint: str) -> None:
    """Refuse an endpoint that another system of this machine listens on, rather than take it for ours."""
    match = re.fullmatch(r"(?:tcp|tls)/(.+):(\d+)", endpoint)
    if match is None:
        return
    host, port = match[1].strip("[]"), int(match[2])
    with socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            raise errors.Refused(
                f"cannot listen on {endpoint}: {error.strerror}; choose another, such as"
                f" --listen tcp/{match[1]}:{port + 1}"
            ) from None


def _web_port(port: int) -> int:
    """The port of the page: this one, if it is free, or for 0 any that is. Raises Refused."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
        except OSError as error:
            raise errors.Refused(
                f"the page cannot listen on 127.0.0.1:{port}: {error.strerror}; choose another with"
                " --web-port, or --web-port 0 for any that is free"
            ) from None
        return int(probe.getsockname()[1])


def _ending(status: int) -> str:
    """How a process ended, as a predicate."""
    return f"was killed (signal {-status})" if status < 0 else f"ended with status {status}"


def _live_view() -> str:
    """The port on which Rerun viewers look for a live recording, or another one when that is taken."""
    for port in (_LIVE_PORT, 0):
        with socket.socket() as probe, contextlib.suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return f"127.0.0.1:{probe.getsockname()[1]}"
    raise AssertionError("port 0 can always be bound")


def _stop(process: subprocess.Popen[bytes]) -> None:
    """Stop supervisord and with it the nodes: within 5 seconds, unless the knowledge base is writing."""
    if process.poll() is None:
        process.terminate()
        try:
            process.wait(LONGEST_STOP_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
