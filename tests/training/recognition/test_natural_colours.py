from dataclasses import fields

import numpy as np

from semmap.nodes.perception_node.recognition.features import MEAN_COLOUR
from semmap.nodes.training.recognition.natural_colours import unnatural
from semmap.nodes.training.recognition.samples import Samples

GREEN, RED, BLUE, NONE = (0.3, 0.7, 0.2), (0.8, 0.2, 0.2), (0.1, 0.2, 0.9), (0.0, 0.0, 0.0)


def seen(*kinds_colours):
    columns = {field.name: np.zeros((len(kinds_colours), 40)) for field in fields(Samples)}
    columns["kind"] = np.array([kind for kind, _ in kinds_colours])
    columns["colour"][:, MEAN_COLOUR] = [colour for _, colour in kinds_colours]
    return Samples(**columns)


OWN = seen(("apple", GREEN), ("apple", RED), ("lemon", (0.9, 0.8, 0.2)), ("ball", RED))


def test_an_apple_is_red_or_green_in_any_light_and_a_ball_may_be_blue():
    dark = tuple(0.3 * value for value in RED)
    met = seen(
        ("apple", RED), ("apple", dark), ("apple", BLUE), ("apple", NONE), ("ball", BLUE), ("cup", BLUE)
    )
    assert unnatural(met, OWN).tolist() == [False, False, True, False, False, False]


def test_fruit_that_is_not_among_our_models_has_the_colours_of_any():
    met = seen(("fruit@Fruit", GREEN), ("fruit@Fruit", BLUE))
    assert unnatural(met, OWN).tolist() == [False, True]
