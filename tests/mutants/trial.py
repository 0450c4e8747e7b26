"""Runs the tests of mutants in copies of the checkout, which itself is not changed."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from tests.mutants.mirror import OwnTests
from tests.mutants.sample import Mutant

KILLED, SURVIVED, TIMEOUT, NO_TEST, BROKEN = "killed", "survived", "timeout", "no test", "broken"
"""The outcome of a mutant. `BROKEN`: its tests also fail without it."""

_PURE = "not long and not process"
_NONE_COLLECTED = 5
_LONGEST_S = 600.0
_SLOWER = 10.0
"""How many times longer than without the change the tests may take, before they count as hanging."""
_SHORTEST_S = 60.0


class Copy:
    """A copy of the checkout, in which tests of changed modules run one after the other."""

    def __init__(self, root: Path, folder: Path) -> None:
        self._root = folder
        shutil.rmtree(folder, ignore_errors=True)
        for path in _files(root):
            target = folder / path
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(root / path, target, follow_symlinks=False)  # `semmap/nodes` is a link
        data = os.environ.get("SEMMAP_DATA") or root.parent / "shared" / "data"
        self._environment = {**os.environ, "PYTHONPATH": str(folder), "SEMMAP_DATA": str(data)}
        self._baselines: dict[tuple[str, ...], tuple[str, float, tuple[str, ...]]] = {}

    def try_mutant(self, mutant: Mutant, tests: OwnTests) -> str:
        """Return what came of a mutant: one of the outcomes."""
        come = NO_TEST
        for files in tests.groups:
            outcome, seconds, words = self._baseline(files, tests.is_mirrored and files == tests.files)
            if outcome == SURVIVED:
                with self._changed(mutant):
                    outcome = _OUTCOMES.get(self._run(words, max(_SHORTEST_S, _SLOWER * seconds)), KILLED)
            if outcome not in (SURVIVED, NO_TEST):
                return outcome
            come = SURVIVED if SURVIVED in (come, outcome) else NO_TEST
        return come

    def _baseline(self, files: tuple[str, ...], is_mirrored: bool) -> tuple[str, float, tuple[str, ...]]:
        """What comes of the unchanged code, how long it takes, and with which words for pytest.

        Tests on the wire are left out, unless a module's own are nothing but that.
        """
        if files in self._baselines:
            return self._baselines[files]
        for marks in (_PURE, "not long") if is_mirrored else (_PURE,):
            words = ("-m", marks, *files)
            began_s = time.monotonic()
            status = self._run(words, _LONGEST_S)
            if status != _NONE_COLLECTED:
                break
        outcome = {0: SURVIVED, _NONE_COLLECTED: NO_TEST}.get(status or 0, BROKEN)
        outcome = BROKEN if status is None else outcome
        self._baselines[files] = outcome, time.monotonic() - began_s, words
        return self._baselines[files]

    @contextlib.contextmanager
    def _changed(self, mutant: Mutant) -> Iterator[None]:
        module = self._root / mutant.path
        original = module.read_text()
        try:
            self._write(module, mutant.code)
            yield
        finally:
            self._write(module, original)

    @staticmethod
    def _write(module: Path, code: str) -> None:
        """Write a module; what was compiled goes, for it can look newer than what is written."""
        module.write_text(code)
        for compiled in (module.parent / "__pycache__").glob(f"{module.stem}.*.pyc"):
            compiled.unlink()

    def _run(self, words: tuple[str, ...], timeout_s: float) -> int | None:
        """Pytest's exit status for these words; None if it did not end in time.

        All the processes that it has started end with it.
        """
        command = [
            *("nice", "-n", "10", sys.executable, "-m", "pytest", "-x", "-q", "--tb=no", "--no-header"),
            *("-p", "no:xdist", "-p", "no:cacheprovider", *words),
        ]
        process = subprocess.Popen(
            command,
            cwd=self._root,
            env=self._environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        try:
            return process.wait(timeout_s)
        except subprocess.TimeoutExpired:
            return None
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


_OUTCOMES: dict[int | None, str] = {0: SURVIVED, None: TIMEOUT}


def _files(root: Path) -> list[str]:
    """Return the files that git tracks or would add, from the root of the checkout."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=root,
        check=True,
        capture_output=True,
        text=True,
    ).stdout.split("\0")
    return [path for path in listed if path and ((root / path).is_file() or (root / path).is_symlink())]
