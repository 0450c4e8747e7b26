"""supervisord: its configuration, and control over its unix socket."""

from __future__ import annotations

import configparser
import contextlib
import hashlib
import io
import os
import subprocess
import sys
import tempfile
import time
import xmlrpc.client
from pathlib import Path
from typing import Any

from supervisor.xmlrpc import SupervisorTransport

from nodes.supervisor import registry
from nodes.supervisor.privacy import UMASK, make_private
from nodes.supervisor.settings import SETTINGS, Settings
from schemas import codec, errors

GROUP = "semmap"
_SOCKET = f"semmap-{os.getuid()}-{{}}.sock"
_STOP_WAIT_S = 3
_STOP_WAITS_S = {"kb_node": 30}
"""Longer for those who may be writing: a checkpoint of a million entities takes some time."""
LONGEST_STOP_S = max(_STOP_WAITS_S.values()) + _STOP_WAIT_S
"""Until supervisord itself has ended."""
_WONT_MEND = "0,1,2"
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
        """Its control socket: in the temporary folder, because paths of sockets must be short."""
        digest = hashlib.sha256(str(self.data.resolve()).encode()).hexdigest()[:12]
        return Path(tempfile.gettempdir()) / _SOCKET.format(digest)

    @property
    def settings(self) -> Settings:
        """What it was started with."""
        return codec.decode(self._settings_path.read_bytes(), Settings)

    def start(self, settings: Settings) -> subprocess.Popen[bytes]:
        """Start it and, through it, the nodes."""
        self.logs.mkdir(parents=True, exist_ok=True)
        self._settings_path.write_bytes(codec.encode_json(settings))
        self._conf_path.write_text(self._conf(settings))
        command = [sys.executable, "-P", "-m", "supervisor.supervisord", "-n", "-c", str(self._conf_path)]
        with (self.logs / "supervisord.out").open("wb") as out:
            make_private(self.data)
            return subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=out,
                start_new_session=True,
                umask=UMASK,
            )

    def seed(self, settings: Settings) -> str:
        """Make the journal; what was done, in words. Raises the reason why it could not be made."""
        try:
            make_private(self.data)
            self._settings_path.write_bytes(codec.encode_json(settings))
        except OSError as error:
            raise errors.BadFile(f"cannot store data in {self.data}: {error.strerror}") from None
        command = [sys.executable, "-P", "-m", "nodes.supervisor.launch", "seed", str(self._settings_path)]
        run = subprocess.run(command, capture_output=True, text=True, umask=UMASK)
        if run.returncode != 0:
            reason = (
                run.stderr.strip().removeprefix("seed: ") or f"seeding failed with status {run.returncode}"
            )
            raise (errors.BadFile if run.returncode == 2 else errors.Refused)(reason)
        return run.stdout.strip()

    def is_running(self) -> bool:
        """Does it answer?"""
        try:
            self._rpc().supervisor.getPID()
        except (OSError, xmlrpc.client.Error):
            return False
        return True

    def processes(self) -> dict[str, dict[str, Any]]:
        """State of each node's process, by node; empty when supervisord does not answer."""
        try:
            return {info["name"]: info for info in self._rpc().supervisor.getAllProcessInfo()}
        except (OSError, xmlrpc.client.Error):
            return {}

    def restart(self, node: str) -> None:
        """Kill a node that hangs, then start it anew: there are never two of one kind."""
        rpc, name = self._rpc().supervisor, f"{GROUP}:{node}"
        with contextlib.suppress(xmlrpc.client.Fault):  # it has ended by itself
            rpc.signalProcess(name, "KILL")  # it would not heed anything else, however long it may take
            rpc.stopProcess(name)
        rpc.startProcess(name)

    def shut_down(self) -> None:
        """Stop the nodes and supervisord itself. Raises NoAnswer when it does not run."""
        try:
            self._rpc().supervisor.shutdown()
        except (OSError, xmlrpc.client.Error):
            others = ", ".join(f"{other.data} ({other.listen})" for other in registry.systems())
            hint = f"; running systems: {others}" if others else ""
            raise errors.NoAnswer(f"no system is running on {self.data}{hint}") from None
        deadline = time.monotonic() + LONGEST_STOP_S
        while self.is_running() and time.monotonic() < deadline:
            time.sleep(0.1)

    def last_words(self, node: str) -> str:
        """The last line that a node wrote to its log."""
        path = self.log_of(node)
        lines = path.read_text(errors="replace").strip().splitlines() if path.exists() else []
        return lines[-1].removeprefix(f"{node}: ") if lines else "(its log is empty)"

    def log_of(self, node: str) -> Path:
        """The file that a node writes to."""
        return self.logs / f"{node}.log"

    def _rpc(self) -> Any:
        return _rpc(self.socket)

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
            words = [sys.executable, "-P", "-m", "nodes.supervisor.launch", node, str(self._settings_path)]
            conf[f"program:{node}"] = {
                "command": " ".join(f'"{word}"' for word in words).replace("%", "%%"),
                "priority": str(priority),
                "startsecs": "0",
                "startretries": "10",
                "autorestart": "unexpected",
                "exitcodes": _WONT_MEND,
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


def _rpc(socket: Path) -> Any:
    transport = SupervisorTransport(serverurl=f"unix://{socket}")
    return xmlrpc.client.ServerProxy("http://127.0.0.1", transport=transport)
