"""A process that computes the facts after a large commit while the reasoner processes that commit."""

from __future__ import annotations

import logging
import subprocess
import sys
from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from tempfile import TemporaryFile
from typing import Final

from semmap.nodes.kb_node.relations.facts.precompute_messages import (
    FactsByName,
    PrecomputeRequest,
    PrecomputeResult,
)
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.schemas import codec
from semmap.schemas.entities import Entity

_COMMAND: Final = (sys.executable, "-P", "-m", "semmap.nodes.kb_node.relations.facts.precompute")
_STEP_S: Final = 0.05

log = logging.getLogger(__name__)


class Precomputation:
    """A process that computes the facts that will hold after the expected entities are added."""

    def __init__(
        self, message: PrecomputeRequest, progress: Callable[[], None], command: Sequence[str] = _COMMAND
    ) -> None:
        """Start the process.

        Raises OSError if it does not start. `progress` is called while waiting for it.
        """
        self._progress = progress
        with ExitStack() as opened, TemporaryFile() as request:
            request.write(codec.encode(message))
            request.seek(0)
            self._found = opened.enter_context(TemporaryFile())
            self._process = subprocess.Popen(command, stdin=request, stdout=self._found)
            opened.pop_all()

    def facts(self, added: Iterable[Entity | PlacedEntity]) -> Sequence[FactsByName] | None:
        """Return the facts by rule after these entities were added.

        None if other entities were expected, or the process failed.
        """
        while self._process.poll() is None:
            self._progress()
            try:
                self._process.wait(_STEP_S)
            except subprocess.TimeoutExpired:
                continue
        with self._found:
            if self._process.returncode:
                log.warning(
                    "the process that precomputes facts failed with exit status %d", self._process.returncode
                )
                return None
            self._found.seek(0)
            found: PrecomputeResult = codec.decode(self._found.read(), PrecomputeResult)
        return found.match(added)

    def discard(self) -> None:
        """Stop the process and drop its result."""
        self._process.kill()
        self._process.wait()
        self._found.close()
