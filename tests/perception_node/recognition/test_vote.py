import pytest

from nodes.perception_node.recognition.vote import answer

ABOVE = {
    "Fork": ("Cutlery", "Tableware", "Object"),
    "Spoon": ("Cutlery", "Tableware", "Object"),
    "Plate": ("Tableware", "Object"),
    "Book": ("Object",),
    "Magazine": ("Book", "Object"),
}


@pytest.mark.parametrize(
    ("leaves", "said", "probability"),
    [
        ({"Fork": 0.9, "Spoon": 0.1}, "Fork", 0.9),
        ({"Fork": 0.5, "Spoon": 0.4, "Book": 0.1}, "Cutlery", 0.9),
        ({"Fork": 0.3, "Spoon": 0.2, "Plate": 0.3, "Book": 0.2}, "Tableware", 0.8),
        ({"Magazine": 0.45, "Book": 0.4, "Fork": 0.15}, "Book", 0.85),
        ({"Fork": 0.65, "Spoon": 0.35}, "Cutlery", 1.0),
        ({"Fork": 0.3, "Book": 0.3, "Object": 0.4}, "Object", 1.0),
        ({"Fork": 0.2, "Object": 0.8}, "Object", 1.0),
    ],
)
def test_the_most_special_class_that_is_sure_enough(leaves, said, probability):
    class_, sure = answer(leaves, ABOVE, 0.6)
    assert (class_, sure) == (said, pytest.approx(probability))


def test_of_two_that_are_sure_the_likelier():
    assert answer({"Fork": 0.5, "Book": 0.5}, ABOVE, 0.5)[0] in ("Fork", "Book")
    assert answer({"Fork": 0.45, "Book": 0.55}, ABOVE, 0.4)[0] == "Book"
