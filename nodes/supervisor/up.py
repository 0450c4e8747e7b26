"""`semmap up`: seeds the map, starts the nodes, reports when they are ready, watches and stops them."""

from __future__ import annotations

import contextlib
import queue
import re
import shlex
import signal
import socket
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

from msgspec import structs

from nodes import bus
from nodes.identity import SUPERVISOR, Identity
from nodes.supervisor import presence, registry
from nodes.supervisor.control import LONGEST_STOP_S, Supervisor
from nodes.supervisor.settings import Settings
from nodes.supervisor.watchdog import Watchdog
from schemas import errors, keys
from schemas.calls import reply_type
from schemas.commands import Classes
from schemas.health import Health

_START_TIMEOUT_S = 120.0
_LIVE_PORT = 9876
_COLUMN = max(map(len, keys.NODES))


def up(settings: Settings, say: Callable[[str], None]) -> None:
    """Run the system in the foreground until SIGINT or SIGTERM, or until it is told to go `down`.

    Raises the reason when a node cannot start; nothing is left running then.
    """
    supervisor = Supervisor(Path(settings.data))
    if supervisor.is_running():
        down = f"semmap down --data {shlex.quote(settings.data)}"
        raise errors.Refused(f"a system is already running on {settings.data}; stop it with: {down}")
    _require_free(settings.listen)
    if settings.record and settings.secure is None:  # anybody on this machine may look at a live view
        settings = structs.replace(settings, live_view=_live_view())
    with presence.announced(settings.reachable):
        say(f"{'map':<{_COLUMN}} {supervisor.seed(settings)}")
        process = supervisor.start(settings)
        try:
            with registry.entered(
                data=supervisor.data, listen=settings.listen, reachable=settings.reachable, pid=process.pid
            ):
                _Foreground(supervisor, settings, process, say).run()
        finally:
            _stop(process)
            say("stopped")


class _Foreground:
    """Watches the processes and their heartbeats."""

    def __init__(
        self,
        supervisor: Supervisor,
        settings: Settings,
        process: subprocess.Popen[bytes],
        say: Callable[[str], None],
    ) -> None:
        self._supervisor = supervisor
        self._settings = settings
        self._process = process
        self._say = say
        self._beats: queue.SimpleQueue[Health] = queue.SimpleQueue()
        self._pids: dict[str, int] = {}
        self._watchdog = Watchdog()
        self._stopping = False
        self._deadline_s = time.monotonic() + _START_TIMEOUT_S

    def run(self) -> None:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, self._on_signal)
        greeted = False
        with contextlib.ExitStack() as stack:
            session = None
            while not self._stopping and self._process.poll() is None:
                self._require_alive()
                if session is None:
                    session = self._follow(stack)
                self._hear()
                if session is not None and not greeted and set(self._pids) == set(self._settings.nodes):
                    greeted = True
                    self._tell_of_models(session)
                    self._greet()
                if not greeted and time.monotonic() > self._deadline_s:
                    late = sorted(set(self._settings.nodes) - set(self._pids))
                    raise errors.NoAnswer(f"not ready after {_START_TIMEOUT_S:g} s: {', '.join(late)}")
                self._restart_what_hangs()

    def _on_signal(self, *_: object) -> None:
        self._stopping = True

    def _follow(self, stack: contextlib.ExitStack) -> bus.Session | None:
        """Join the network as soon as the coordinator listens."""
        try:
            session = stack.enter_context(bus.open_session(self._network()))
        except errors.NoAnswer:
            return None
        bus.follow(session, keys.HEALTH, lambda _, health: self._beats.put(health))
        return session

    def _network(self) -> bus.Network:
        secure = self._settings.secure
        identity = None if secure is None else Identity.read(Path(secure) / SUPERVISOR)
        own_config = self._settings.zenoh_config
        return bus.Network(connect=(self._settings.reachable,), identity=identity, own_config=own_config)

    def _hear(self) -> None:
        with contextlib.suppress(queue.Empty):
            health = self._beats.get(timeout=0.2)
            self._watchdog.heard(health.node, health.pid)
            if health.state == "starting":  # a large map takes its time, and tells so
                self._deadline_s = time.monotonic() + _START_TIMEOUT_S
            if health.state == "ready" and self._pids.get(health.node) != health.pid:
                again = " again" if health.node in self._pids else ""
                self._pids[health.node] = health.pid
                self._say(f"{health.node:<{_COLUMN}} ready{again}  pid {health.pid:<7} {health.detail}")
                for note in health.notes:
                    self._say(f"{'TBox':<{_COLUMN}} {note}")

    def _require_alive(self) -> None:
        """A node that ended with an error which no restart mends ends the start, with its last words."""
        for node, info in self._supervisor.processes().items():
            # Killed by a signal it is "exited", too, for the moment until it is restarted.
            gave_up = info["statename"] == "EXITED" and int(info["exitstatus"]) >= 0
            ended = gave_up or info["statename"] == "FATAL"
            if ended and not self._stopping and self._process.poll() is None:
                words = self._supervisor.last_words(node)
                raise errors.Refused(f"{node} exited: {words} (log: {self._supervisor.log_of(node)})")

    def _restart_what_hangs(self) -> None:
        for node, reason in self._watchdog.hanging():
            self._say(f"{node:<{_COLUMN}} {reason}: restarting it")
            self._supervisor.restart(node)

    def _tell_of_models(self, session: bus.Session) -> None:
        """Say which of the files in `--models` are nobody's model."""
        if self._settings.models is None or not self._settings.sim:
            return
        from nodes.sim_node.models.sources import passed_over  # and with it MuJoCo

        with contextlib.suppress(errors.SemmapError, OSError):
            classes = bus.ask(session, keys.CMD, Classes.VERB, Classes(), reply_type(Classes))
            if strange := passed_over(Path(self._settings.models), {c.model for c in classes}):
                said = f"ignored, because no class has a model of that name: {', '.join(strange)}"
                self._say(f"{'models':<{_COLUMN}} {said}")

    def _greet(self) -> None:
        usual = self._settings.reachable == bus.DEFAULT_ENDPOINT
        connect = "" if usual else f" --connect {self._settings.reachable}"
        if self._settings.secure is not None:
            connect += f" --identity {shlex.quote(self._settings.secure)}/NAME"
        lines = {"zenoh": self._settings.reachable, "data": self._settings.data}
        if self._settings.record:
            lines["recording"] = f"{self._settings.data}/recordings"
        if self._settings.live_view is not None:
            lines["live view"] = f"rerun --connect rerun+http://{self._settings.live_view}/proxy"
        lines |= {"try": f"semmap list{connect}", "stop": "Ctrl-C"}
        self._say("")
        for what, value in lines.items():
            self._say(f"{what:<{_COLUMN}} {value}")


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
                f"cannot listen on {endpoint}: {error.strerror}; choose another with --listen"
            ) from None


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
