import pytest

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.ontology import FLAT_TTL
from semmap.schemas.commits import Transaction
from tests.kb_node import home, stating


@pytest.fixture
def semantic_map(tmp_path):
    """An empty map with the small TBox."""
    made = home.new_map(tmp_path)
    yield made
    home.close(made)


@pytest.fixture
def stateful_map(tmp_path):
    """A map with a TBox with properties of every kind, `chair1` and `kitchen1`."""
    made = stating.new_map(tmp_path)
    yield made
    home.close(made)


@pytest.fixture(scope="session")
def unchanged():
    """The map of the flat, unless a test has changed it."""
    kept: list[SemanticMap] = []
    yield kept
    for made in kept:
        made._journal.close()


@pytest.fixture
def flat(unchanged, tmp_path_factory):
    """The shipped flat as a map, shared by all tests that only read it."""
    if not unchanged:
        made = SemanticMap(home.new_household_journal(tmp_path_factory.mktemp("flat")))
        abox = rdf.parse(FLAT_TTL.read_bytes(), "flat.ttl", label_prefix="f")
        made.commit(Transaction(id="flat", source="file", insert=tuple(abox)))
        unchanged.append(made)
    (made,) = unchanged
    yield made
    if made.seq != 1:
        unchanged.remove(made)
        made._journal.close()
