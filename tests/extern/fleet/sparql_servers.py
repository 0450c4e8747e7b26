"""Real SPARQL servers for tests: Oxigraph's own, and Virtuoso where it is installed."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pyoxigraph

from semmap.nodes.extern.fleet import facts as f
from semmap.nodes.extern.fleet.server import SparqlServer
from semmap.nodes.supervisor.ports import free_endpoint
from tests.conftest import PATIENCE_S

Graph = frozenset[tuple[str, str, str]]


class Oxigraph:
    """`oxigraph serve` on a folder and a port; it can be killed and started again."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.port = int(free_endpoint().rpartition(":")[2])
        self.update_url = f"http://127.0.0.1:{self.port}/update"
        self.query_url = f"http://127.0.0.1:{self.port}/query"
        self.process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Returns when it answers."""
        binary = Path(sys.executable).with_name("oxigraph")
        bind = f"127.0.0.1:{self.port}"
        self.process = subprocess.Popen(
            [binary, "serve", "--location", self.folder, "--bind", bind],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        deadline_s = time.monotonic() + PATIENCE_S
        while True:
            with contextlib.suppress(OSError):
                urllib.request.urlopen(f"{self.query_url}?query=ASK%7B%7D", timeout=PATIENCE_S).close()
                return
            assert time.monotonic() < deadline_s, "oxigraph did not start"
            assert self.process.poll() is None, "oxigraph ended"
            time.sleep(0.02)

    def kill(self) -> None:
        """As by kill -9."""
        assert self.process is not None
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def graph(self, robot: str) -> Graph:
        """What is in a robot's graph, in the spelling of Oxigraph."""
        url = f"{self.query_url.removesuffix('query')}store?graph={f.graph(robot)[1:-1]}"
        request = urllib.request.Request(url, headers={"Accept": "application/n-triples"})
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE_S) as reply:
                return spelled(reply.read())
        except urllib.error.HTTPError as error:
            if error.code == 404:
                return frozenset()
            raise


class Virtuoso:
    """`virtuoso-t`, as Debian has it, on a folder and two ports. Its one endpoint is for all."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir()
        self.folder = folder
        sql, http = (free_endpoint().removeprefix("tcp/") for _ in range(2))
        self._sql = sql
        self.update_url = self.query_url = f"http://{http}/sparql"
        (folder / "virtuoso.ini").write_text(_VIRTUOSO_INI.format(folder=folder, sql=sql, http=http))
        self.process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Wait until it responds, and permit writing without a user."""
        ini = self.folder / "virtuoso.ini"
        self.process = subprocess.Popen(
            ["virtuoso-t", "-f", "+configfile", ini], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        grant = self.folder / "grant.sql"
        grant.write_text('GRANT SPARQL_UPDATE TO "SPARQL";\n')
        deadline_s = time.monotonic() + 2 * PATIENCE_S
        while True:
            command: list[str | Path] = ["isql-vt", self._sql, "dba", "dba", grant]
            done = subprocess.run(command, capture_output=True, text=True)
            said = done.stdout + done.stderr
            if ("Done." in said and "Error" not in said) or "already have role" in said:
                return
            assert time.monotonic() < deadline_s, f"virtuoso did not start: {said}"
            time.sleep(0.2)

    def kill(self) -> None:
        """As by kill -9."""
        assert self.process is not None
        self.process.kill()
        self.process.wait()
        (self.folder / "virtuoso.lck").unlink(missing_ok=True)

    def graph(self, robot: str) -> Graph:
        """What is in a robot's graph, in the spelling of Oxigraph."""
        server = SparqlServer(self.query_url)
        rows = server.query(f"SELECT ?s ?p ?o {{ GRAPH {f.graph(robot)} {{ ?s ?p ?o }} }}").rows
        server.close()
        return spelled("".join(f"{s} {p} {o} .\n" for s, p, o in rows).encode())


_VIRTUOSO_INI = """
[Database]
DatabaseFile = {folder}/virtuoso.db
ErrorLogFile = {folder}/virtuoso.log
LockFile = {folder}/virtuoso.lck
TransactionFile = {folder}/virtuoso.trx
xa_persistent_file = {folder}/virtuoso.pxa
[TempDatabase]
DatabaseFile = {folder}/temporary.db
TransactionFile = {folder}/temporary.trx
[Parameters]
ServerPort = {sql}
NumberOfBuffers = 10000
[HTTPServer]
ServerPort = {http}
ServerRoot = {folder}
[SPARQL]
ResultSetMaxRows = 1000000
"""


@contextlib.contextmanager
def virtuoso(folder: Path) -> Iterator[Virtuoso]:
    """A server that answers; killed at the end."""
    server = Virtuoso(folder)
    server.start()
    try:
        yield server
    finally:
        server.kill()


@contextlib.contextmanager
def oxigraph(folder: Path) -> Iterator[Oxigraph]:
    """A server that answers; killed at the end."""
    server = Oxigraph(folder)
    server.start()
    try:
        yield server
    finally:
        server.kill()


def spelled(ntriples: bytes) -> Graph:
    """A document as Oxigraph spells it: it keeps values of numbers, not how they were written."""
    store = pyoxigraph.Store()
    store.load(ntriples, format=pyoxigraph.RdfFormat.N_TRIPLES)
    return frozenset((str(q.subject), str(q.predicate), str(q.object)) for q in store)
