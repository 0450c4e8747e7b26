"""Statements that semmap stores but does not evaluate: unsupported SWRL rules, and parts of SHACL."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Final

from semmap.nodes.kb_node.reasoner.rules import swrl
from semmap.nodes.kb_node.shacl.shape_triples import find_unsupported
from semmap.schemas import wording
from semmap.schemas.explanations import Triple

SWRL: Final = "http://www.w3.org/2003/11/swrl#"


def count_inert(triples: Iterable[Triple]) -> Counter[str]:
    """Return the number of statements without effect, by kind."""
    triples = list(triples)
    unsupported = swrl.read_triples(triples).unsupported
    found = {(f"SWRL rule ({reason})", node) for node, reason in unsupported.items()}
    found |= find_unsupported(triples)
    return Counter(kind for kind, _ in found)


def inert_note(kinds: Counter[str]) -> str:
    """Return a note on statements without effect, by kind, or ""."""
    counts = []
    for kind, count in sorted(kinds.items()):
        noun, blank, reason = kind.partition(" (")
        counts.append(wording.counted(count, noun) + blank + reason)
    return f"stored, but not evaluated: {', '.join(counts)}" if counts else ""
