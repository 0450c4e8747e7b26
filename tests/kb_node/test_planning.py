import random

import pytest

from semmap.nodes.kb_node import planning
from semmap.ontology import vocabulary as v
from semmap.schemas.commits import Transaction
from tests.kb_node.home import chair, turtle


@pytest.mark.parametrize("count", [10, planning._VERY_MANY])
@pytest.mark.parametrize("again", [0, 1, 100])
def test_each_triple_is_inserted_once_and_in_order(semantic_map, count, again):
    triples = [("<urn:s>", "<urn:p>", f"<urn:o{i}>") for i in range(count)]
    insert = [*triples, *random.Random(1).choices(triples, k=again)]
    plan = planning.make_plan(semantic_map, Transaction(id="1", source="file", insert=tuple(insert)))
    assert list(plan.inserted) == triples


def test_a_triple_that_is_retracted_and_inserted_is_kept(semantic_map):
    triple, other = ("<urn:s>", "<urn:p>", "<urn:o>"), ("<urn:s>", "<urn:p>", "<urn:o2>")
    semantic_map.commit(Transaction(id="1", source="file", insert=(triple,)))
    change = Transaction(id="2", source="file", retract=(triple,), insert=(triple, other))
    plan = planning.make_plan(semantic_map, change)
    assert (plan.retracted, plan.inserted) == ((), (other,))


def test_clearing_the_map_removes_other_individuals_too_but_not_its_header(semantic_map):
    header = (v.ABOX_ONTOLOGY, v.RDF_TYPE, v.iri(f"{v.OWL}Ontology"))
    others = turtle("<urn:e> a <urn:Event> ; <urn:at> <urn:t> . [] <urn:of> <urn:e> .")
    semantic_map.commit(Transaction(id="1", source="file", insert=(header, *others, *chair())))
    made = semantic_map.commit(Transaction(id="2", source="operator", remove=("chair1",), others=True))
    assert (semantic_map.abox(), len(semantic_map)) == ([header], 0)
    assert made.notes == ("also removed 1 individual without a place in space",)
    assert semantic_map.commit(Transaction(id="3", source="operator", others=True)) is None
    semantic_map.commit(Transaction(id="4", source="operator", insert=made.retracted))
    assert set(semantic_map.abox()) == {header, *others, *chair()}
