"""Words, their base forms and parts of speech."""

import pytest

from semmap.nodes.language.words import lemma, split, tag
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
        ("go to the kitchen find a glass", "verb prep det noun verb det noun"),
        ("the watch is here", "det noun aux adv"),
        ("watch the tv", "verb det noun"),
        ("enter by the back door", "verb prep det adj noun"),
        ("the laptop that is on it", "det noun rel aux prep pron"),
        ("bring me the novel and the bottle", "verb pron det noun conj det noun"),
        ("take the bottle and the novel to the kitchen", "verb det noun conj det noun prep det noun"),
        (
            "take the mug from the table in the kitchen to the sofa",
            "verb det noun prep det noun prep det noun prep det noun",
        ),
        ("open the door of the fridge", "verb det noun prep det noun"),
        ("open the fridge door", "verb det noun noun"),
        ("close the fridge and switch on the lamp", "verb det noun conj verb particle det noun"),
        ("take the blue cup and the red one", "verb det adj noun conj det adj num"),
        ("bring two books to the sofa", "verb num noun prep det noun"),
        (
            "put the book that is on the table into the fridge",
            "verb det noun rel aux prep det noun prep det noun",
        ),
        ("put it on the table", "verb pron prep det noun"),
        ("could you please go to the kitchen", "modal pron modal verb prep det noun"),
        (
            "go to the kitchen, take the bottle and bring it here",
            "verb prep det noun verb det noun conj verb pron adv",
        ),
        ("let me see the book", "verb pron verb det noun"),
        ("please follow the person slowly to the kitchen", "modal verb det noun adv prep det noun"),
        ("turn on the tv in the living room", "verb particle det noun prep det noun noun"),
        ("the book is on the table", "det noun aux prep det noun"),
        ("is the book on the table", "aux det noun prep det noun"),
        (
            "do not take the bottle and do not open the fridge",
            "modal neg verb det noun conj modal neg verb det noun",
        ),
        ("find the book near the fridge", "verb det noun prep det noun"),
        (
            "search for the bottle in the kitchen and in the bedroom",
            "verb prep det noun prep det noun conj prep det noun",
        ),
        ("check the state of the lamp", "verb det noun prep det noun"),
        ("drop the bottle onto the floor", "verb det noun prep det noun"),
        ("give the book to the man", "verb det noun prep det noun"),
        ("give me the book", "verb pron det noun"),
        ("hand him the novel", "verb pron det noun"),
        ("move along the wall", "verb prep det noun"),
        ("move away from the table", "verb prep prep det noun"),
        ("move the chair next to the table", "verb det noun prep prep det noun"),
        ("turn to the left", "verb prep det noun"),
        ("this is a table", "det aux det noun"),
        ("we are in the kitchen", "pron aux prep det noun"),
        ("look at the picture", "verb prep det noun"),
        ("inspect the oven", "verb det noun"),
        ("release the bottle", "verb det noun"),
        ("grasp the handle of the fridge", "verb det noun prep det noun"),
        ("carry the mug with you to the kitchen", "verb det noun prep pron prep det noun"),
        ("come with me to the kitchen", "verb prep pron prep det noun"),
        ("put the books on the table under the lamp", "verb det noun prep det noun prep det noun"),
        ("take it to the kitchen", "verb pron prep det noun"),
        ("bring the box with the books to me", "verb det noun prep det noun prep pron"),
        ("bring the book or the bottle to the table", "verb det noun conj det noun prep det noun"),
        ("frobnicate the book", "verb det noun"),
        ("take the unicorn", "verb det noun"),
        ("take a book", "verb det noun"),
        ("take any book", "verb det noun"),
        ("the green bottle, take it", "det adj noun verb pron"),
        ("robot, can you open the door for me", "noun modal pron verb det noun prep pron"),
        (
            "i want you to bring the newspaper near the couch",
            "pron modal pron prep verb det noun prep det noun",
        ),
        ("please find a glass on the floor", "modal verb det noun prep det noun"),
        ("start the tv", "verb det noun"),
        ("walk to the second room", "verb prep det adj noun"),
        ("is this the kitchen", "aux det det noun"),
        ("which book is on the table", "rel noun aux prep det noun"),
        ("that cup", "det noun"),
        ("can you see it", "modal pron verb pron"),
        ("the can is empty", "det noun aux adj"),
        ("switch it off please", "verb pron particle modal"),
        ("the red book", "det adj noun"),
        ("the red one", "det adj num"),
        ("open the open window", "verb det adj noun"),
        ("3 cups", "num noun"),
        ("go forward", "verb adv"),
        ("put down the book", "verb particle det noun"),
        ("the small wooden table", "det adj adj noun"),
        ("one of them", "pron prep pron"),
        ("go there and wait", "verb adv conj verb"),
    ],
)
def test_parts_of_speech_follow_from_the_words_around(text, kinds):
    assert " ".join(word.kind for word in tag(split(text), LEXICON)) == kinds


def test_an_unknown_verb_is_a_verb():
    word = tag(split("frobnicate the cup"), LEXICON)[0]
    assert (word.kind, word.lemma) == ("verb", "frobnicate")
    assert word.lemma not in LEXICON.frames
