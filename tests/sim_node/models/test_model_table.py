"""The sizes, masses and colours of the models."""

import numpy as np
import pytest

from semmap.nodes.sim_node.models.library import build
from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.sim_node.models.variety_table import VARIETIES
from tests.sim_node.models.known_models import differences

OWN = [name for name in MODELS if name not in VARIETIES]


@pytest.mark.parametrize("name", OWN)
def test_a_model_is_what_the_knowledge_base_and_perception_know_of_it(name):
    assert differences(name) == []


@pytest.mark.parametrize("name", MODELS)
def test_a_model_is_no_lighter_than_foam_and_no_heavier_than_steel(name):
    kind = MODELS[name]
    assert 2.0 < kind.mass_kg / float(np.prod(kind.size_m)) < 2500.0


@pytest.mark.parametrize("name", MODELS)
def test_a_model_s_colours_can_be_shown_and_one_of_them_is_its_own(name):
    kind = MODELS[name]
    assert all(0.0 <= channel <= 1.0 for channel in kind.colour)
    shown = [part.colour for part in build(name, None).parts]
    assert all(0.0 <= channel <= 1.0 for colour in shown for channel in colour)
    bright = [np.array(colour) / max(colour) for colour in shown if max(colour) > 0.0]
    assert min(np.abs(b - np.array(kind.colour) / max(kind.colour)).max() for b in bright) < 0.2
