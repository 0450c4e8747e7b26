from nodes.sim_node.models.model_table import MODELS
from nodes.training.taxonomy import class_of_models, hierarchy


def test_ancestors_go_from_special_to_general():
    above = hierarchy()
    assert above["Fork"] == ("Cutlery", "Tableware", "Object")
    assert above["Object"] == ()


def test_every_model_stands_for_a_class_of_its_own():
    found = class_of_models(MODELS)
    assert set(found) == set(MODELS)
    assert len(set(found.values())) == len(found)
    assert (found["wine_bottle"], found["can"]) == ("Wine", "Can")
