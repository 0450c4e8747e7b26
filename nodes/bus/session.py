"""Opens sessions.

A session with a Python callback keeps the process from exiting until it is closed (seen with Zenoh 1.10.2).
Sessions are therefore context managers.
"""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Final

import zenoh
from msgspec import Struct
from zenoh import Session as Session

from semmap.nodes.bus import fragmentation, zenoh_config
from semmap.nodes.identity import Identity
from semmap.schemas import errors, keys
from semmap.schemas.endpoints import DEFAULT_ENDPOINT as DEFAULT_ENDPOINT

TLS = "tls/"
PATIENCE_S = 3.0
RESTART_S = 30.0
"""Seconds that a node needs to restart after a kill, on a busy machine and with a large map."""
FOREVER_S = math.inf
"""As patience: a node never stops trying to connect."""
_MEET_MS = 100
"""Milliseconds that a joining peer may take to connect to the others. It takes a few, but Zenoh 1.10.2 often
does not notice the end and would wait for half a second."""

_READERS: Final = 8
"""Threads that read links. A thread is blocked while a message waits for a busy callback. With Zenoh's
default of 2, two flooding senders would block both, and delay requests on all other links."""
_THREADS: Final = "ZENOH_RUNTIME"
"""The environment variable with Zenoh's numbers of threads, read once in a process."""

_LARGEST: Final = "transport/link/rx/max_message_size"

_NOT_REACHED = ("Unable to connect", "Can not create a new", "deadline has elapsed")
_CONNECTION_CLOSED = "Read error on T"


class Network(Struct, frozen=True):
    """How a process joins the system: a node listens, a client does not.

    A "peer" connects to each node, a "client" only to one. `namespace` prefixes every key (one of several
    robots). A client whose connection is refused retries for `patience_s`; 0 tries once.

    With an `identity` all links use mutual TLS. `access` is the Zenoh access control of a router.
    """

    connect: tuple[str, ...] = (DEFAULT_ENDPOINT,)
    listen: tuple[str, ...] = ()
    mode: str = "client"
    namespace: str = ""
    patience_s: float = PATIENCE_S
    identity: Identity | None = None
    access: Mapping[str, Any] | None = None
    own_config: str | None = None
    """A Zenoh configuration file, for all settings that semmap does not set."""

    @property
    def commands(self) -> str:
        """The prefix of this process's commands; it contains the name of its identity, if it has one."""
        return keys.CMD if self.identity is None else keys.commands_as(self.identity.name)

    def values(self) -> dict[str, Any]:
        """Return the settings for Zenoh, by path.

        Scouting and shared memory are off. A node never stops trying to connect, a client does.
        """
        node = bool(self.listen) or self.patience_s == FOREVER_S
        first_ms, last_ms = (100, 500) if self.identity is None else (50, 200)  # a secure router restarts
        retry = {"period_init_ms": first_ms, "period_max_ms": last_ms, "period_increase_factor": 2}
        values: dict[str, Any] = {
            "mode": self.mode,
            "connect/endpoints": list(self.connect),
            "connect/timeout_ms": -1 if node else int(self.patience_s * 1000),
            "connect/exit_on_failure": not node,
            "connect/retry": retry,
            "listen/endpoints": list(self.listen),
            "scouting/multicast/enabled": False,
            "scouting/delay": _MEET_MS,
            "transport/shared_memory/enabled": False,
            "transport/link/tx/lease": 2000,
            "transport/unicast/open_timeout": int(PATIENCE_S * 1000),
        }
        if self.namespace:
            values["namespace"] = self.namespace
        if self.identity is not None:
            values |= _tls(self.identity, listens=bool(self.listen))
        if self.access is not None:
            values["access_control"] = self.access
        return values

    def as_file(self) -> str:
        """Return the settings as a Zenoh configuration file, for other programs."""
        document: dict[str, Any] = {}
        for path, value in {**self.values(), _LARGEST: fragmentation.PLANE_BYTES}.items():
            *above, last = path.split("/")
            inner = document
            for name in above:
                inner = inner.setdefault(name, {})
            inner[last] = value
        return json.dumps(document, indent=2)

    def as_config(self) -> zenoh.Config:
        """Return the configuration of a session. Raises BadFile for an unreadable configuration file."""
        values = self.values()
        config = zenoh.Config() if self.own_config is None else zenoh_config.read(self.own_config)
        if self.own_config is None or config.get_json(_LARGEST) == zenoh.Config().get_json(_LARGEST):
            values[_LARGEST] = fragmentation.PLANE_BYTES
        for key, value in values.items():
            config.insert_json5(key, json.dumps(value))
        return config


