"""The law of a command: each of its words is in a step, or in a doubt, `unknown` or the question."""

import re

import msgspec
import pytest

from semmap.nodes.language.steps import tokens

COMMANDS = (
    "take the red cup from the table and bring it to Nora",
    "please go to the kitchen, find the kettle and put it on the desk",
    "give Nora the milk and tell her the time",
    "if Nora is in the kitchen, take the plates to the sink",
    "do not open the oven but close the fridge",
    "could you follow Nora to the sofa in ten minutes",
    "take all cups except the red one, no, the blue one",
    "guide the person in the red shirt from the kitchen to the sofa",
    "tell me how many books are on the desk",
    "pick the milk up and put the cup away",
    "I would like a glass of water",
    "search the kitchen for a cup",
)
_STRUCTURE = "the a of and it in to if is do but not could you please i would like for me all no or"


def named(understood):
    """Return the words of all that is returned for a command but its frames."""
    parts = (understood.steps, understood.doubts, understood.unknown, understood.question)
    return set(re.findall(r"[\w-]+", msgspec.json.encode(parts).decode().lower()))


@pytest.mark.parametrize("text", COMMANDS)
def test_a_word_that_means_nothing_is_in_a_step_or_named_wherever_it_stands(read, text):
    words = text.split()
    for i in range(len(words) + 1):
        changed = " ".join((*words[:i], "zorp", *words[i:]))
        assert "zorp" in named(read(changed)), changed


@pytest.mark.parametrize("text", COMMANDS)
def test_every_verb_noun_and_attribute_is_in_a_step_or_named(read, text):
    structure = set(_STRUCTURE.split())
    content = {word for word in tokens.read(text).words if word.isalpha()} - structure
    assert content <= named(read(text))


@pytest.mark.parametrize("text", ["you do not have to bring the milk", "I don't want you to bring the milk"])
def test_what_is_not_wanted_is_negated(read, text):
    assert [step.text for step in read(text).steps] == ["not Bringing(Theme=milk1)"]


@pytest.mark.parametrize(
    ("text", "lost"),
    [
        ("go to the kitchen using the back door", "using the back door"),
        ("take the milk xylophonically", "xylophonically"),
    ],
)
def test_words_that_are_not_understood_are_quoted(read, text, lost):
    understood = read(text)
    assert any(word in " ".join((*understood.doubts, *understood.unknown)) for word in lost.split())
