"""Where everything will be after a large commit, worked out by a process while the reasoner takes that in."""

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
    """A process that works out what holds when those have come who are foreseen."""

    def __init__(
        self, foreseen: PrecomputeRequest, progress: Callable[[], None], command: Sequence[str] = _COMMAND
    ) -> None:
        """`progress` is called now and then while it is waited for. Raises OSError when it does not start."""
        self._progress = progress
        with ExitStack() as opened, TemporaryFile() as said:
            said.write(codec.encode(foreseen))
            said.seek(0)
            self._found = opened.enter_context(TemporaryFile())
            self._process = subprocess.Popen(command, stdin=said, stdout=self._found)
            opened.pop_all()

    def facts(self, came: Iterable[Entity | PlacedEntity]) -> Sequence[FactsByName] | None:
        """What holds now that these have come, rule by rule; None if that was not foreseen, or not done."""
        while self._process.poll() is None:
            self._progress()
            try:
                self._process.wait(_STEP_S)
            except subprocess.TimeoutExpired:
                continue
        with self._found:
            if self._process.returncode:
                log.warning("working out ahead where things are ended with %d", self._process.returncode)
                return None
            self._found.seek(0)
            found: PrecomputeResult = codec.decode(self._found.read(), PrecomputeResult)
        return found.match(came)

    def discard(self) -> None:
        """Nobody wants it any more."""
        self._process.kill()
        self._process.wait()
        self._found.close()
