"""The limits of a search for a proof, and its trace."""

from __future__ import annotations

import time
from collections.abc import Iterable
from math import inf

from semmap.nodes.kb_node.reasoner.explanations import Triple
from semmap.nodes.kb_node.reasoner.reasoner import Reasoner

_MOST = 1000
"""Maximum number of assumptions in one proof."""


class Effort:
    """Limits a search for a proof. If `traced`, it also records the facts that the proof may depend on.

    Time is the CPU time of this thread, so that results do not depend on the load of the machine.
    """

    def __init__(
        self, patience_s: float = inf, *, traced: bool = False, allow_recompute: bool = True
    ) -> None:
        """Without `allow_recompute`, assumptions that would recompute everything are not tried."""
        self.allow_recompute = allow_recompute
        self._until_s = time.thread_time() + patience_s
        self._left = _MOST
        self._seen: dict[Triple, None] | None = {} if traced else None

    def reset(self) -> None:
        """Reset the number of assumptions for another proof."""
        self._left = _MOST

    @property
    def is_traced(self) -> bool:
        """Whether facts are recorded."""
        return self._seen is not None

    @property
    def is_over(self) -> bool:
        """Whether the time limit is reached."""
        return time.thread_time() >= self._until_s

    def may_assume(self) -> bool:
        """Count one more assumption and return whether it is allowed."""
        self._left -= 1
        return self._left >= 0 and not self.is_over

    def note(self, triples: Iterable[Triple]) -> None:
        """Record asserted triples that a proof may depend on."""
        if self._seen is not None:
            self._seen.update(dict.fromkeys(triples))

    def note_conclusion(self, reasoner: Reasoner, triple: Triple) -> None:
        """Record the support of a conclusion that a proof may depend on."""
        if self._seen is not None and (found := reasoner.explain(triple)) is not None:
            self.note(found.support)

    @property
    def seen(self) -> list[Triple]:
        """All recorded triples in order; empty if not traced."""
        return list(self._seen or ())
