"""Program that computes facts: `python -m semmap.nodes.kb_node.relations.facts.precompute`.

It reads a `PrecomputeRequest` from stdin and writes a `PrecomputeResult` to stdout.
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
from semmap.ontology.model_shapes import add_shapes
from semmap.schemas import codec


def compute_facts(request: PrecomputeRequest) -> PrecomputeResult:
    """Return the facts after the expected entities are added.

    Raises ValueError or IndexError for a bad number.
    """
    coming = list(request.coming.placed())
    facts = Facts(request.limits)
    facts.update([*request.there, *coming])
    return PrecomputeResult(compute_digest(coming), facts.by_rule())


def main() -> None:
    """Answer the request on stdin."""
    gc.disable()  # almost all objects live until the end
    request: PrecomputeRequest = codec.decode(sys.stdin.buffer.read(), PrecomputeRequest)
    add_shapes(request.shapes)
    try:
        found = compute_facts(request)
    except (ValueError, IndexError) as error:
        raise SystemExit(f"invalid pose or size of an expected entity: {error}") from None
    sys.stdout.buffer.write(codec.encode(found))


if __name__ == "__main__":
    main()
