"""Which things are meant."""

import random

import pytest

from nodes.language.understanding.grounding import Thing, called
from tests.language.household import LEXICON, THINGS, there


def names(text, things=THINGS):
    return sorted(thing.name for thing in called(text, there(things), LEXICON))


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
