"""The models match the files of the knowledge base and perception, which `make shapes` writes."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.sim_node.models.library import build
from semmap.nodes.sim_node.models.variety_table import KINDS
from tests.sim_node.models.known_models import differences


@pytest.mark.parametrize("name", KINDS)
def test_a_model_is_what_the_knowledge_base_and_perception_know_of_it(name):
    assert differences(name) == []


@pytest.mark.parametrize("name", KINDS)
def test_its_parts_have_an_extent_and_colours_that_a_screen_can_show(name):
    for part in build(name, None).parts:
        assert min(part.half) > 0.0
        assert np.linalg.norm(part.turn) == pytest.approx(1.0)
        assert all(0.0 <= channel <= 1.0 for channel in part.colour)
