"""Open a session.

One that has a Python callback keeps the process from exiting until it is closed (seen with Zenoh 1.10.2), so
sessions are context managers.
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
"""Seconds: as long as a node takes to be back after a kill, on a busy machine and with a large map."""
FOREVER_S = math.inf
"""As patience: a node goes on trying to connect."""
_MEET_MS = 100
"""Milliseconds: as long as a peer that joins may take to meet those that it hears of. It takes a few, but
often Zenoh 1.10.2 does not notice that it is done, and would wait for half a second."""

_READERS: Final = 8
"""Threads that read links. One whose messages wait for a busy callback holds up its thread; of Zenoh's own
number, 2, two senders that flood would take both, and whoever asks over another link would wait for them."""
_THREADS: Final = "ZENOH_RUNTIME"
"""The environment variable by which Zenoh takes the numbers of its threads, once in a process."""

_LARGEST: Final = "transport/link/rx/max_message_size"

_NOT_REACHED = ("Unable to connect", "Can not create a new", "deadline has elapsed")
_HUNG_UP = "Read error on T"


class Network(Struct, frozen=True):
    """How a process joins the system: a node listens, a client does not.

    A "peer" reaches each node by itself, a "client" all of them by the one that it connects to. `namespace`
    prefixes every key (one robot of many).

    A client whose connection is refused tries again for `patience_s`; 0 is once.

    With an `identity` all links are mutual TLS. `access` is Zenoh's access control, of a router.
    """

    connect: tuple[str, ...] = (DEFAULT_ENDPOINT,)
    listen: tuple[str, ...] = ()
    mode: str = "client"
    namespace: str = ""
    patience_s: float = PATIENCE_S
    identity: Identity | None = None
    access: Mapping[str, Any] | None = None
    own_config: str | None = None
    """A Zenoh configuration file, in which all that is not said here holds."""

    @property
    def commands(self) -> str:
        """The prefix under which this process asks for commands: its own, where it has a name."""
        return keys.CMD if self.identity is None else keys.commands_as(self.identity.name)

    def values(self) -> dict[str, Any]:
        """What Zenoh's configuration is to say, by path.

        Scouting and shared memory are off; a node goes on trying to connect, a client gives up.
        """
        node = bool(self.listen) or self.patience_s == FOREVER_S
        first_ms, last_ms = (100, 500) if self.identity is None else (50, 200)  # a router begins anew, too
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
        """The same as a configuration file of Zenoh's, for a program that is not one of ours."""
        document: dict[str, Any] = {}
        for path, value in {**self.values(), _LARGEST: fragmentation.PLANE_BYTES}.items():
            *above, last = path.split("/")
            inner = document
            for name in above:
                inner = inner.setdefault(name, {})
            inner[last] = value
        return json.dumps(document, indent=2)

    def as_config(self) -> zenoh.Config:
        """The configuration of a session. Raises BadFile for one of one's own that cannot be read."""
        values = self.values()
        config = zenoh.Config() if self.own_config is None else zenoh_config.read(self.own_config)
        if self.own_config is None or config.get_json(_LARGEST) == zenoh.Config().get_json(_LARGEST):
            values[_LARGEST] = fragmentation.PLANE_BYTES
        for key, value in values.items():
            config.insert_json5(key, json.dumps(value))
        return config


def set_reader_threads() -> None:
    """Let a flood on some links not hold up the others; to be called before the process's first session."""
    os.environ.setdefault(_THREADS, f"(rx: (worker_threads: {_READERS}))")


def require_tls(endpoint: str) -> None:
    """Raises BadRequest for an endpoint without certificates, or with a set-up of its own."""
    if not endpoint.startswith(TLS) or "#" in endpoint:
        raise errors.BadRequest(
            "certificates are shown at endpoints of TLS only, such as tls/127.0.0.1:7447;"
            f" '{endpoint}' is not one"
        )


class ConnectionClosed(errors.NoAnswer):
    """Somebody listens there, and does not want to talk with us."""


def host_of(endpoint: str) -> str:
    """The host of an endpoint `protocol/host:port`."""
    return endpoint.partition("/")[2].partition("#")[0].partition("?")[0].rpartition(":")[0].strip("[]")


def is_local(endpoint: str) -> bool:
    """Can only programs of this machine reach it? A port of loopback, or a socket in the file system."""
    if endpoint.startswith(("unixsock-stream/", "unixpipe/")):
        return True
    host = host_of(endpoint)
    return host in ("localhost", "::1") or re.fullmatch(r"127(\.\d{1,3}){3}", host) is not None


def to_tls(endpoint: str) -> str:
    """The endpoint by TLS, where it was given by plain TCP."""
    return TLS + endpoint.removeprefix("tcp/") if endpoint.startswith("tcp/") else endpoint


def _tls(identity: Identity, *, listens: bool) -> dict[str, Any]:
    """Both ends show a certificate, and a link ends when that of either expires."""
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
    """To how many routers a session has a link just now."""
    return len(session.info.routers_zid())


@contextmanager
def open_session(network: Network) -> Iterator[zenoh.Session]:
    """A session that is closed whatever happens. Raises NoAnswer or BadRequest (a malformed endpoint)."""
    try:
        session = zenoh.open(network.as_config())
    except zenoh.ZError as error:
        where = ", ".join((*network.listen, *network.connect))
        if not network.listen and any(said in str(error) for said in _NOT_REACHED):
            if network.identity is not None:
                raise errors.NoAnswer(
                    f"no system answers at {where}: none runs there with --secure, or it does not admit"
                    f" the certificate of {network.identity.name}, or {network.identity.authority} does not"
                    " vouch for it"
                ) from None
            raise errors.NoAnswer(f"no system answers at {where}; start one with: semmap up") from None
        if not network.listen and _HUNG_UP in str(error):
            raise ConnectionClosed(
                f"whoever listens at {where} hung up; a secure system wants to know who you are:"
                " --identity DIR/NAME"
            ) from None
        if "Endpoints must be of the form" in str(error):
            raise errors.BadRequest(
                f"'{where}' is not a valid Zenoh endpoint; example: {DEFAULT_ENDPOINT}"
            ) from None
        reason = str(error).split(" at /", 1)[0]
        raise errors.BadRequest(f"cannot open a session at {where}: {reason}") from None
    try:
        yield session
    finally:
        session.close()  # type: ignore[no-untyped-call]
