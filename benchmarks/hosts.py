"""The traffic between two hosts and the cost of each further hop, in network namespaces.

`unshare -rn python -m benchmarks.hosts`: a system on three hosts in a row, the knowledge base on the first.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from typing import NamedTuple

from semmap.nodes.extern.client import Client, connect
from tests.faults.cut_hosts import spread_out
from tests.faults.ground import free_place
from tests.faults.hosts import Host, Link, Network

_ROUNDS = 5
_EACH = 40
_QUIET_S = 5.0
PARTS = {"lab": "kb,coordinator", "robot": "sim", "desk": "recorder"}


class Took(NamedTuple):
    """The median duration of a look-up and of an add [ms]."""

    get_ms: float
    add_ms: float


def measured(endpoint: str, count: int) -> Took:
    """Measure look-ups and adds from this host, one after another."""
    with connect(endpoint) as client:
        name = client.add("Cup", at=(0.0, 0.0, 0.0)).names[0]
        gets = [_took_ms(lambda: client.get(name)) for _ in range(count)]
        adds = [_took_ms(lambda: _add(client)) for _ in range(count)]
    return Took(statistics.median(gets), statistics.median(adds))


def add(endpoint: str, count: int) -> None:
    """Add cups without pauses."""
    with connect(endpoint) as client:
        for _ in range(count):
            _add(client)


def _add(client: Client) -> None:
    client.add("Cup", at=free_place())


def _took_ms(function: Callable[[], object]) -> float:
    began_s = time.perf_counter()
    function()
    return (time.perf_counter() - began_s) * 1e3


def _crossed(link: Link, seconds: float) -> tuple[float, float]:
    """Return the bytes per second that each end sends while idle."""
    before = link.sent()
    time.sleep(seconds)
    after = link.sent()
    return (after[0] - before[0]) / seconds, (after[1] - before[1]) / seconds


def _hops(hosts: list[Host], endpoint: str) -> None:
    """Measure in turn, so that other load affects all of them equally."""
    took: dict[str, list[Took]] = {host.name: [] for host in hosts}
    for _ in range(_ROUNDS):
        for host in hosts:
            took[host.name].append(host.do(measured, endpoint, _EACH))
    for routers, (name, each) in enumerate(took.items(), start=1):
        get_ms = statistics.median(one.get_ms for one in each)
        add_ms = statistics.median(one.add_ms for one in each)
        print(f"from {name}, over {routers} routers: get {get_ms:.2f} ms, add {add_ms:.2f} ms")


def _bytes(system: Host, link: Link, endpoint: str) -> None:
    quiet = _crossed(link, _QUIET_S)
    print(f"nothing asked: {quiet[0] / 1000:.1f} kB/s out, {quiet[1] / 1000:.1f} kB/s in, of {link.device}")
    before, began_s = link.sent(), time.monotonic()
    system.do(add, endpoint, 200)
    time.sleep(1.0)
    seconds, after = time.monotonic() - began_s, link.sent()
    out, back = (
        (now - was - rate * seconds) / 200 / 1000 for now, was, rate in zip(after, before, quiet, strict=True)
    )
    print(f"each add asked for at the knowledge base: {out:.1f} kB out, {back:.1f} kB back, of {link.device}")


def main() -> None:
    """Print the measurements."""
    for secure in (False, True):
        print("with certificates" if secure else "without certificates")
        with Network() as network, spread_out(network, PARTS, secure=secure) as system:
            for link in reversed(system.links):
                _bytes(system.hosts[0], link, system.here)
            _hops(system.hosts, system.here)


if __name__ == "__main__":
    main()
