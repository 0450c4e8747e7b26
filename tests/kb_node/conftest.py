import pytest

from tests.kb_node import home


@pytest.fixture
def semantic_map(tmp_path):
    """An empty map over the small TBox."""
    made = home.new_map(tmp_path)
    yield made
    home.close(made)
