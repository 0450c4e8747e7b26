"""Which system a client means, and the way to it."""

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
    robot_name,
)

_START_S = 15.0
"""Seconds: a system that is starting is waited for."""
_ANEW_S = 1.0
"""Seconds: a router that begins anew is back before."""
_AGAIN_S = 0.1


def endpoint(namespace: str | None = None) -> str:
    """The system that is meant when nothing else is said.

    That is `SEMMAP_CONNECT`; or the one that this user runs for the robot `namespace`; or the one at the
    usual endpoint; or the only one that this user runs on this machine. Raises BadRequest when it could be
    any of several.
    """
    if said := os.environ.get(CONNECT_VARIABLE):
        return said
    running = registry.systems()
    of_robot = [system for system in running if system.namespace == namespace]
    if namespace and of_robot:
        return of_robot[0].reachable
    if not running or any(system.reachable == bus.DEFAULT_ENDPOINT for system in running):
        return bus.DEFAULT_ENDPOINT
    if len(running) > 1:
        which = ", ".join(f"{system.reachable} ({system.data})" for system in running)
        raise errors.BadRequest(
            f"{len(running)} systems are running; choose one with --connect or {CONNECT_VARIABLE}: {which}"
        )
    return running[0].reachable


def namespace(said: str | None, where: str | None = None) -> str:
    """The robot that is meant: `said`, or what `SEMMAP_NAMESPACE` says, or that of the system at `where`.

    The latter is known of the systems that this user runs on this machine. Raises BadRequest for a word that
    no robot can be called.
    """
    if said is None:
        said = os.environ.get(NAMESPACE_VARIABLE) or None
    if said is None and where is not None:
        said = next((s.namespace for s in registry.systems() if where in (s.reachable, s.listen)), None)
    return robot_name(said or "")


def identity(path: str | None) -> Identity | None:
    """Who the client is: `DIR/NAME`, or else what `SEMMAP_IDENTITY` says; None without. Raises BadFile."""
    path = path or os.environ.get(IDENTITY_VARIABLE)
    return Identity.read(path) if path else None


@contextlib.contextmanager
def open_session(
    where: str,
    namespace: str,
    identity: Identity | None = None,
    *,
    mode: Literal["peer", "client"] | None = None,
) -> Iterator[bus.Session]:
    """A session with whoever listens at `where`, or will do so when the system has started.

    On the system's own machine it is a peer, unless `mode` says otherwise: what the knowledge base answers
    itself comes straight from it. With an identity it is a client of the router, and the endpoint one of TLS.
    Raises NoAnswer when nothing answers there, the system takes too long to start, or it wants to know who
    this is.
    """
    own_config = os.environ.get(CONFIG_VARIABLE) or None
    if identity is not None:
        identity.require_valid()
        where = bus.to_tls(where)
        bus.require_tls(where)
    elif where.startswith(bus.TLS) and not own_config:
        raise errors.NoAnswer(
            f"the system at {where} only answers those who show a certificate; say who you are:"
            f" --identity DIR/NAME or {IDENTITY_VARIABLE}"
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
                turned_away = isinstance(error, bus.ConnectionClosed) or (
                    identity is not None
                    and time.monotonic() > deadline_s - _START_S + _ANEW_S
                    and presence.is_listening(where)
                )
                if turned_away or not presence.is_announced(where):
                    raise
                if time.monotonic() > deadline_s:
                    raise errors.NoAnswer(f"the system at {where} has not started yet") from None
                time.sleep(_AGAIN_S)
        yield session
