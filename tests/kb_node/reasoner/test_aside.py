"""What is set aside, found by either end."""

from semmap.nodes.kb_node.reasoner.aside import Aside

ON, OFF = "<urn:on>", "<urn:off>"
TRIPLES = [("<urn:a>", ON, "<urn:b>"), ("<urn:b>", ON, "<urn:c>"), ("<urn:a>", OFF, "<urn:c>")]


def test_it_is_found_by_either_end_until_it_is_removed():
    aside = Aside()
    aside.add(TRIPLES)
    aside.add(TRIPLES[:1])
    assert len(aside) == 3
    assert set(aside.match(None, None, "<urn:c>")) == set(TRIPLES[1:])
    assert set(aside.match(None, ON, "<urn:c>")) == {TRIPLES[1]}
    assert set(aside.match("<urn:a>", None, "<urn:c>")) == {TRIPLES[2]}
    assert aside.touching(["<urn:b>", "<urn:d>"]) == set(TRIPLES[:2])
    assert aside.mentioned({"<urn:c>", "<urn:d>"}) == {"<urn:c>"}
    aside.remove([*TRIPLES[:2], ("<urn:d>", ON, "<urn:d>")])
    assert set(aside) == aside.touching(["<urn:c>"]) == {TRIPLES[2]}
    assert not aside.touching(["<urn:b>"])
    assert not aside.mentioned({"<urn:b>"})
    aside.remove(TRIPLES)
    assert not aside
    assert not aside.touching(["<urn:c>"])
