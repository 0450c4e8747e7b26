"""Suppressed facts are found by subject and by object."""

from semmap.nodes.kb_node.reasoner.suppressed import SuppressedFacts

ON, OFF = "<urn:on>", "<urn:off>"
TRIPLES = [("<urn:a>", ON, "<urn:b>"), ("<urn:b>", ON, "<urn:c>"), ("<urn:a>", OFF, "<urn:c>")]


def test_facts_are_found_by_subject_and_object_until_they_are_removed():
    suppressed = SuppressedFacts()
    suppressed.add(TRIPLES)
    suppressed.add(TRIPLES[:1])
    assert len(suppressed) == 3
    assert set(suppressed.match(None, None, "<urn:c>")) == set(TRIPLES[1:])
    assert set(suppressed.match(None, ON, "<urn:c>")) == {TRIPLES[1]}
    assert set(suppressed.match("<urn:a>", None, "<urn:c>")) == {TRIPLES[2]}
    assert suppressed.about(["<urn:b>", "<urn:d>"]) == set(TRIPLES[:2])
    assert suppressed.mentioned({"<urn:c>", "<urn:d>"}) == {"<urn:c>"}
    suppressed.remove([*TRIPLES[:2], ("<urn:d>", ON, "<urn:d>")])
    assert set(suppressed) == suppressed.about(["<urn:c>"]) == {TRIPLES[2]}
    assert not suppressed.about(["<urn:b>"])
    assert not suppressed.mentioned({"<urn:b>"})
    suppressed.remove(TRIPLES)
    assert not suppressed
    assert not suppressed.about(["<urn:c>"])
