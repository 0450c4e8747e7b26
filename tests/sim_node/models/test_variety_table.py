"""Alternative models of classes."""

import numpy as np
import pytest

from semmap.nodes.sim_node.models.library import build
from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.sim_node.models.variety_table import KINDS, VARIETIES
from semmap.ontology.model_shapes import shapes
from tests.sim_node.models.known_models import differences


@pytest.mark.parametrize("name", VARIETIES)
def test_a_variety_is_what_the_knowledge_base_and_perception_know_of_it(name):
    assert differences(name) == []
    known, variety = shapes()[name], VARIETIES[name]
    assert (known.of, known.words, known.only_named) == (variety.of, variety.words, variety.only_named)


@pytest.mark.parametrize("name", VARIETIES)
def test_a_variety_has_the_weight_and_the_colours_of_a_thing(name):
    kind = KINDS[name]
    assert 4.0 < kind.mass_kg / float(np.prod(kind.size_m)) < 2500.0
    assert all(0.0 <= channel <= 1.0 for part in build(name, None).parts for channel in part.colour)


@pytest.mark.parametrize("name", VARIETIES)
def test_a_variety_stands_beside_models_that_there_are(name):
    assert VARIETIES[name].of
    assert set(VARIETIES[name].of) - KINDS.keys() == set()


def test_the_library_has_the_usual_models_and_their_varieties():
    assert KINDS.keys() == MODELS.keys() | VARIETIES.keys()
    assert all(KINDS[name] == VARIETIES[name].kind for name in VARIETIES)
