"""The short names of nodes."""

import pytest

from semmap.nodes.supervisor.parts import nodes_of
from semmap.schemas import errors


@pytest.mark.parametrize(
    ("text", "nodes"),
    [
        ("kb,coordinator", ("kb_node", "coordinator")),
        (" sim , perception_node", ("sim_node", "perception_node")),
        ("recorder,recorder,router", ("recorder", "router")),
    ],
)
def test_nodes_by_their_short_and_long_names(text, nodes):
    assert nodes_of(text) == nodes


@pytest.mark.parametrize("text", ["", " , ", "kb;sim", "KB", "supervisor"])
def test_an_invalid_list_of_nodes_is_rejected_with_the_choices(text):
    with pytest.raises(errors.BadRequest, match=r"kb.*coordinator.*sim.*perception.*recorder.*router"):
        nodes_of(text)
