"""Moods of sentences."""

import pytest

from semmap.nodes.language.understanding.interpretation import shipped
from tests.language.household import there


@pytest.mark.parametrize(
    ("text", "mood"),
    [
        ("how are you", "question"),
        ("robot, where is the bottle?", "question"),
        ("what can you do", "question"),
        ("which bottle is on the table", "question"),
        ("is the fridge open", "question"),
        ("are there any books in the kitchen", "question"),
        ("did you take the bottle", "question"),
        ("dov'è il libro", "question"),
        ("i took the bottle from the table", "past"),
        ("yesterday you took the bottle", "past"),
        ("the bottle was on the table", "past"),
        ("she has opened the fridge", "past"),
        ("i put the bottle on the table", "past"),
    ],
)
def test_other_moods_are_detected(text, mood):
    understood = shipped().understand(text, there())
    assert (understood.frames, understood.mood) == ((), mood)


@pytest.mark.parametrize(
    "text",
    [
        "why don't you open the fridge",
        "when you are in the kitchen take the bottle",
        "can you take the bottle",
        "do you think you can find the bottle",
        "there is a bottle on the table",
        "the bottle is on the table",
        "i lost my book can you find it",
    ],
)
def test_what_looks_like_a_question_or_the_past_may_be_a_command(text):
    understood = shipped().understand(text, there())
    assert understood.frames
    assert understood.mood == "command"
