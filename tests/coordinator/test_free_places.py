from __future__ import annotations

import math
import random

import pytest

from semmap.nodes.coordinator.free_places import DEFAULT_POSITION, FreePlaces
from semmap.schemas.entities import Pose, orientation_from_yaw
from tests.coordinator.reconciler.test_reconcile import entity
from tests.depth import tries


def standing(x, y, size, yaw=0.0):
    import msgspec

    pose = Pose(position_m=(x, y, 0.0), orientation_wxyz=orientation_from_yaw(yaw))
    return msgspec.structs.replace(entity("box1", pose), size_m=size)


def free_position(entities, size):
    """The result of a first search."""
    named = {f"box{i}": entity for i, entity in enumerate(entities)}
    places = FreePlaces()
    places.touch(named)
    return places.find(named, size)


def test_an_empty_map_gives_the_default_position():
    assert free_position([], None) == DEFAULT_POSITION


def test_the_place_is_beside_what_stands_at_the_default_position():
    x, y, z = free_position([standing(2.0, 2.0, (1.0, 1.0, 1.0))], (0.4, 0.4, 0.4))
    assert z == 0.0
    assert max(abs(x - 2.0), abs(y - 2.0)) >= 0.5 + 0.2
    assert math.hypot(x - 2.0, y - 2.0) < 2.0


def test_a_place_is_found_for_big_things_and_in_crowds():
    crowd = [standing(2.0 + i, 2.0 + j, (1.0, 1.0, 1.0)) for i in range(-20, 20) for j in range(-20, 20)]
    for size in ((1.0, 1.0, 1.0), (1000.0, 1000.0, 1000.0)):
        x, y, _ = free_position(crowd, size)
        assert math.hypot(x - 2.0, y - 2.0) > 20.0


def test_a_rug_is_not_an_obstacle():
    assert free_position([standing(2.0, 2.0, (2.0, 2.0, 0.01))], None) == DEFAULT_POSITION


def test_a_long_thing_blocks_along_its_length_only():
    beside = [standing(2.0, 3.0, (4.0, 0.2, 0.5))]
    turned = [standing(2.0, 3.0, (4.0, 0.2, 0.5), yaw=math.pi / 2)]
    assert free_position(beside, (0.4, 0.4, 0.4)) == DEFAULT_POSITION
    assert free_position(turned, (0.4, 0.4, 0.4)) != DEFAULT_POSITION


SIZES = [None, (0.3, 0.3, 0.3), (1.5, 0.2, 1.0), (9.0, 9.0, 1.0)]


@pytest.mark.parametrize("seed", range(tries(5)))
def test_later_searches_return_the_same_as_a_first_search(seed):
    """Objects are added, moved, resized and removed between the searches."""
    rng = random.Random(seed)
    places, there, number = FreePlaces(), {}, 0
    for _ in range(50):
        what = rng.random()
        if what < 0.5 or not there:
            number += 1
            name, size = f"box{number}", rng.choice(SIZES[:3])
            x, y, _ = places.find(there, size)
            there[name] = standing(x, y, size, rng.choice((0.0, 0.4)))
        elif what < 0.8:
            name = rng.choice(list(there))
            x, y = (rng.uniform(-1.0, 5.0) for _ in range(2))
            there[name] = standing(x, y, rng.choice([*SIZES, (60.0, 60.0, 2.0)]), rng.uniform(-4, 4))
        else:
            name = rng.choice(list(there))
            del there[name]
        places.touch([name])
        size = rng.choice(SIZES)
        assert places.find(there, size) == free_position(there.values(), size)


def test_another_search_does_not_start_again(monkeypatch):
    """A hundred adds in a crowd try few places, though the first one tries thousands."""
    steps = [step / 2 for step in range(-20, 20)]
    crowd = {f"box{x}-{y}": standing(2 + x, 2 + y, None) for x in steps for y in steps}
    tried, is_free = [], FreePlaces._is_free
    monkeypatch.setattr(FreePlaces, "_is_free", lambda *spot: tried.append(spot) or is_free(*spot))
    places = FreePlaces()
    places.touch(crowd)
    places.find(crowd, None)
    assert len(tried) > 1000
    tried.clear()
    for i in range(100):
        crowd[f"new{i}"] = standing(*places.find(crowd, None)[:2], None)
        places.touch([f"new{i}"])
    assert len(tried) < 1000
