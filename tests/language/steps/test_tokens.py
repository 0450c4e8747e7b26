"""The words of a command without sounds of hesitation; a comma that separates clauses is kept."""

import pytest

from semmap.nodes.language.steps import tokens


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("go to the kitchen, um, close the door", "go to the kitchen , close the door"),
        ("go to the kitchen um close the door", "go to the kitchen , close the door"),
        ("go there, uh, er, follow Anna", "go there , follow anna"),
        ("go there, um, and close the door", "go there and close the door"),
        ("could you, um, close the door", "could you close the door"),
        ("do not, er, open the door", "do n't open the door"),
        ("take the, um, light to the hall", "take the light to the hall"),
        ("take the red, um, book, please", "take the red book , please"),
        ("um, take it, uh", "take it"),
        ("take the milk, the bread", "take the milk , the bread"),
        ("take the cup, uh, no, the bowl", "take the cup , no , the bowl"),
        ("take the cup uh sorry the bowl", "take the cup , sorry the bowl"),
        ("take the cup, um, I mean the bowl", "take the cup , i mean the bowl"),
        ("there is, uh, no milk", "there is no milk"),
        ("um", ""),
    ],
)
def test_hesitation_between_clauses_leaves_one_comma(text, words):
    assert " ".join(tokens.read(text).words).replace("do not", "do n't") == words