def set_reader_threads() -> None:
    """Read links on more threads, so that a flood on one does not delay others; call before any session."""
    os.environ.setdefault(_THREADS, f"(rx: (worker_threads: {_READERS}))")


def require_tls(endpoint: str) -> None:
    """Raise BadRequest for an endpoint without TLS, or with settings of its own."""
    if not endpoint.startswith(TLS) or "#" in endpoint:
        raise errors.BadRequest(
            f"'{endpoint}' is not a plain TLS endpoint, which certificates require;"
            " example: tls/127.0.0.1:7447"
        )


class ConnectionClosed(errors.NoAnswer):
    """The system rejects this client, for example because it requires a certificate."""


def host_of(endpoint: str) -> str:
    """Return the host of an endpoint `protocol/host:port`."""
    return endpoint.partition("/")[2].partition("#")[0].partition("?")[0].rpartition(":")[0].strip("[]")


def is_local(endpoint: str) -> bool:
    """Return whether an endpoint is reachable from this machine only: loopback or a unix socket."""
    if endpoint.startswith(("unixsock-stream/", "unixpipe/")):
        return True
    host = host_of(endpoint)
    return host in ("localhost", "::1") or re.fullmatch(r"127(\.\d{1,3}){3}", host) is not None


def to_tls(endpoint: str) -> str:
    """Return the TLS endpoint for one of plain TCP."""
    return TLS + endpoint.removeprefix("tcp/") if endpoint.startswith("tcp/") else endpoint


def _tls(identity: Identity, *, listens: bool) -> dict[str, Any]:
    """Return the TLS settings: both ends show a certificate, and a link ends when either expires."""
    values: dict[str, Any] = {
        "root_ca_certificate": identity.authority,
        "enable_mtls": True,
        "connect_certificate": identity.certificate,
        "connect_private_key": identity.key,
        "verify_name_on_connect": True,
        "close_link_on_expiration": True,
    }
    if listens:
        values |= {"listen_certificate": identity.certificate, "listen_private_key": identity.key}
    return {f"transport/link/tls/{key}": value for key, value in values.items()}


def linked_routers(session: zenoh.Session) -> int:
    """Return the number of routers that a session is linked to."""
    return len(session.info.routers_zid())


@contextmanager
def open_session(network: Network) -> Iterator[zenoh.Session]:
    """Open a session and close it at the end. Raises NoAnswer, or BadRequest for a malformed endpoint."""
    try:
        session = zenoh.open(network.as_config())
    except zenoh.ZError as error:
        where = ", ".join((*network.listen, *network.connect))
        if not network.listen and any(reason in str(error) for reason in _NOT_REACHED):
            if network.identity is not None:
                raise errors.NoAnswer(
                    f"no response from {where}: no system runs there with --secure, or it rejects the"
                    f" certificate of {network.identity.name}, or {network.identity.authority} is not its"
                    " authority"
                ) from None
            raise errors.NoAnswer(f"no response from {where}; start a system with: semmap up") from None
        if not network.listen and _CONNECTION_CLOSED in str(error):
            raise ConnectionClosed(
                f"connection closed by {where}: the system requires a client certificate"
                " (--identity DIR/NAME)"
            ) from None
        if "Endpoints must be of the form" in str(error):
            raise errors.BadRequest(
                f"'{where}' is not a valid Zenoh endpoint; example: {DEFAULT_ENDPOINT}"
            ) from None
        reason = str(error).split(" at /", 1)[0]
        raise errors.BadRequest(f"cannot open a session at {where}: {reason}") from None
    try:
        token = session.liveliness().declare_token(keys.session_key(str(session.zid())))
        yield session
        del token
    finally:
        session.close()  # type: ignore[no-untyped-call]
