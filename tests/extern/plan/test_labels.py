import itertools
import random

from semmap.nodes.extern.plan.labels import Box, Sheet, text_width_mm

PAPER = Box(0.0, 0.0, 200.0, 150.0)


def test_a_name_stands_in_its_thing_where_there_is_room():
    thing = Box(10.0, 10.0, 40.0, 20.0)
    label = Sheet(PAPER, [thing]).place("table1", 2.0, thing)
    assert label is not None
    assert thing.holds(label.box)
    assert not label.upright


def test_a_name_in_a_narrow_thing_reads_from_below():
    thing = Box(10.0, 10.0, 14.0, 40.0)
    label = Sheet(PAPER, [thing]).place("wardrobe1", 2.0, thing)
    assert label is not None
    assert label.upright
    assert thing.holds(label.box)


def test_a_name_too_long_stands_beside():
    thing = Box(50.0, 50.0, 53.0, 53.0)
    label = Sheet(PAPER, [thing]).place("remote_control1", 2.0, thing)
    assert label is not None
    assert label.box.overlap_mm2(thing) == 0.0


def test_the_names_of_a_crowd_never_touch():
    chance = random.Random(4)
    things = [
        Box(x, y, x + 3.0, y + 3.0)
        for x, y in ((chance.uniform(0, 190), chance.uniform(0, 140)) for _ in range(400))
    ]
    sheet = Sheet(PAPER, things)
    placed = [label for i, thing in enumerate(things) if (label := sheet.place(f"thing{i}", 2.0, thing))]
    assert len(placed) > 50
    for a, b in itertools.combinations((label.box for label in placed), 2):
        assert Box(a.x0 - 0.4, a.y0 - 0.4, a.x1 + 0.4, a.y1 + 0.4).overlap_mm2(b) == 0.0
    assert all(PAPER.holds(label.box) for label in placed)


def test_a_name_prefers_not_to_cross_walls():
    thing, wall = Box(50.0, 50.0, 53.0, 53.0), Box(0.0, 53.5, 200.0, 56.0)
    label = Sheet(PAPER, [thing], [wall]).place("remote_control1", 2.0, thing)
    assert label is not None
    assert label.box.overlap_mm2(wall) == 0.0


def test_missing_space_returns_none():
    thing = Box(50.0, 50.0, 51.0, 51.0)
    sheet = Sheet(Box(49.0, 49.0, 52.0, 52.0), [thing])
    assert sheet.place("remote_control1", 2.0, thing) is None


def test_wide_letters_are_wide():
    assert text_width_mm("椅子", 2.0) > text_width_mm("ab", 2.0)
    assert text_width_mm("e\u0301", 2.0) == text_width_mm("e", 2.0)
