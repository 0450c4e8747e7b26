"""Articles, plurals, numbers and lists."""

import pytest

from semmap.nodes.language import nouns


@pytest.mark.parametrize(
    ("noun", "one", "two"),
    [
        ("chair", "a chair", "2 chairs"),
        ("apple", "an apple", "2 apples"),
        ("bookshelf", "a bookshelf", "2 bookshelves"),
        ("shelf", "a shelf", "2 shelves"),
        ("coat rack", "a coat rack", "2 coat racks"),
        ("dish", "a dish", "2 dishes"),
        ("box", "a box", "2 boxes"),
        ("glass", "a glass", "2 glasses"),
        ("pantry", "a pantry", "2 pantries"),
        ("toy", "a toy", "2 toys"),
        ("knife", "a knife", "2 knives"),
        ("person", "a person", "2 people"),
        ("tomato", "a tomato", "2 tomatoes"),
        ("umbrella", "an umbrella", "2 umbrellas"),
        ("utensil", "a utensil", "2 utensils"),
        ("unit", "a unit", "2 units"),
        ("hourglass", "an hourglass", "2 hourglasses"),
        ("T-shirt", "a T-shirt", "2 T-shirts"),
        ("milk", "milk", "milk (2)"),
        ("toilet paper", "toilet paper", "toilet paper (2)"),
        ("scissors", "scissors", "scissors (2)"),
    ],
)
def test_one_and_several(noun, one, two):
    assert (nouns.with_count(1, noun), nouns.with_count(2, noun)) == (one, two)


def test_numbers_and_lists():
    assert [nouns.with_number_word(n, "thing") for n in (0, 1, 2)] == ["no things", "one thing", "2 things"]
    assert nouns.enumerate_nouns([]) == ""
    assert nouns.enumerate_nouns(["a cup"]) == "a cup"
    assert nouns.enumerate_nouns(["a cup", "2 plates", "milk"]) == "a cup, 2 plates and milk"


def test_the_verb_agrees():
    assert not nouns.is_plural(1, "chair")
    assert not nouns.is_plural(1, "milk")
    assert nouns.is_plural(1, "scissors")
    assert nouns.is_plural(2, "chair")
