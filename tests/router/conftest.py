"""A router that listens, with a session for somebody of each role."""

from __future__ import annotations

import contextlib
import threading

import pytest

from nodes import bus
from nodes.identity import Identity, authority
from nodes.identity.register import Register
from nodes.router.access import access_control
from schemas.roles import ROLES
from tests.conftest import free_endpoint


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """Keys: for each role somebody who is called like it."""
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
    """Where a router listens."""
    endpoint = bus.over_tls(free_endpoint())
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
    """One of each role, and one of a node that serves."""
    with contextlib.ExitStack() as stack:
        yield {
            name: opened(stack, endpoint, Identity.read(folder / name))
            for name in (*ROLES, "kb_node", "coordinator", "sim_node", "perception_node")
        }


@pytest.fixture
def heard():
    """What came, and a wait for it."""
    return Heard()


class Heard:
    """Keys that came to somebody."""

    def __init__(self):
        self.keys = []
        self._came = threading.Event()

    def __call__(self, sample):
        self.keys.append(str(sample.key_expr))
        self._came.set()

    def anything(self, within_s):
        return self._came.wait(within_s)
