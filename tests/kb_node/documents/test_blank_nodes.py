"""Matching of equivalent blank nodes between two readings."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.blank_nodes import relabel_like, require_shallow_expressions
from semmap.ontology import HOUSEHOLD_TTL
from semmap.schemas.nesting import LIMIT

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


def nested(levels, inner="[ <http://www.w3.org/2002/07/owl#complementOf> "):
    return rdf.parse(f"<a:a> <a:p> {inner * (levels + 1)}<a:b>{' ]' * (levels + 1)} .".encode(), "x")


def test_the_depth_of_class_expressions_is_limited():
    require_shallow_expressions(nested(LIMIT - 10))
    chain = [
        (f"_:b{n}", "<http://www.w3.org/2002/07/owl#complementOf>", f"_:b{n + 1}") for n in range(50_000)
    ]
    require_shallow_expressions(chain[:LIMIT])
    for several in (chain[: LIMIT + 1], chain):
        with pytest.raises(ValueError, match="nested deeper than 200 levels"):
            require_shallow_expressions(several)
    with pytest.raises(ValueError, match="contain themselves"):
        require_shallow_expressions([*chain, (chain[-1][2], chain[0][1], chain[0][0])])


def test_long_lists_and_chains_of_individuals_are_not_deep():
    require_shallow_expressions(rdf.parse(f"<a:a> <a:p> ( {'[] ' * 1000} ) .".encode(), "x"))
    require_shallow_expressions([(f"_:b{n}", "<a:near>", f"_:b{n + 1}") for n in range(1000)])


def test_a_long_chain_of_equal_nodes_is_matched_quickly():
    chains = [[(f"_:{x}{n}", "<a:near>", f"_:{x}{n + 1}") for n in range(5_000)] for x in "ab"]
    assert len(relabel_like(*chains)) == 5_000
