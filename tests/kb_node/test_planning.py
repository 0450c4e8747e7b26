import random

import pytest

from semmap.nodes.kb_node import planning
from semmap.schemas.commits import Transaction


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
