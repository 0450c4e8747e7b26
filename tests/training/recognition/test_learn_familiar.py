import numpy as np

from semmap.nodes.training.recognition.gradient_descent import Recipe
from semmap.nodes.training.recognition.learn_familiar import learn_familiar

NONE = 2
LEAF = np.repeat([0, 1, NONE], 400)
MIDDLES = np.array([(2.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 0.0)])


def test_our_models_are_recognised_and_others_rejected():
    rng = np.random.default_rng(0)
    seen = MIDDLES[LEAF] + rng.normal(0.0, 0.3, (len(LEAF), 3))
    known = learn_familiar([seen[:, :2], seen[:, 2:]], LEAF, NONE, Recipe((32,), rounds=40))
    assert (known(MIDDLES).argmax(axis=1) == [0, 1, NONE]).all()
    far_off = np.array([(30.0, -30.0, 30.0), (-30.0, -30.0, -30.0), (30.0, 30.0, 30.0)])
    assert (known(far_off).argmax(axis=1) == NONE).all()
