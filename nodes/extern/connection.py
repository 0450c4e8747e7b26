"""Selection of the system that a client connects to, and the session with it."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Iterator
from typing import Literal

from semmap.nodes import bus
from semmap.nodes.identity import Identity
from semmap.nodes.supervisor import presence, registry
from semmap.schemas import errors
from semmap.schemas.endpoints import (
    CONFIG_VARIABLE,
    CONNECT_VARIABLE,
    IDENTITY_VARIABLE,
    NAMESPACE_VARIABLE,
    parse_endpoint,
    robot_name,
)
from semmap.schemas.wording import few

_START_S = 15.0
"""Timeout for a system that is starting [s]."""
_ROUTER_RESTART_S = 1.0
"""Time within which a restarted router accepts connections again [s]."""
_RETRY_S = 0.1


def endpoint(namespace: str | None = None) -> str:
    """Return the default endpoint. Raises BadRequest if several systems are possible.

    It is the first of these that exists:

    - `SEMMAP_CONNECT`
    - the system that this user runs for the robot `namespace`
    - the system at the default endpoint
    - the only system that this user runs on this machine
    """
    if configured := os.environ.get(CONNECT_VARIABLE):
        return parse_endpoint(configured)
    running = registry.systems()
    of_robot = [system for system in running if system.namespace == namespace]
    if namespace and of_robot:
        return of_robot[0].reachable
    if not running or any(system.reachable == bus.DEFAULT_ENDPOINT for system in running):
        return bus.DEFAULT_ENDPOINT
    if len(running) > 1:
        found = few([f"{system.reachable} ({system.data})" for system in running], 5)
        raise errors.BadRequest(
            f"{len(running)} systems are running; choose one with --connect or {CONNECT_VARIABLE}: {found}"
        )
    return running[0].reachable


def resolve_endpoint(where: str | None, namespace: str | None) -> str:
    """Return the endpoint `where`, or the default one; see `endpoint`. Raises BadRequest if it is invalid."""
    return endpoint(namespace) if where is None else parse_endpoint(where)


def namespace(name: str | None, where: str | None = None) -> str:
    """Return the name of the robot: `name`, or `SEMMAP_NAMESPACE`, or that of the local system at `where`.

    Raises BadRequest for an invalid name.
    """
    if name is None:
        name = os.environ.get(NAMESPACE_VARIABLE) or None
    if name is None and where is not None:
        name = next((s.namespace for s in registry.systems() if where in (s.reachable, s.listen)), None)
    return robot_name(name or "")


def identity(path: str | None) -> Identity | None:
    """Return the identity in `path` (`DIR/NAME`) or `SEMMAP_IDENTITY`, or None. Raises BadFile."""
    path = path or os.environ.get(IDENTITY_VARIABLE)
    return Identity.read(str(path)) if path else None


@contextlib.contextmanager
def open_session(
    where: str,
    namespace: str,
    identity: Identity | None = None,
    *,
    mode: Literal["peer", "client"] | None = None,
) -> Iterator[bus.Session]:
    """Open a session with the system at `where`. A system that is starting is waited for.

    Without `mode`, the session is a peer on the machine of the system, so that replies of the knowledge base
    arrive directly. With an identity it is a client of the router, over TLS. Raises NoAnswer if the system
    does not respond, takes too long to start, or requires a certificate, and BadRequest for another `mode`.
    """
    if mode not in (None, "peer", "client"):
        raise errors.BadRequest(f"'{mode}' is not a mode of a session; use peer or client")
    own_config = os.environ.get(CONFIG_VARIABLE) or None
    if identity is not None:
        identity.require_valid()
        where = bus.to_tls(where)
        bus.require_tls(where)
    elif where.startswith(bus.TLS) and not own_config:
        raise bus.ConnectionClosed(
            f"the system at {where} requires a client certificate; add --identity DIR/NAME or set"
            f" {IDENTITY_VARIABLE}"
        )
    here = presence.is_loopback(where)
    network = bus.Network(
        connect=(where,),
        mode=mode or ("peer" if here and identity is None else "client"),
        namespace=namespace,
        patience_s=0.0 if here else bus.PATIENCE_S,
        identity=identity,
        own_config=own_config,
    )
    deadline_s = time.monotonic() + _START_S
    with contextlib.ExitStack() as stack:
        while True:
            try:
                session = stack.enter_context(bus.open_session(network))
                break
            except errors.NoAnswer as error:
                is_rejected = isinstance(error, bus.ConnectionClosed) or (
                    identity is not None
                    and time.monotonic() > deadline_s - _START_S + _ROUTER_RESTART_S
                    and presence.is_listening(where)
                )
                if is_rejected or not presence.is_announced(where):
                    raise
                if time.monotonic() > deadline_s:
                    raise errors.NoAnswer(f"the system at {where} has not started yet") from None
                time.sleep(_RETRY_S)
        yield session
