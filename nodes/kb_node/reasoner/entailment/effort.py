"""How much is tried for a proof, and what it looked at on the way."""

from __future__ import annotations

import time
from collections.abc import Iterable
from math import inf

from semmap.nodes.kb_node.reasoner.explanations import Triple
from semmap.nodes.kb_node.reasoner.reasoner import Reasoner

_MOST = 1000
"""Suppositions in one proof."""


class Effort:
    """Bounds a search for a proof; one that is `traced` also keeps what the proof may rest on.

    Its seconds are of this thread's clock, so that what is found does not depend on who else is at work.
    """

    def __init__(
        self, patience_s: float = inf, *, traced: bool = False, allow_recompute: bool = True
    ) -> None:
        """Unless `anew`, nothing is supposed for which everything would have to be worked out anew."""
        self.allow_recompute = allow_recompute
        self._until_s = time.thread_time() + patience_s
        self._left = _MOST
        self._seen: dict[Triple, None] | None = {} if traced else None

    def reset(self) -> None:
        """Another proof is looked for, with as many suppositions again."""
        self._left = _MOST

    @property
    def is_traced(self) -> bool:
        """Whether it keeps what it looks at."""
        return self._seen is not None

    @property
    def is_over(self) -> bool:
        """Whether the time is up."""
        return time.thread_time() >= self._until_s

    def may_assume(self) -> bool:
        """Whether one more supposition is allowed."""
        self._left -= 1
        return self._left >= 0 and not self.is_over

    def note(self, triples: Iterable[Triple]) -> None:
        """Asserted triples that a proof may rest on."""
        if self._seen is not None:
            self._seen.update(dict.fromkeys(triples))

    def note_conclusion(self, reasoner: Reasoner, triple: Triple) -> None:
        """A conclusion of the rules that a proof may rest on."""
        if self._seen is not None and (found := reasoner.explain(triple)) is not None:
            self.note(found.support)

    @property
    def seen(self) -> list[Triple]:
        """All that was noted, in that order; nothing unless it is traced."""
        return list(self._seen or ())
