from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.training.taxonomy import class_of_models, hierarchy


def test_ancestors_go_from_special_to_general():
    above = hierarchy()
    assert above["Fork"] == ("Cutlery", "Tableware", "Object")
    assert above["Object"] == ()


def test_every_model_stands_for_a_class_of_its_own_but_for_two_sorts_of_boxes():
    found = class_of_models(MODELS)
    assert set(found) == set(MODELS)
    of_boxes = {model for model, name in found.items() if name == "Box"}
    assert of_boxes == {"box", "cardboard_box"}
    assert len(set(found.values())) == len(found) - 1
    assert (found["wine_bottle"], found["can"]) == ("Wine", "Can")
