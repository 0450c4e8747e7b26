"""The configuration of supervisord, and its control over a unix socket."""

from __future__ import annotations

import configparser
import contextlib
import hashlib
import io
import os
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import time
import xmlrpc.client
from collections.abc import Callable
from http.client import HTTPConnection, HTTPException
from pathlib import Path
from typing import Any

from supervisor.xmlrpc import SupervisorTransport

from semmap.nodes.runtime.isolated_process import CPU_S
from semmap.nodes.runtime.notify import NOTIFY_VARIABLE
from semmap.nodes.runtime.requests_in_work import IN_WORK_VARIABLE
from semmap.nodes.runtime.sockets import socket_folder
from semmap.nodes.supervisor import orphans, registry
from semmap.nodes.supervisor.privacy import UMASK, make_private
from semmap.nodes.supervisor.settings import SETTINGS, Settings
from semmap.schemas import codec, errors
from semmap.schemas.endpoints import WEB_TOKEN_VARIABLE
from semmap.schemas.wording import few

GROUP = "semmap"
_SOCKET = f"semmap-{os.getuid()}-{{}}{{}}"
_OUTPUT = "supervisord.out"
_STOP_WAIT_S = 3
_ANSWER_S = 3.0
"""Seconds: supervisord replies within milliseconds, unless it hangs."""
_NO_ANSWER = (OSError, HTTPException, xmlrpc.client.ProtocolError, xmlrpc.client.ResponseError)
"""An XML-RPC fault is a reply: supervisord is waiting for its nodes to stop."""
_STOP_WAITS_S = {"kb_node": 30}
"""Longer for nodes that may be writing: a checkpoint of a million entities takes some time."""
LONGEST_STOP_S = max(_STOP_WAITS_S.values()) + _STOP_WAIT_S
"""Longest time until supervisord has ended."""
SILENT_S = 10.0
"""Longest time without a progress message."""
_VARIABLE = "SEMMAP_UP_"
"""The prefix of variables with paths. In the configuration itself, characters such as `%` have a meaning."""
FILES = 1024
"""Files that a process must be able to open. supervisord raises its own limit to this number."""
_NO_RESTART = "0,1,2"
"""Exit statuses after which a restart would fail again: stopped, rejected, bad request."""


