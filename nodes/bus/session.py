"""Open a session.

One that has a Python callback keeps the process from exiting until it is closed (seen with Zenoh 1.10.2), so
sessions are context managers.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import zenoh
from msgspec import Struct
from zenoh import Session as Session

from schemas import errors
from schemas.endpoints import DEFAULT_ENDPOINT as DEFAULT_ENDPOINT

PATIENCE_S = 3.0
RESTART_S = 30.0
"""Seconds: as long as a node takes to be back after a kill, on a busy machine and with a large map."""
_MEET_MS = 100
"""Milliseconds: as long as a peer that joins may take to meet those that it hears of. It takes a few, but
often Zenoh 1.10.2 does not notice that it is done, and would wait for half a second."""

_NOT_REACHED = ("Unable to connect", "Can not create a new", "deadline has elapsed")


class Network(Struct, frozen=True):
    """How a process joins the system: a node listens, a client does not.

    A "peer" reaches each node by itself, a "client" all of them by the one that it connects to. `namespace`
    prefixes every key (one robot of many).

    A client whose connection is refused tries again for `patience_s`; 0 is once.
    """

    connect: tuple[str, ...] = (DEFAULT_ENDPOINT,)
    listen: tuple[str, ...] = ()
    mode: str = "client"
    namespace: str = ""
    patience_s: float = PATIENCE_S

    def as_config(self) -> zenoh.Config:
        """Scouting and shared memory off; a node goes on trying to connect, a client gives up."""
        node = bool(self.listen)
        retry = {"period_init_ms": 100, "period_max_ms": 500, "period_increase_factor": 2}
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
        config = zenoh.Config()
        for key, value in values.items():
            config.insert_json5(key, json.dumps(value))
        return config


@contextmanager
def open_session(network: Network) -> Iterator[zenoh.Session]:
    """A session that is closed whatever happens. Raises NoAnswer or BadRequest (a malformed endpoint)."""
    try:
        session = zenoh.open(network.as_config())
    except zenoh.ZError as error:
        where = ", ".join((*network.listen, *network.connect))
        if not network.listen and any(said in str(error) for said in _NOT_REACHED):
            raise errors.NoAnswer(f"no system answers at {where}; start one with: semmap up") from None
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
