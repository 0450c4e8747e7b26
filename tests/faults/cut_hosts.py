"""Cuts each link between the hosts of a system under load, in its own namespaces: `unshare -rn`.

The knowledge base and the coordinator run on one host, the simulator and perception on a second. The recorder
runs on a third, which is linked only to the second. On each host a client adds cups and follows the map.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from itertools import count
from pathlib import Path

from semmap.nodes.identity import authority
from tests.faults import hosts, on_a_host
from tests.faults.hosts import HOWS, Host, How, Link, Network
from tests.faults.table import Row

_PORT = 7447
_EXAMPLES = Path(__file__).parents[2] / "examples"
_ZENOHD = "zenohd"
"""Instead of nodes: the host runs a plain Zenoh router."""
_PARTS = {"lab": "kb,coordinator", "robot": "sim,perception", "desk": "recorder"}
_SMALL_PARTS = {"lab": "kb,coordinator", "robot": "sim"}
_SITE_PARTS = {"lab": "kb,coordinator", "site": _ZENOHD, "robot": "sim,recorder"}
_WHOLE_S = 5.0
_PATIENCE_S = 900.0


@dataclass(frozen=True)
class Cuts:
    """Cuts of every link between the hosts of a system; each is a row of the table."""

    name: str
    seconds: float
    words: tuple[str, ...] = ()

    def rows(self) -> list[Row]:
        """Return the result of each cut."""
        if missing := hosts.missing():
            return [Row(self.name, skipped=missing)]
        module = [sys.executable, "-m", "tests.faults.cut_hosts", str(self.seconds)]
        # Into files, because child processes of a hanging run would keep pipes open.
        with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
            command: list[str | Path] = ["unshare", "-rn", *module, *self.words]
            process = subprocess.Popen(command, stdout=out, stderr=err, start_new_session=True)
            try:
                process.wait(timeout=_PATIENCE_S)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
            out.seek(0)
            err.seek(0)
            rows = [Row(**json.loads(line)) for line in out]
            if process.returncode != 0:
                why = err.read().strip().rpartition("\n")[2]
                rows.append(Row(self.name, failed=why or f"ended with status {process.returncode}"))
        return rows


CUTS = (
    Cuts("links between hosts cut", 15.0),
    Cuts("links between hosts cut, with certificates", 15.0, ("--secure",)),
    Cuts("links of a site with a router of Zenoh's own cut", 15.0, ("--site",)),
    Cuts("links of a site with a router of Zenoh's own cut, with certificates", 15.0, ("--site", "--secure")),
)


def main() -> None:
    """Print a row of the table of faults as JSON for each cut."""
    parser = argparse.ArgumentParser()
    parser.add_argument("seconds", type=float, help="how long each link is cut")
    parser.add_argument("--secure", action="store_true", help="with certificates")
    parser.add_argument("--small", action="store_true", help="two hosts, without perception and recorder")
    parser.add_argument("--site", action="store_true", help="a router of Zenoh's on the host in the middle")
    parser.add_argument("--how", choices=HOWS, nargs="+", default=HOWS)
    options = parser.parse_args()
    parts = _SMALL_PARTS if options.small else _SITE_PARTS if options.site else _PARTS
    with Network() as network, spread_out(network, parts, secure=options.secure) as system:
        for link in system.links:
            for how in options.how:
                print(json.dumps(asdict(system.cut(link, how, options.seconds))), flush=True)


@contextlib.contextmanager
def spread_out(network: Network, parts: dict[str, str], *, secure: bool) -> Iterator[SpreadOut]:
    """Run a system on several hosts, and stop it at the end."""
    system = SpreadOut(network, parts, secure=secure)
    try:
        system.start()
        yield system
    finally:
        for ended in [host.begin(on_a_host.end) for host in system.hosts]:
            ended.result()


class SpreadOut:
    """A system on hosts that are linked in a row, each running a part of it."""

    def __init__(self, network: Network, parts: dict[str, str], *, secure: bool) -> None:
        self.hosts = [network.host(name) for name in parts]
        self.links = [network.link(*pair) for pair in zip(self.hosts, self.hosts[1:], strict=False)]
        self._parts = parts
        self._scheme = "tls" if secure else "tcp"
        self.here = f"{self._scheme}/127.0.0.1:{_PORT}"
        """The endpoint of the router on each host."""
        self._loads = count(1)
        self._pids: dict[str, dict[str, int]] = {}

    def start(self) -> None:
        """Start the hosts, last one first, because it waits for the others."""
        upstream = {link.ends[1].name: link.addresses[0] for link in self.links}
        if self._scheme == "tls":
            self._hand_out_keys(tuple(upstream.values()))
        started = []
        for host in reversed(self.hosts):
            if self._parts[host.name] == _ZENOHD:
                host.do(on_a_host.route, self._configured(host, upstream[host.name]))
                continue
            words = ["--only", self._parts[host.name], "--abox", "none", "--world", "empty"]
            words += ["--camera-hz", "0"]
            if host.name in upstream:
                words += ["--connect", f"{self._scheme}/{upstream[host.name]}:{_PORT}"]
            words += ["--secure", str(host.folder / "keys")] if self._scheme == "tls" else ["--insecure"]
            listen = f"{self._scheme}/0.0.0.0:{_PORT}"
            started.append(host.begin(on_a_host.up, _data(host), listen, tuple(words)))
        for one in started:
            one.result()
        self._pids = self.pids()
        for host in self.hosts:
            host.do(on_a_host.watch, self.here)

    def _hand_out_keys(self, addresses: tuple[str, ...]) -> None:
        """Copy the folder of keys to each host, without the authority's own key."""
        home = self.hosts[0].folder.parent / "keys"
        authority.init(home, addresses)
        authority.add(home, "load", "operator")
        for host in self.hosts:
            copy = host.folder / "keys"
            copy.mkdir(mode=0o700)
            for file in home.iterdir():
                if file.name != "ca.key":
                    (copy / file.name).write_bytes(file.read_bytes())
            host.do(on_a_host.identify, str(copy / "load"))

    def _configured(self, host: Host, upstream: str) -> str:
        """Return the configuration of a plain Zenoh router, created as in the manual."""
        if self._scheme == "tcp":
            return (_EXAMPLES / "zenohd" / "site.json5").read_text().replace("10.0.0.1", upstream)
        words = ["keys", "zenohd", "--dir", host.folder / "keys", "--connect", f"tls/{upstream}:{_PORT}"]
        semmap = Path(sys.executable).with_name("semmap")
        return subprocess.run([semmap, *words], check=True, capture_output=True, text=True).stdout

    def pids(self) -> dict[str, dict[str, int]]:
        """Return the processes of the nodes, by host."""
        return {host.name: host.do(on_a_host.pids, _data(host)) for host in self.hosts}

    def cut(self, link: Link, how: How, seconds: float) -> Row:
        """Cut a link under load, restore it, and return the result after recovery."""
        for host in self.hosts:
            host.do(on_a_host.load, self.here, next(self._loads))
        self._until_whole()
        link.cut(how)
        time.sleep(seconds)
        link.mend(how)
        whole_s = self._until_whole()
        name = f"link between {link.ends[0].name} and {link.ends[1].name} {how} for {seconds:g} s"
        row = Row(f"{name}{', with certificates' if self._scheme == 'tls' else ''}", done=1, whole_s=whole_s)
        broken = list(self._count(row))
        if self.pids() != self._pids:
            broken.append("nodes were restarted")
        if whole_s > _WHOLE_S:
            broken.append(f"recovered only after {whole_s:.1f} s")
        row.failed = "; ".join(broken)
        return row

    def _until_whole(self) -> float:
        """Return the seconds until the system is complete as seen from every host."""
        nodes = {(node, host) for host, pids in self._pids.items() for node in pids}
        seen = [host.begin(on_a_host.seconds_until_whole, self.here, nodes) for host in self.hosts]
        return max(one.result() for one in seen)

    def _count(self, row: Row) -> Iterator[str]:
        """Stop the load, count lost and doubled changes in the row, and yield other violations."""
        ended = [host.do(on_a_host.stop_load) for host in self.hosts]
        if refused := [text for one in ended for text in one.refused]:
            yield f"refused: {refused[0]}"
        acknowledged = [name for one in ended for name in one.acknowledged]
        there, last = self.hosts[0].do(on_a_host.cups, self.here)
        unexplained = len(there) - len(set(acknowledged)) - sum(one.in_doubt for one in ended)
        row.lost = len(set(acknowledged) - there)
        row.doubled = len(acknowledged) - len(set(acknowledged)) + max(0, unexplained)
        for host in self.hosts:
            for seqs in host.do(on_a_host.followed, last):
                if seqs != list(range(seqs[0], last + 1)):
                    yield f"on {host.name} commits were missed or received twice"
        self.hosts[0].do(on_a_host.recorded, self.here, last)
        self.hosts[0].do(on_a_host.clear, self.here)


def _data(host: Host) -> str:
    return str(host.folder / "data")


if __name__ == "__main__":
    main()
