"""Matching of equivalent blank nodes between two readings."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.blank_nodes import relabel_like
from semmap.ontology import HOUSEHOLD_TTL

RESTRICTED = b"<urn:c> <urn:below> [ <urn:on> <urn:p> ; <urn:in> ( <urn:a> [ <urn:not> <urn:b> ] ) ] ."
TWINS = RESTRICTED + RESTRICTED.replace(b"urn:c>", b"urn:d>")
CYCLE = b"_:a <urn:next> _:b . _:b <urn:next> _:c . _:c <urn:next> _:a . _:b <urn:is> <urn:b> ."


def compared(before: bytes, after: bytes) -> tuple[int, int]:
    """Return the number of removed and of added triples."""
    known, new = (frozenset(rdf.parse(c, "f", label_prefix=p)) for c, p in ((before, "a"), (after, "b")))
    labelled = relabel_like(new, known)
    assert len(labelled) == len(new)
    return len(known - labelled), len(labelled - known)


@pytest.mark.parametrize("text", [RESTRICTED, TWINS, CYCLE, HOUSEHOLD_TTL.read_bytes()])
def test_a_repeated_reading_gives_the_same_labels(text):
    assert compared(text, text) == (0, 0)


@pytest.mark.parametrize(
    ("before", "after", "gone", "come"),
    [
        (RESTRICTED, TWINS, 0, 8),
        (TWINS, RESTRICTED, 8, 0),
        (TWINS, TWINS.replace(b"urn:d>", b"urn:e>"), 8, 8),
        (RESTRICTED, RESTRICTED.replace(b"urn:b>", b"urn:e>"), 8, 8),
        (RESTRICTED, b"<urn:c> <urn:below> [] .", 8, 1),
        (RESTRICTED + CYCLE, CYCLE.replace(b"<urn:is> <urn:b>", b"<urn:is> <urn:e>") + RESTRICTED, 4, 4),
    ],
)
def test_only_the_changed_nodes_get_new_labels(before, after, gone, come):
    assert compared(before, after) == (gone, come)
