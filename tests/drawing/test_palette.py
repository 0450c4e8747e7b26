from itertools import combinations

import pytest

from semmap.nodes.drawing.palette import colour_of

CLASSES = ["Chair", "Table", "Bed", "Couch", "Kitchen", "Beer", "Door", "Lamp", "Book", "3Three_Dim_Size"]


def test_a_class_keeps_its_colour_for_ever():
    assert colour_of("Chair") == (153, 215, 145)


@pytest.mark.parametrize("name", CLASSES)
def test_colours_are_neither_dark_nor_white(name):
    red, green, blue = colour_of(name)
    assert 110 < 0.2126 * red + 0.7152 * green + 0.0722 * blue < 235
    assert all(0 <= channel <= 255 for channel in (red, green, blue))


def test_classes_are_told_apart():
    assert all(colour_of(a) != colour_of(b) for a, b in combinations(CLASSES, 2))
