import numpy as np

from semmap.nodes.training.recognition.__main__ import strangers
from semmap.nodes.training.scenes.simulated_scenes import foreign_label


def test_foreign_things_are_numbered_and_our_own_are_not():
    drill, ball = foreign_label("drill", "", new=True), foreign_label("ball", "Ball", new=False)
    kinds = np.array(["cup", drill, "", ball, "cup", drill])
    found = strangers(kinds)
    assert found[[0, 2, 4]].tolist() == [-1, -1, -1]
    assert found[1] == found[5] != found[3]
    assert sorted({found[1], found[3]}) == [0, 1]
