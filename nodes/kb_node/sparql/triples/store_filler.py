"""Fills a store on disk in a separate process, which a thread supplies with triples."""

from __future__ import annotations

import shutil
import subprocess
import sys
import threading
from collections.abc import Iterable, Sequence
from concurrent.futures import Future
from contextlib import suppress
from pathlib import Path

from semmap.nodes.kb_node.sparql.triples.bulk_load import END, PACKED, frame
from semmap.schemas import errors
from semmap.schemas.explanations import Triple
from semmap.schemas.packing import is_packed


class StoreFiller:
    """Fills a new store at `path`. After an error the store is deleted."""

    def __init__(
        self, path: Path, pieces: Iterable[Sequence[Triple]], turtle: bytes = b"", *, base: str = ""
    ) -> None:
        """Start the thread, which iterates over `pieces` and then sends `turtle` with that base IRI.

        `turtle` may be compressed, which takes less memory until the process has read it.
        """
        self.path = path
        self._turtle = turtle
        self._base = base
        self.outcome: Future[tuple[int, int]] = Future()
        """The number of triples sent in pieces and the number in the store, or Refused."""
        self._process: subprocess.Popen[bytes] | None = None
        self._is_wanted = True
        threading.Thread(target=self._run, args=(pieces,), name="sparql-filling", daemon=True).start()

    def abort(self) -> None:
        """Stop and delete the store."""
        self._is_wanted = False
        if self._process is not None:
            with suppress(OSError):
                self._process.kill()
        self.outcome.add_done_callback(lambda _: shutil.rmtree(self.path, ignore_errors=True))

    def _run(self, pieces: Iterable[Sequence[Triple]]) -> None:
        try:
            counts = self._pump(pieces)
        except (OSError, ValueError) as error:
            shutil.rmtree(self.path, ignore_errors=True)
            refusal = errors.Refused(f"the SPARQL store could not be created: {error}")
            self.outcome.set_exception(refusal)
        else:
            self.outcome.set_result(counts)

    def _pump(self, pieces: Iterable[Sequence[Triple]]) -> tuple[int, int]:
        command = [
            sys.executable,
            "-P",
            "-m",
            "semmap.nodes.kb_node.sparql.triples.bulk_load",
            str(self.path),
        ]
        if self._turtle:
            command += [self._base, PACKED] if is_packed(self._turtle) else [self._base]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
            self._process = process
            if process.stdin is None:
                raise errors.InternalError("the input of the filling process is not a pipe")
            if process.stdout is None:
                raise errors.InternalError("the output of the filling process is not a pipe")
            sent = 0
            for piece in pieces:
                if not self._is_wanted:
                    raise ValueError("the store is no longer needed")
                process.stdin.write(frame(piece))
                sent += len(piece)
            if self._turtle:
                process.stdin.write(END)
                process.stdin.write(self._turtle)
                self._turtle = b""
            process.stdin.close()
            return sent, int(process.stdout.read())