class Supervisor:
    """The supervisord of one data folder."""

    def __init__(self, data: Path) -> None:
        self.data = data
        self.logs = data / "logs"
        self._in_work = data / "in_work"
        self._settings_path = data / SETTINGS
        self._conf_path = data / "supervisord.conf"

    @property
    def socket(self) -> Path:
        """Path of the control socket."""
        return self._temporary(".sock")

    @property
    def notices(self) -> Path:
        """The socket on which its nodes report their health to `semmap up`."""
        return self._temporary(".notices")

    @property
    def lock(self) -> Path:
        """The file that `semmap up` locks."""
        return self.data / "up.lock"

    @property
    def settings(self) -> Settings:
        """The settings it was started with."""
        return codec.decode(self._settings_path.read_bytes(), Settings)

    def start(self, settings: Settings, *, web_token: str = "") -> subprocess.Popen[bytes]:
        """Start supervisord and the nodes; `web_token` opens the page, and is not written to disk.

        Raises BadFile if the data folder cannot be written.
        """
        try:
            self.logs.mkdir(parents=True, exist_ok=True)
            shutil.rmtree(self._in_work, ignore_errors=True)
            self._in_work.mkdir(mode=0o700, exist_ok=True)
            self._settings_path.write_bytes(codec.encode_json(settings))
            self._conf_path.write_text(self._conf(settings))
        except OSError as error:
            raise self._cannot_store(error) from None
        command = [
            sys.executable,
            "-P",
            "-m",
            "semmap.nodes.supervisor.daemon",
            "-n",
            "-c",
            str(self._conf_path),
        ]
        environment = {
            **os.environ,
            **{_VARIABLE + name: value for name, value in self._paths().items()},
            NOTIFY_VARIABLE: str(self.notices),
            IN_WORK_VARIABLE: str(self._in_work.resolve()),
        }
        if web_token:
            environment[WEB_TOKEN_VARIABLE] = web_token
        with (self.logs / _OUTPUT).open("wb") as out:
            make_private(self.data)
            return subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=out,
                start_new_session=True,
                env=environment,
                umask=UMASK,
            )

    def seed(self, settings: Settings, waiting: Callable[[float], None] = lambda since_s: None) -> str:
        """Create the journal and return in words what was done. Raises the reason if that fails.

        While it takes long, `waiting` is called regularly with the elapsed seconds.
        """
        try:
            make_private(self.data)
            self._settings_path.write_bytes(codec.encode_json(settings))
        except OSError as error:
            raise self._cannot_store(error) from None
        command = [
            sys.executable,
            "-P",
            "-m",
            "semmap.nodes.supervisor.launch",
            "seed",
            str(self._settings_path),
        ]
        pipe = subprocess.PIPE
        with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, umask=UMASK) as run:
            begun_s = time.monotonic()
            while True:
                try:
                    made, stderr = run.communicate(timeout=SILENT_S)
                    break
                except subprocess.TimeoutExpired:
                    waiting(time.monotonic() - begun_s)
                except BaseException:
                    run.kill()
                    raise
        if run.returncode == -signal.SIGXCPU:
            raise errors.BadFile(
                f"the world or the TBox takes longer than {CPU_S:g} s to read (CPU time); use smaller files"
            )
        if run.returncode != 0:
            reason = stderr.strip().removeprefix("seed: ") or f"seeding failed with status {run.returncode}"
            raise (errors.BadFile if run.returncode == 2 else errors.Refused)(reason)
        return made.strip()

    def _cannot_store(self, error: OSError) -> errors.BadFile:
        return errors.BadFile(f"cannot store data in {self.data}: {error.strerror}")

    def is_running(self) -> bool:
        """Return whether it replies."""
        try:
            with self._rpc() as rpc, contextlib.suppress(xmlrpc.client.Fault):
                rpc.supervisor.getPID()
        except _NO_ANSWER:
            return False
        return True

    def processes(self) -> dict[str, dict[str, Any]]:
        """Return the state of each node's process, by node; empty while all are being stopped.

        Raises NoAnswer if supervisord does not reply.
        """
        try:
            with self._rpc() as rpc:
                return {info["name"]: info for info in rpc.supervisor.getAllProcessInfo()}
        except xmlrpc.client.Fault:
            return {}
        except _NO_ANSWER:
            raise errors.NoAnswer("no response from supervisord") from None

    def replace(self, pid: int) -> None:
        """Kill a node's process and its children; supervisord restarts the node."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(pid, signal.SIGKILL)

    def shut_down(self) -> None:
        """Stop the nodes and supervisord, and processes left behind by a killed one.

        Raises NoAnswer if none is running.
        """
        try:
            with self._rpc() as rpc, contextlib.suppress(xmlrpc.client.Fault):
                rpc.supervisor.shutdown()
        except _NO_ANSWER:
            if self.end_leftovers():
                return
            others = [f"{other.data} ({other.listen})" for other in registry.systems()]
            hint = f"; running systems: {few(others, 5)}" if others else ""
            raise errors.NoAnswer(f"no system is running on {self.data}{hint}") from None
        deadline = time.monotonic() + LONGEST_STOP_S
        while self.is_running() and time.monotonic() < deadline:
            time.sleep(0.1)
        deadline = time.monotonic() + _STOP_WAIT_S
        while orphans.processes_with(self._conf_path) and time.monotonic() < deadline:
            time.sleep(0.1)  # it no longer replies, and is about to end
        self.end_leftovers()

    def end_leftovers(self) -> int:
        """End the processes of this data folder that run without `semmap up`, and return their number."""
        return orphans.end_all(self._conf_path, self._settings_path)

    def last_log_line(self, node: str) -> str:
        """Return the last line of a node's log."""
        path = self.log_of(node)
        lines = path.read_text(errors="replace").strip().splitlines() if path.exists() else []
        return lines[-1].removeprefix(f"{node}: ") if lines else "(its log is empty)"

    def last_error(self) -> str:
        """Return the reason that supervisord gave for ending, in parentheses, or an empty text."""
        with contextlib.suppress(OSError):
            for line in (self.logs / _OUTPUT).read_text(errors="replace").splitlines():
                if line.startswith("Error: "):
                    return f" ({errors.shortened(line.removeprefix('Error: '), 300)})"
        return ""

    def log_of(self, node: str) -> Path:
        """Return the log file of a node."""
        return self.logs / f"{node}.log"

    def _temporary(self, suffix: str) -> Path:
        """Return the path of a socket in the temporary folder, because socket paths must be short."""
        digest = hashlib.sha256(os.fsencode(self.data.resolve())).hexdigest()[:12]
        name = _SOCKET.format(digest, suffix)
        return socket_folder(name) / name

    def _rpc(self) -> Any:
        return xmlrpc.client.ServerProxy("http://127.0.0.1", transport=_Transport(self.socket))

    def _paths(self) -> dict[str, str]:
        """Return the paths for the configuration, by the names of their variables."""
        return {
            "SOCKET": str(self.socket),
            "DATA": str(self.data),
            "LOGS": str(self.logs),
            "NODE_LOGS": str(self.logs).replace("%", "%%"),  # supervisord expands these twice
            "PYTHON": shlex.quote(sys.executable),
            "SETTINGS": shlex.quote(str(self._settings_path)),
        }

    def _conf(self, settings: Settings) -> str:
        paths = {name.lower(): f"%(ENV_{_VARIABLE}{name})s" for name in self._paths()}
        conf = configparser.RawConfigParser()
        conf["unix_http_server"] = {"file": paths["socket"], "chmod": "0700"}
        conf["supervisord"] = {
            "logfile": f"{paths['logs']}/supervisord.log",
            "pidfile": f"{paths['data']}/supervisord.pid",
            "childlogdir": paths["logs"],
            "identifier": GROUP,
            "minfds": str(FILES),
            "umask": f"{UMASK:03o}",
        }
        conf["rpcinterface:supervisor"] = {
            "supervisor.rpcinterface_factory": "supervisor.rpcinterface:make_main_rpcinterface"
        }
        conf[f"group:{GROUP}"] = {"programs": ",".join(settings.nodes)}
        for priority, node in enumerate(settings.nodes, start=1):
            launch = f"{paths['python']} -P -m semmap.nodes.supervisor.launch"
            conf[f"program:{node}"] = {
                "command": f"{launch} {node} {paths['settings']}",
                "priority": str(priority),
                "startsecs": "0",
                "startretries": "10",
                "autorestart": "unexpected",
                "exitcodes": _NO_RESTART,
                "stopwaitsecs": str(_STOP_WAITS_S.get(node, _STOP_WAIT_S)),
                "stopasgroup": "true",
                "killasgroup": "true",
                "redirect_stderr": "true",
                "stdout_logfile": f"{paths['node_logs']}/{self.log_of(node).name}",
                "stdout_logfile_maxbytes": "10MB",
                "stdout_logfile_backups": "2",
            }
        text = io.StringIO()
        conf.write(text)
        return text.getvalue()


class _Transport(SupervisorTransport):  # type: ignore[misc]
    """XML-RPC over the unix socket, with a short time-out."""

    def __init__(self, path: Path) -> None:
        super().__init__(serverurl=f"unix://{path}")
        self._get_connection = lambda: _Connection(path)


class _Connection(HTTPConnection):
    def __init__(self, path: Path) -> None:
        super().__init__("localhost", timeout=_ANSWER_S)
        self._path = path

    def connect(self) -> None:
        self.sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.sock.settimeout(_ANSWER_S)
        self.sock.connect(str(self._path))
