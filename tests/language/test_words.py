"""Words, their base forms and parts of speech."""

import pytest

from nodes.language.words import lemma, split, tag
from tests.language.household import LEXICON


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("Take the cup, please!", ["take", "the", "cup", "please"]),
        ("Don't go; it's hot", ["do", "n't", "go", "it", "'s", "hot"]),
        ("turn 90 degrees", ["turn", "90", "degrees"]),
        ("the t-shirt\tin\nthe caffè", ["the", "t-shirt", "in", "the", "caffè"]),
        ("<b>go</b> \x1b[31m 🤖", ["go"]),
        ("", []),
    ],
)
def test_a_text_is_split_into_words(text, words):
    assert split(text) == words


@pytest.mark.parametrize(
    ("word", "base"),
    [("knives", "knife"), ("boxes", "box"), ("cups", "cup"), ("glass", "glass"), ("took", "take")],
)
def test_base_forms(word, base):
    assert lemma(word, LEXICON) == base


@pytest.mark.parametrize(
    ("text", "kinds"),
    [
        ("take the book", "verb det noun"),
        ("the book is red", "det noun aux adj"),
        ("book the table", "verb det noun"),  # no verb of ours, but where one stands
        ("the light is on", "det noun aux particle"),
        ("turn on the light", "verb particle det noun"),
        ("put it on the table", "verb pron prep det noun"),
        ("go to the kitchen find a glass", "verb prep det noun verb det noun"),
        ("the watch is here", "det noun aux adv"),
        ("watch the tv", "verb det noun"),
        ("enter by the back door", "verb prep det adj noun"),
        ("the laptop that is on it", "det noun rel aux prep pron"),
    ],
)
def test_parts_of_speech_follow_from_the_words_around(text, kinds):
    assert " ".join(word.kind for word in tag(split(text), LEXICON)) == kinds


def test_a_verb_that_nobody_knows_is_still_one():
    word = tag(split("frobnicate the cup"), LEXICON)[0]
    assert (word.kind, word.lemma) == ("verb", "frobnicate")
    assert word.lemma not in LEXICON.frames
