"""Summaries of the map: grouped, counted, and within the word limit."""

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.language.generation import summary
from semmap.nodes.language.generation.inventory import Inventory, Place, Thing


def kitchen():
    """A table with four chairs, plates, and a bowl with an apple; a counter; a fridge."""
    here = {"place": "corner1"}
    there = {"place": "kitchen1"}
    return Inventory(
        [
            Thing("table1", "table", volume_m3=0.7, **here),
            *(Thing(f"chair{n}", "chair", volume_m3=0.2, at=("round", "table1"), **here) for n in range(4)),
            Thing("plate1", "plate", at=("on", "table1"), **here),
            Thing("plate2", "plate", at=("on", "table1"), **here),
            Thing("bowl1", "bowl", at=("on", "table1"), volume_m3=0.004, **here),
            Thing("apple1", "apple", at=("in", "bowl1"), **here),
            Thing("fridge1", "fridge", volume_m3=0.7, **there),
            Thing("milk1", "milk", at=("in", "fridge1"), **there),
            Thing("lamp1", "lamp", state="switched on", **there),
            Thing("door1", "door", fixed=True, volume_m3=1.0, **there),
            Thing("kite1", "kite"),
        ],
        [
            Place("flat1", "flat"),
            Place("kitchen1", "kitchen", "flat1"),
            Place("corner1", "dining corner", "kitchen1"),
        ],
    )


def test_of_an_empty_map_nothing_is_left_out():
    assert summary.summarize_map(Inventory((), ()), (), 100) == ("The map is empty.", 0)


WHOLE = (
    "The map has 3 places and 14 things."
    " The kitchen has a fridge, a lamp that is switched on and a door. In the fridge is milk."
    " The dining corner of the kitchen has a table with 4 chairs round it."
    " On the table are a bowl with an apple in it and 2 plates."
    " Outside all places is a kite."
)


def test_similar_things_are_counted_by_place():
    assert summary.summarize_map(kitchen(), (), 500) == (WHOLE, 0)


@pytest.mark.parametrize(
    ("words", "text", "left_out"),
    [
        (
            20,
            "The map has 3 places and 14 things. There are 4 chairs, 2 plates, an apple and 7 other things.",
            7,
        ),
        (
            40,
            "The map has 3 places and 14 things. The kitchen has 4 things. The dining corner of the kitchen"
            " has a table with 4 chairs round it and 4 other things. Outside all places is one thing.",
            9,
        ),
    ],
)
def test_things_beyond_the_word_limit_are_counted(words, text, left_out):
    assert summary.summarize_map(kitchen(), (), words) == (text, left_out)


def test_problems_come_first():
    troubles = ["cup1, not seen where it should stand", "cup2, looks like a Vase"]
    text, _ = summary.summarize_map(kitchen(), troubles, 60)
    assert " things. Problems: cup1, not seen where it should stand; cup2, looks like a Vase. The" in text
    text, _ = summary.summarize_map(kitchen(), troubles * 20, 30)
    assert "things. Problems: cup1, not seen where it should stand; and 39 more. There" in text
    text, _ = summary.summarize_map(kitchen(), ["word " * 9] * 40, 20)
    assert "things. There are 40 problems." in text


def test_a_place_and_a_thing():
    inventory = kitchen()
    assert summary.summarize_place(inventory, "corner1", (), 100).text == (
        "The dining corner (corner1) is in the kitchen. It has a table with 4 chairs round it."
        " On the table are a bowl with an apple in it and 2 plates."
    )
    assert summary.summarize_place(inventory, "kitchen1", (), 20).text.startswith(
        "The kitchen (kitchen1) in the flat has 13 things. There are 4 chairs, 2 plates"
    )
    assert summary.summarize_thing(inventory, "table1", ["This is a table."], ["It is old."], 100).text == (
        "This is a table. Round it are 4 chairs. On it are a bowl with an apple in it and 2 plates."
        " It is old."
    )
    assert summary.summarize_thing(inventory, "kite1", ["kite1 is a kite."], (), 20) == (
        "kite1 is a kite.",
        0,
    )


def test_nothing_at_all_and_places_alone():
    assert summary.summarize_map(Inventory([]), (), 20).text == "The map is empty."
    places = Inventory([], [Place("hall1", "hall"), Place("hall2", "hall")])
    assert summary.summarize_map(places, (), 20).text == "The map has 2 places."
    assert summary.summarize_place(places, "hall1", (), 20).text == "The hall hall1 has no things."
    assert summary.summarize_map(Inventory([Thing("cup1", "cup")]), (), 20).text == (
        "The map has one thing. There is a cup."
    )


def test_cycles_of_supports_are_listed_once():
    things = [
        Thing("a", "book", at=("on", "b")),
        Thing("b", "book", at=("on", "a")),
        Thing("c", "cup", at=("on", "c")),
        Thing("d", "dish", at=("on", "missing")),
    ]
    assert summary.summarize_map(Inventory(things), (), 100) == (
        "The map has 4 things. There are 2 books, a cup and a dish.",
        0,
    )
    around = [Place("p", "hall", "q"), Place("q", "attic", "p")]
    text, left_out = summary.summarize_map(Inventory([Thing("e", "egg", place="p")], around), (), 100)
    assert "has an egg" in text
    assert left_out == 0


def drawn(seed, count):
    """Return a random map: places within places, things on, in and round things."""
    rng = random.Random(seed)
    places = [
        Place(f"p{n}", rng.choice(["hall", "attic"]), f"p{n - 1}" if n and rng.random() < 0.5 else None)
        for n in range(5)
    ]
    names = [f"t{n}" for n in range(count)]
    return Inventory(
        [
            Thing(
                name,
                rng.choice(["cup", "table", "milk", "keys", "open box"]),
                rng.choice(["", "", "open"]),
                rng.choice([None, "p0", "p1", "p4", "nowhere"]),
                rng.choice(
                    [
                        None,
                        None,
                        ("on", rng.choice(names)),
                        ("in", rng.choice(names)),
                        ("round", rng.choice(names)),
                    ]
                ),
                rng.random(),
                rng.random() < 0.2,
            )
            for name in names
        ],
        places,
    )


@given(st.integers(0, 10_000), st.integers(1, 40), st.integers(20, 400))
def test_no_text_is_longer_than_its_budget_and_none_loses_a_thing(seed, count, words):
    inventory = drawn(seed, count)
    found = summary.summarize_map(inventory, (), words)
    assert len(found.text.split()) <= words
    assert 0 <= found.left_out <= count
    for name in inventory.places:
        assert len(summary.summarize_place(inventory, name, (), words).text.split()) <= words
    assert (
        sum(group.all for place in (*inventory.places, None) for group in inventory.standing_in(place))
        == count
    )
