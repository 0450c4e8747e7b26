"""Statements that semmap stores but does not evaluate: unsupported SWRL rules, and SHACL shapes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Final

from semmap.nodes.kb_node.reasoner.rules import swrl
from semmap.ontology import vocabulary as v
from semmap.schemas import wording
from semmap.schemas.explanations import Triple

SWRL: Final = "http://www.w3.org/2003/11/swrl#"
SHACL: Final = "http://www.w3.org/ns/shacl#"
_SHACL_SHAPE, _SHACL_RULE = "SHACL shape", "SHACL rule"
_CLASSES: Final = {
    v.iri(f"{SHACL}NodeShape"): _SHACL_SHAPE,
    v.iri(f"{SHACL}PropertyShape"): _SHACL_SHAPE,
}
_OF_SHAPES: Final = frozenset(
    v.iri(SHACL + name)
    for name in ("property", "targetClass", "targetNode", "targetSubjectsOf", "targetObjectsOf")
)
"""Properties of shapes, which need no type."""
_RULE: Final = v.iri(f"{SHACL}rule")


def count_inert(triples: Iterable[Triple]) -> Counter[str]:
    """Return the number of statements without effect, by kind."""
    triples = list(triples)
    unsupported = swrl.read_triples(triples).unsupported
    found = {(f"SWRL rule ({reason})", node) for node, reason in unsupported.items()}
    for s, p, o in triples:
        if p == v.RDF_TYPE:
            if (kind := _CLASSES.get(o)) is not None:
                found.add((kind, s))
        elif p in _OF_SHAPES:
            found.add((_SHACL_SHAPE, s))
        elif p == _RULE:
            found.add((_SHACL_RULE, o))
    return Counter(kind for kind, _ in found)


def inert_note(kinds: Counter[str]) -> str:
    """Return a note on statements without effect, by kind, or ""."""
    counts = []
    for kind, count in sorted(kinds.items()):
        noun, blank, reason = kind.partition(" (")
        counts.append(wording.counted(count, noun) + blank + reason)
    return f"stored, but not evaluated: {', '.join(counts)}" if counts else ""
