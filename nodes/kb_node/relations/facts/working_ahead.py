"""Works out where everything will be: `python -m semmap.nodes.kb_node.relations.facts.working_ahead`.

What is foreseen comes on stdin, and the facts go to stdout.
"""

from __future__ import annotations

import gc
import sys

from semmap.nodes.kb_node.relations.facts.foreseen import Foreseen, WorkedOut, mark_of
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.schemas import codec


def worked_out(foreseen: Foreseen) -> WorkedOut:
    """What holds when those have come who are foreseen. Raises ValueError or IndexError for a bad number."""
    coming = list(foreseen.coming.placed())
    facts = Facts(foreseen.limits)
    facts.update([*foreseen.there, *coming])
    return WorkedOut(mark_of(coming), facts.by_rule())


def main() -> None:
    """From stdin to stdout."""
    gc.disable()  # nearly all that is made stays to the end
    foreseen: Foreseen = codec.decode(sys.stdin.buffer.read(), Foreseen)
    try:
        found = worked_out(foreseen)
    except (ValueError, IndexError) as error:
        raise SystemExit(f"a pose or size that is foreseen makes no sense: {error}") from None
    sys.stdout.buffer.write(codec.encode(found))


if __name__ == "__main__":
    main()
