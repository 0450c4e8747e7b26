import pytest

from nodes.kb_node.documents import rdf
from nodes.kb_node.semantic_map import SemanticMap
from nodes.kb_node.storage.journal import Journal
from ontology import FLAT_TTL, HOUSEHOLD_TTL
from schemas.commits import Transaction
from tests.kb_node import home, stating


@pytest.fixture
def semantic_map(tmp_path):
    """An empty map over the small TBox."""
    made = home.new_map(tmp_path)
    yield made
    home.close(made)


@pytest.fixture
def stateful_map(tmp_path):
    """A map over a TBox with properties of every kind; `chair1` and `kitchen1` are in it."""
    made = stating.new_map(tmp_path)
    yield made
    home.close(made)


@pytest.fixture
def flat(tmp_path):
    """The flat that comes with semmap, as a map."""
    tbox = rdf.parse(HOUSEHOLD_TTL.read_bytes(), "household.ttl", label_prefix="t")
    made = SemanticMap(
        Journal.create(tmp_path / "journal.sqlite", rdf.serialise(frozenset(tbox), "ntriples"))
    )
    abox = rdf.parse(FLAT_TTL.read_bytes(), "flat.ttl", label_prefix="f")
    made.commit(Transaction(id="flat", source="file", insert=tuple(abox)))
    yield made
    made._journal.close()
