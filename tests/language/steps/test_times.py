"""Expressions of time at the beginning of some words, and words that only look like one."""

import pytest

from semmap.nodes.language.lexicon import commands
from semmap.nodes.language.steps import tokens
from semmap.nodes.language.steps.times import starts_time


def time_of(text):
    """Return the words of the expression of time with which a text begins."""
    read = tokens.read(text)
    return " ".join(read.words[: starts_time(commands.load(), read.words, 0)])


@pytest.mark.parametrize(
    "text",
    [
        "at ten o'clock | take it",
        "at half past ten | take it",
        "at a quarter past ten",
        "at quarter to ten",
        "at half ten",
        "at noon | go",
        "until night",
        "by about noon",
        "before noon",
        "from five",
        "at 10:30 | take it",
        "at 10.30 am | take it",
        "around 5 pm",
        "around exactly 5 pm",
        "at 5",
        "at ten | please",
        "at five | tomorrow",
        "at ten | , then take it",
        "at ten | go to the kitchen",
        "in five minutes | open it",
        "in an hour",
        "in a few minutes | open it",
        "in a couple of minutes",
        "in the next hour",
        "in about ten minutes",
        "in half an hour",
        "in a quarter of an hour | open it",
        "within three quarters of an hour",
        "for an hour and a half | follow her",
        "by tonight",
        "before tomorrow morning | take it",
        "within two hours",
        "after ten minutes",
        "for ten seconds",
        "for a minute",
        "in the morning | open it",
        "during the night",
        "every morning | open it",
        "every day",
        "every monday morning | open it",
        "every two days",
        "each evening",
        "this evening",
        "next week",
        "on monday | open it",
        "on monday morning",
        "on sundays",
        "three times | a day",
        "tomorrow | open it",
        "today",
        "tomorrow morning | open it",
    ],
)
def test_a_time_ends_where_the_rest_of_the_command_begins(text):
    time, _, rest = text.partition(" | ")
    assert time_of(f"{time} {rest}") == time


@pytest.mark.parametrize(
    "text",
    [
        "",
        "now",
        "at the table",
        "at half past the door",
        "at ten tables",
        "past the door",
        "in the kitchen",
        "in five cups",
        "in minutes",
        "for the evening",
        "before the evening",
        "from ten to the desk",
        "on",
        "on the table",
        "on evening",
        "every cup",
        "every two cups",
        "this cup",
        "three cups",
        "minutes",
        "take it",
    ],
)
def test_a_place_or_a_number_of_things_is_not_a_time(text):
    assert time_of(text) == ""


def test_a_bare_number_after_at_is_a_time_only_where_a_clause_begins():
    words = tokens.read("put it at ten go").words
    assert starts_time(commands.load(), words, 2) == 0
    words = tokens.read("put it there and at ten go home").words
    assert starts_time(commands.load(), words, 4) == 2
