from collections import Counter

import numpy as np

from semmap.nodes.training.scenes.arrangement import heaps


def test_heaps_hold_several_of_a_kind_on_a_table():
    scenes = list(heaps(6, [], np.random.default_rng(0)))
    counts = [Counter((item.kind, item.size_m) for item in items[1:]) for items, _ in scenes]
    assert all(items[0].name == "table" and len(views) == 2 for items, views in scenes)
    assert sum(max(count.values()) > 1 for count in counts) >= 4
