import random

import pytest

from semmap.nodes.coordinator.free_names import FreeNames
from semmap.schemas.entities import free_name


@pytest.mark.parametrize("seed", range(5))
def test_the_first_free_name_is_found_after_any_changes(seed):
    rng, names, taken = random.Random(seed), FreeNames(), set()
    for _ in range(500):
        class_name = rng.choice(("Cup", "Cup1", "soma:Cup", "3Three"))
        name = names.name(class_name, taken)
        assert name == free_name(class_name, taken)
        if rng.random() < 0.7:
            taken.add(name)
        if taken and rng.random() < 0.3:
            gone = rng.choice(sorted(taken))
            taken.remove(gone)
            names.release(gone)


class Counted(set):
    asked = 0

    def __contains__(self, name):
        self.asked += 1
        return super().__contains__(name)


def test_numbers_that_are_taken_are_not_tried_again():
    names, taken = FreeNames(), Counted(f"cup{i}" for i in range(1, 1001))
    for _ in range(100):
        taken.add(names.name("Cup", taken))
    assert taken.asked < 1500
