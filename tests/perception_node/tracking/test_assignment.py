"""Assignment of observations to things."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.perception_node.tracking.assignment import Candidate, assign, match
from semmap.nodes.perception_node.tracking.costs import Target
from semmap.nodes.perception_node.tracking.tracks import Track
from semmap.nodes.perception_node.tracking.votes import Votes
from tests.perception_node.things import CLASSES, CONFIG, SIZES, at, seen

EMPTY, FILLED, HIDDEN = (lambda pose, size_m, it=it: it for it in ("free", "occupied", "unknown"))
COSTS = st.lists(st.lists(st.sampled_from([0.0, 1.0, 2.0, math.inf]), min_size=3, max_size=3), max_size=4)


def thing(class_="Cup", where=None, size_m=None, *, whole=True, **track):
    pose, size_m = where or at(1, 1), size_m or SIZES[class_]
    known = {"frames": 5, "whole": True, "sized": 1.0}
    return Candidate(
        Track(pose, size_m, Votes().cast(class_, 0.9, 5.0), **known | track),
        Target(pose, size_m, class_, whole),
    )


def matched(known, observations, occupancy=EMPTY, tentative=(), config=CONFIG):
    return match(known, tentative, observations, occupancy, CLASSES, config)


@given(COSTS)
def test_pairs_are_as_many_as_may_be_and_of_the_least_cost(costs):
    rows, columns = range(len(costs)), range(3)
    pairs = assign(rows, columns, lambda a, b: costs[a][b])
    assert len({i for i, _ in pairs}) == len({j for _, j in pairs}) == len(pairs)
    assert all(math.isfinite(costs[i][j]) for i, j in pairs)
    most, least = _best(costs, list(columns))
    assert (len(pairs), sum(costs[i][j] for i, j in pairs)) == (most, least)


def _best(costs, columns):
    """Return the maximum number of pairs, and their minimum cost, by exhaustive search."""
    if not costs:
        return 0, 0.0
    options = [_best(costs[1:], columns)]
    for j in columns:
        if math.isfinite(costs[0][j]):
            count, cost = _best(costs[1:], [other for other in columns if other != j])
            options.append((count + 1, cost + costs[0][j]))
    return min(options, key=lambda option: (-option[0], option[1]))


def test_without_anything_there_are_no_pairs():
    assert assign([], [1, 2], lambda a, b: 0.0) == []
    assert assign([1, 2], [], lambda a, b: 0.0) == []


def test_things_are_seen_in_their_places_and_the_rest_is_new():
    known = {"cup1": thing(), "cup2": thing(where=at(1.2, 1))}
    found = matched(known, [seen("Cup", at(1.2, 1)), seen("Book", at(3, 3)), seen("Cup", at(1, 1))])
    assert (found.known, found.new, found.occupancy, found.odd) == ({"cup1": 2, "cup2": 0}, [1], {}, set())


@pytest.mark.parametrize(("occupancy", "is_found"), [(EMPTY, True), (FILLED, False), (HIDDEN, False)])
def test_what_vanished_from_a_place_that_is_seen_empty_is_found_elsewhere(occupancy, is_found):
    found = matched({"cup1": thing()}, [seen("Cup", at(3, 3))], occupancy)
    assert found.known == ({"cup1": 0} if is_found else {})
    assert found.new == ([] if is_found else [0])
    assert found.occupancy.get("cup1") == (None if is_found else occupancy(None, None))


def test_what_must_be_missed_more_often_is_found_elsewhere_later():
    config = replace(CONFIG, vanished_frames=2)
    elsewhere = [seen("Cup", at(3, 3))]
    assert matched({"cup1": thing()}, elsewhere, config=config).known == {}
    assert matched({"cup1": thing(unseen=1)}, elsewhere, config=config).known == {"cup1": 0}


def test_what_was_there_before_it_vanished_is_another():
    other = thing(where=at(3, 3), frames=5)
    look = [seen("Cup", at(3, 3))]
    found = matched({"cup1": thing(absent=4)}, look, tentative=[other])
    assert (found.known, found.tentative) == ({}, {0: 0})
    found = matched({"cup1": thing(absent=5)}, look, tentative=[other])
    assert (found.known, found.tentative) == ({"cup1": 0}, {})


def test_what_was_only_seen_in_part_is_not_found_elsewhere():
    assert matched({"cup1": thing(whole=False)}, [seen("Cup", at(3, 3))]).known == {}


@pytest.mark.parametrize(
    ("side_m", "x", "is_found"), [(0.39, 3.0, True), (0.41, 3.0, False), (0.41, 1.4, True)]
)
def test_what_is_large_is_not_carried_far(side_m, x, is_found):
    config = replace(CONFIG, pushed_m=0.5)
    size_m = (side_m, 0.2, 0.2)
    box = thing("Object", size_m=size_m)
    found = matched({"box1": box}, [seen("Object", at(x, 1), size_m)], config=config)
    assert found.known == ({"box1": 0} if is_found else {})


def test_a_part_of_a_thing_shows_that_it_is_there_and_is_not_new():
    shelf = thing("Object", size_m=(0.4, 0.4, 0.8))
    part = seen("Object", at(1.05, 1.1, 0.7), (0.1, 0.1, 0.3), whole=False)
    found = matched({"shelf1": shelf}, [part])
    assert (found.known, found.new) == ({}, [])
    assert found.occupancy == {"shelf1": "occupied"}
    assert found.odd == {"shelf1"}


@pytest.mark.parametrize(
    "missed", [{"odd": CONFIG.odd_frames}, {"unseen": CONFIG.vanished_frames}, {"unseen": CONFIG.gone_frames}]
)
def test_in_the_place_of_a_thing_that_is_gone_a_part_is_another_thing(missed):
    shelf = thing("Object", size_m=(0.4, 0.4, 0.8), **missed)
    part = seen("Object", at(1.05, 1.1, 0.7), (0.1, 0.1, 0.3), whole=False)
    found = matched({"shelf1": shelf}, [part], FILLED)
    assert (found.known, found.new) == ({}, [0])


def test_another_kind_of_thing_in_its_place_does_not_show_that_it_is_there():
    book = seen("Book", at(1, 1), (0.08, 0.08, 0.4))
    found = matched({"cup1": thing()}, [book], EMPTY)
    assert found.occupancy == {"cup1": "free"}
    assert found.new == [0]
    found = matched({"cup1": thing()}, [book], FILLED)
    assert (found.occupancy, found.odd, found.new) == ({"cup1": "occupied"}, {"cup1"}, [])


def test_what_a_thing_of_unknown_size_fills_is_unknown():
    nowhere = Candidate(thing().track, Target(at(1, 1), None, "Cup"))
    assert matched({"cup1": nowhere}, [], EMPTY).occupancy == {"cup1": "unknown"}


def test_a_segment_of_several_things_is_none_of_them():
    known = {"a": thing("Book", at(1, 1), (0.2, 0.2, 0.2)), "b": thing("Book", at(1.2, 1), (0.2, 0.2, 0.2))}
    both = seen("Book", at(1.1, 1), (0.4, 0.2, 0.2))
    found = matched(known, [both], FILLED)
    assert (found.known, found.new) == ({}, [])
    like_it = thing("Book", at(1.1, 1), (0.4, 0.2, 0.2))
    assert matched(known | {"c": like_it}, [both], FILLED).known == {"c": 0}
    apart = {"a": known["a"], "b": thing("Book", at(4, 4), (0.2, 0.2, 0.2))}
    assert matched(apart, [both], FILLED).known == {}
    table = seen("Object", at(1.1, 1, 0.0), (2.0, 2.0, 1.0))
    assert matched(known, [table], FILLED).new == [0]  # they lie on it, and do not fill it


def test_what_is_nearly_odd_may_have_another_height():
    odd = thing(odd=CONFIG.odd_frames - 1)
    flat = seen("Cup", at(1, 1), (0.08, 0.08, 0.02))
    assert matched({"cup1": odd}, [flat], FILLED).known == {"cup1": 0}
    assert matched({"cup1": thing(odd=CONFIG.odd_frames - 2)}, [flat], FILLED).known == {}


def test_what_is_no_entity_yet_is_seen_again():
    found = matched({}, [seen("Cup", at(3, 3)), seen("Cup", at(1, 1))], tentative=[thing()])
    assert (found.tentative, found.new) == ({0: 1}, [0])
