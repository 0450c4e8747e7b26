"""supervisord: its configuration, and control over its unix socket."""

from __future__ import annotations

import configparser
import contextlib
import hashlib
import io
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
import xmlrpc.client
from collections.abc import Callable
from http.client import HTTPConnection, HTTPException
from pathlib import Path
from typing import Any

from supervisor.xmlrpc import SupervisorTransport

from semmap.nodes.runtime.notify import NOTIFY_VARIABLE
from semmap.nodes.supervisor import orphans, registry
from semmap.nodes.supervisor.privacy import UMASK, make_private
from semmap.nodes.supervisor.settings import SETTINGS, Settings
from semmap.schemas import codec, errors
from semmap.schemas.endpoints import WEB_TOKEN_VARIABLE

GROUP = "semmap"
_SOCKET = f"semmap-{os.getuid()}-{{}}{{}}"
_STOP_WAIT_S = 3
_ANSWER_S = 3.0
"""Seconds: supervisord answers within milliseconds, or it hangs."""
_NO_ANSWER = (OSError, HTTPException, xmlrpc.client.ProtocolError, xmlrpc.client.ResponseError)
"""A fault is an answer: that of a supervisord that is waiting for its nodes to stop."""
_STOP_WAITS_S = {"kb_node": 30}
"""Longer for those who may be writing: a checkpoint of a million entities takes some time."""
LONGEST_STOP_S = max(_STOP_WAITS_S.values()) + _STOP_WAIT_S
"""Until supervisord itself has ended."""
SILENT_S = 10.0
"""For no longer is nothing said of what takes long."""
_NO_RESTART = "0,1,2"
"""Exit statuses after which a restart would fail the same way: stopped, refused, bad request."""


