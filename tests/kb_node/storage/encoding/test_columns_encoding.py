import pytest

from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.storage.encoding import checkpoint_encoding, columns_encoding
from semmap.nodes.kb_node.storage.encoding.checkpoint_encoding import Checkpoint
from tests.kb_node.reasoner.graphs import triples

SCHEMA = triples(":isAt owl:propertyChainAxiom ( :isOn :isIn ) . :Mug rdfs:subClassOf :Cup .")
FACTS = triples(
    ':cup a :Mug ; :isOn :table ; :says "é", "a\\nb" . :table :isIn :kitchen .'
    + "".join(f" :cup{i} a :Cup ; :isOn :table ." for i in range(40))
)


@pytest.fixture
def columns():
    reasoner = Reasoner(SCHEMA)
    reasoner.apply(insert=FACTS)
    reasoner.apply(delete=triples(":cup7 a :Cup ; :isOn :table ."))
    return reasoner.columns()


@pytest.mark.parametrize("size", [3, 1 << 20])
def test_stored_columns_are_restored(columns, monkeypatch, size):
    monkeypatch.setattr(columns_encoding, "_TERMS", size)
    monkeypatch.setattr(columns_encoding, "_NUMBERS", size)
    told = []
    body = checkpoint_encoding.encode(Checkpoint(seq=7, columns=columns))
    read = checkpoint_encoding.decode(body, lambda: told.append(""))
    assert read == Checkpoint(seq=7, columns=columns)
    assert len(told) >= 1 + 13
    assert (
        set(read.all_triples())
        == set(columns.triples())
        == set(FACTS) - set(triples(":cup7 a :Cup ; :isOn :table ."))
    )
    filled = Reasoner(SCHEMA)
    assert filled.fill(read.columns)
    assert filled.holds(triples(":cup :isAt :kitchen .")[0])


def test_frames_have_the_same_byte_order_everywhere(columns, monkeypatch):
    body = checkpoint_encoding.encode(Checkpoint(seq=7, columns=columns))
    monkeypatch.setattr(columns_encoding.sys, "byteorder", "big")
    assert checkpoint_encoding.decode(body).columns.subject != columns.subject
