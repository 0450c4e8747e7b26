import json

from nodes.sim_node.models.own_sizes import own_sizes_m
from ontology import MODEL_SIZES_JSON
from ontology.model_sizes import own_size_m


def test_the_table_holds_the_sizes_of_the_models():
    table = json.loads(MODEL_SIZES_JSON.read_text())
    assert table == own_sizes_m(), "run: python -m nodes.sim_node.models.own_sizes"


def test_a_class_without_a_model_is_a_box_and_only_the_simulator_knows_a_file():
    assert own_size_m("") == (0.3, 0.3, 0.3)
    assert own_size_m("carton") is not None
    assert own_size_m("sofa.obj") is None
