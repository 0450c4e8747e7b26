import pytest

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
