"""Grounding of phrases in the entities of a map."""

import math
import random

import pytest

from semmap.nodes.language.understanding.grounding import Thing, distance, find_by_label
from semmap.nodes.language.understanding.interpretation import shipped
from tests.language.household import LEXICON, THINGS, there


def names(text, things=THINGS):
    return sorted(thing.name for thing in find_by_label(text, there(things), LEXICON))


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("novel", ["book1"]),  # a reference
        ("books", ["book1"]),  # a class, in the plural
        ("table", ["table2"]),  # the class itself before its subclasses
        ("sofa", ["couch1"]),  # a synonym
        ("divano", ["couch1"]),  # a label in another language
        ("refrigerator", ["fridge1"]),
        ("unicorn", []),
        ("", []),
    ],
)
def test_by_reference_class_label_and_synonym(text, found):
    assert names(text) == found


def test_what_is_of_no_class_of_its_own_is_what_its_superclass_is():
    assert names("laptop", (Thing("pc1", "Computer"),)) == ["pc1"]
    assert names("cup", (Thing("thing1", "Object"),)) == []


def test_neither_order_nor_names_of_things_matter():
    shuffled = random.Random(3).sample(THINGS, len(THINGS))
    for text in ("novel", "table", "couch", "vessel"):
        assert names(text) == names(text, shuffled)


LAMPS = (*THINGS, Thing("lamp1", "Lamp", ("big red lamp",)), Thing("lamp2", "Lamp", ("red lamp",)))


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("take the big red lamp", "lamp1"),
        ("take the small red lamp", "lamp2"),
        ("take the old side table", "table2"),
        ("take the side table", "table2"),
        ("take the big kitchen table", "table1"),
        ("take the wooden kitchen table", "table1"),
        ("take the green bottle", "bottle1"),
    ],
)
def test_several_words_of_a_phrase_together_tell_first_the_longest(text, name):
    (frame,) = shipped().understand(text, there(LAMPS)).frames
    assert [argument.entity for argument in frame.arguments] == [name]


def test_the_distance_is_over_the_ground_and_infinite_where_a_place_is_not_known():
    low, high = Thing("a", "Cup", (), (0.0, 0.0, 0.0)), Thing("b", "Cup", (), (3.0, 4.0, 9.0))
    assert distance(low, high) == distance(high, low) == 5.0
    assert distance(low, Thing("c", "Cup")) == distance(Thing("c", "Cup"), low) == math.inf


def test_a_thing_has_its_classes_and_those_above():
    scene = there((Thing("pc1", "Computer", (), None, ("Heavy",)),))
    assert {"Computer", "Heavy"} <= scene.kinds_of("pc1")
    assert scene.kinds_of("missing") == frozenset()
