from semmap.ontology.model_shapes import own_size_m


def test_a_class_without_a_model_is_a_box_and_only_the_simulator_knows_a_file():
    assert own_size_m("") == (0.3, 0.3, 0.3)
    assert own_size_m("carton") is not None
    assert own_size_m("sofa.obj") is None
