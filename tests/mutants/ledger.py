"""The outcomes of mutants in a file, so that an interrupted run can be continued."""

from __future__ import annotations

import hashlib
import json
import threading
from pathlib import Path

from tests.mutants.mirror import OwnTests
from tests.mutants.sample import Mutant


class Ledger:
    """A file with one line for each mutant that was tried.

    An outcome counts for as long as the module, the change and the files of its tests are the same.
    """

    def __init__(self, root: Path, path: Path) -> None:
        self._root, self._path = root, path
        self._lock = threading.Lock()
        path.parent.mkdir(parents=True, exist_ok=True)
        lines = path.read_text().splitlines() if path.exists() else []
        self._outcomes: dict[str, str] = dict(json.loads(line) for line in lines)

    def find(self, mutant: Mutant, tests: OwnTests) -> str | None:
        """Return the outcome of a mutant with these tests, or None if it was not tried."""
        return self._outcomes.get(self._key(mutant, tests))

    def note(self, mutant: Mutant, tests: OwnTests, outcome: str) -> None:
        """Store the outcome of a mutant."""
        with self._lock, self._path.open("a") as file:
            file.write(json.dumps([self._key(mutant, tests), outcome]) + "\n")

    def _key(self, mutant: Mutant, tests: OwnTests) -> str:
        digest = hashlib.sha256(f"{mutant.path}\0{mutant.code}".encode())
        for file in (file for group in tests.groups for file in group):
            digest.update((self._root / file).read_bytes())
        return digest.hexdigest()
