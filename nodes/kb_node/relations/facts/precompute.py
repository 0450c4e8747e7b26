"""Works out where everything will be: `python -m semmap.nodes.kb_node.relations.facts.precompute`.

What is foreseen comes on stdin, and the facts go to stdout.
"""

from __future__ import annotations

import gc
import sys

from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.facts.precompute_messages import (
    PrecomputeRequest,
    PrecomputeResult,
    compute_digest,
)
from semmap.schemas import codec


def compute_facts(foreseen: PrecomputeRequest) -> PrecomputeResult:
    """What holds when those have come who are foreseen. Raises ValueError or IndexError for a bad number."""
    coming = list(foreseen.coming.placed())
    facts = Facts(foreseen.limits)
    facts.update([*foreseen.there, *coming])
    return PrecomputeResult(compute_digest(coming), facts.by_rule())


def main() -> None:
    """From stdin to stdout."""
    gc.disable()  # nearly all that is made stays to the end
    foreseen: PrecomputeRequest = codec.decode(sys.stdin.buffer.read(), PrecomputeRequest)
    try:
        found = compute_facts(foreseen)
    except (ValueError, IndexError) as error:
        raise SystemExit(f"a pose or size that is foreseen makes no sense: {error}") from None
    sys.stdout.buffer.write(codec.encode(found))


if __name__ == "__main__":
    main()
