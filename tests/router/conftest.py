"""A router, and a session for a client of each role."""

from __future__ import annotations

import contextlib
import secrets

import pytest
import zenoh

from semmap.nodes import bus
from semmap.nodes.identity import Identity, authority
from semmap.nodes.identity.register import Register
from semmap.nodes.router.access import access_control
from semmap.schemas.role_names import ROLES
from tests.conftest import free_endpoint, until


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """Keys: for each role a member with the same name."""
    folder = tmp_path_factory.mktemp("keys") / "K"
    authority.init(folder)
    for role in ROLES:
        authority.add(folder, role, role)
    return folder


def router_network(folder, endpoint):
    access = access_control(Register.read(folder).admitted)
    return bus.Network(
        mode="router",
        listen=(endpoint,),
        connect=(),
        identity=Identity.read(folder / "router"),
        access=access,
    )


@pytest.fixture(scope="session")
def endpoint(folder):
    """The endpoint of a router."""
    endpoint = bus.to_tls(free_endpoint())
    with bus.open_session(router_network(folder, endpoint)):
        yield endpoint


def opened(stack, endpoint, identity, **options):
    """A session with the router."""
    options.setdefault("patience_s", 5.0)
    return stack.enter_context(
        bus.open_session(bus.Network(connect=(endpoint,), identity=identity, **options))
    )


@pytest.fixture(scope="session")
def sessions(folder, endpoint):
    """Sessions of each role, and of a node that serves."""
    with contextlib.ExitStack() as stack:
        yield {
            name: opened(stack, endpoint, Identity.read(folder / name))
            for name in (*ROLES, "kb_node", "coordinator", "sim_node", "perception_node")
        }


class Heard:
    """Messages with the mark of this test that a session has received; earlier ones may still arrive."""

    def __init__(self, session, *key_exprs):
        self._mark = secrets.token_bytes(8)
        self.keys = []
        """The keys in the order of arrival."""
        # on Zenoh's own thread: otherwise the order of subscribers differs
        callback = zenoh.handlers.Callback(self._hear, indirect=False)
        self._subscribers = [session.declare_subscriber(key_expr, callback) for key_expr in key_exprs]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for subscriber in self._subscribers:
            subscriber.undeclare()

    def _hear(self, sample):
        if sample.payload.to_bytes() == self._mark:
            self.keys.append(str(sample.key_expr))

    def hears(self, session, *keys):
        """Publish on all keys repeatedly until the message on the last has arrived."""

        def heard():
            for key in keys:
                session.put(key, self._mark, congestion_control=zenoh.CongestionControl.BLOCK)
            return keys[-1] in self.keys

        until(heard, f"{keys[-1]} comes")