class Supervisor:
    """The supervisord of one data folder."""

    def __init__(self, data: Path) -> None:
        self.data = data
        self.logs = data / "logs"
        self._settings_path = data / SETTINGS
        self._conf_path = data / "supervisord.conf"

    @property
    def socket(self) -> Path:
        """Its control socket."""
        return self._temporary(".sock")

    @property
    def notices(self) -> Path:
        """The socket on which its nodes tell `semmap up` how they are."""
        return self._temporary(".notices")

    @property
    def lock(self) -> Path:
        """The file that `semmap up` holds a lock of."""
        return self.data / "up.lock"

    @property
    def settings(self) -> Settings:
        """What it was started with."""
        return codec.decode(self._settings_path.read_bytes(), Settings)

    def start(self, settings: Settings, *, web_token: str = "") -> subprocess.Popen[bytes]:
        """Start it and, through it, the nodes; `web_token` opens the page, and is on no disk."""
        self.logs.mkdir(parents=True, exist_ok=True)
        self._settings_path.write_bytes(codec.encode_json(settings))
        self._conf_path.write_text(self._conf(settings))
        command = [
            sys.executable,
            "-P",
            "-m",
            "semmap.nodes.supervisor.daemon",
            "-n",
            "-c",
            str(self._conf_path),
        ]
        environment = {**os.environ, NOTIFY_VARIABLE: str(self.notices)}
        if web_token:
            environment[WEB_TOKEN_VARIABLE] = web_token
        with (self.logs / "supervisord.out").open("wb") as out:
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
        """Make the journal; what was done, in words. Raises the reason why it could not be made.

        While that takes long, `waiting` is told now and then for how long it has taken.
        """
        try:
            make_private(self.data)
            self._settings_path.write_bytes(codec.encode_json(settings))
        except OSError as error:
            raise errors.BadFile(f"cannot store data in {self.data}: {error.strerror}") from None
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
                    made, said = run.communicate(timeout=SILENT_S)
                    break
                except subprocess.TimeoutExpired:
                    waiting(time.monotonic() - begun_s)
                except BaseException:
                    run.kill()
                    raise
        if run.returncode != 0:
            reason = said.strip().removeprefix("seed: ") or f"seeding failed with status {run.returncode}"
            raise (errors.BadFile if run.returncode == 2 else errors.Refused)(reason)
        return made.strip()

    def is_running(self) -> bool:
        """Does it answer?"""
        try:
            with self._rpc() as rpc, contextlib.suppress(xmlrpc.client.Fault):
                rpc.supervisor.getPID()
        except _NO_ANSWER:
            return False
        return True

    def processes(self) -> dict[str, dict[str, Any]]:
        """State of each node's process, by node; empty while all are being stopped.

        Raises NoAnswer when supervisord does not answer.
        """
        try:
            with self._rpc() as rpc:
                return {info["name"]: info for info in rpc.supervisor.getAllProcessInfo()}
        except xmlrpc.client.Fault:
            return {}
        except _NO_ANSWER:
            raise errors.NoAnswer("supervisord does not answer") from None

    def replace(self, pid: int) -> None:
        """Kill a node's process and those that it has started; supervisord starts it again."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(pid, signal.SIGKILL)

    def shut_down(self) -> None:
        """Stop the nodes and supervisord itself, and what was left behind by one that was killed.

        Raises NoAnswer when nothing of it runs.
        """
        try:
            with self._rpc() as rpc, contextlib.suppress(xmlrpc.client.Fault):
                rpc.supervisor.shutdown()
        except _NO_ANSWER:
            if self.end_leftovers():
                return
            others = ", ".join(f"{other.data} ({other.listen})" for other in registry.systems())
            hint = f"; running systems: {others}" if others else ""
            raise errors.NoAnswer(f"no system is running on {self.data}{hint}") from None
        deadline = time.monotonic() + LONGEST_STOP_S
        while self.is_running() and time.monotonic() < deadline:
            time.sleep(0.1)
        deadline = time.monotonic() + _STOP_WAIT_S
        while orphans.processes_with(self._conf_path) and time.monotonic() < deadline:
            time.sleep(0.1)  # it does not answer any more, and is about to end
        self.end_leftovers()

    def end_leftovers(self) -> int:
        """End the processes of this data folder that run without `semmap up`; how many there were."""
        return orphans.end_all(self._conf_path, self._settings_path)

    def last_log_line(self, node: str) -> str:
        """The last line that a node wrote to its log."""
        path = self.log_of(node)
        lines = path.read_text(errors="replace").strip().splitlines() if path.exists() else []
        return lines[-1].removeprefix(f"{node}: ") if lines else "(its log is empty)"

    def log_of(self, node: str) -> Path:
        """The file that a node writes to."""
        return self.logs / f"{node}.log"

    def _temporary(self, suffix: str) -> Path:
        """A socket in the temporary folder, because paths of sockets must be short."""
        digest = hashlib.sha256(str(self.data.resolve()).encode()).hexdigest()[:12]
        return Path(tempfile.gettempdir()) / _SOCKET.format(digest, suffix)

    def _rpc(self) -> Any:
        return xmlrpc.client.ServerProxy("http://127.0.0.1", transport=_Transport(self.socket))

    def _conf(self, settings: Settings) -> str:
        conf = configparser.RawConfigParser()
        conf["unix_http_server"] = {"file": str(self.socket), "chmod": "0700"}
        conf["supervisord"] = {
            "logfile": str(self.logs / "supervisord.log"),
            "pidfile": str(self.data / "supervisord.pid"),
            "childlogdir": str(self.logs),
            "identifier": GROUP,
            "umask": f"{UMASK:03o}",
        }
        conf["rpcinterface:supervisor"] = {
            "supervisor.rpcinterface_factory": "supervisor.rpcinterface:make_main_rpcinterface"
        }
        conf[f"group:{GROUP}"] = {"programs": ",".join(settings.nodes)}
        for priority, node in enumerate(settings.nodes, start=1):
            words = [
                sys.executable,
                "-P",
                "-m",
                "semmap.nodes.supervisor.launch",
                node,
                str(self._settings_path),
            ]
            conf[f"program:{node}"] = {
                "command": " ".join(f'"{word}"' for word in words).replace("%", "%%"),
                "priority": str(priority),
                "startsecs": "0",
                "startretries": "10",
                "autorestart": "unexpected",
                "exitcodes": _NO_RESTART,
                "stopwaitsecs": str(_STOP_WAITS_S.get(node, _STOP_WAIT_S)),
                "stopasgroup": "true",
                "killasgroup": "true",
                "redirect_stderr": "true",
                "stdout_logfile": str(self.log_of(node)).replace("%", "%%"),
                "stdout_logfile_maxbytes": "10MB",
                "stdout_logfile_backups": "2",
            }
        text = io.StringIO()
        conf.write(text)
        return text.getvalue()


class _Transport(SupervisorTransport):  # type: ignore[misc]
    """Over the unix socket, without waiting longer than a supervisord takes that is well."""

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
