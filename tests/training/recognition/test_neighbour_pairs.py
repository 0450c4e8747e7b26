import numpy as np

from semmap.nodes.training.recognition.neighbour_pairs import Pairs, pairs_of
from tests.perception_node.scenes import HEIGHT_M, KINDS, item, shot


def test_pairs_say_whether_they_are_one_thing():
    items = [item(kind, kind, (x, y, HEIGHT_M + 0.001), 0.4) for kind, (x, y) in KINDS.items()]
    items.append(item("table", "table", (0.0, 0.0, 0.0), 0.0, (0.8, 1.4, HEIGHT_M)))
    pairs = Pairs.joined(pairs_of(shot(), items, np.random.default_rng(0)))
    said = {
        (*sorted(kinds), one) for kinds, one in zip(pairs.kinds.tolist(), pairs.one.tolist(), strict=True)
    }
    assert said == {("basket", "bottle", False), ("basket", "basket", True)}
    assert pairs.known.shape == (len(pairs.one), 16)
    assert pairs.geometry.shape[:2] == (len(pairs.one), 3)
