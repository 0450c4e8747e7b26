"""Corrections: what replaces other words, and what was taken back."""

import pytest


def texts(understood):
    return [step.text for step in understood.steps]


@pytest.mark.parametrize(
    ("text", "step", "doubt"),
    [
        (
            "take the red cup, no, the blue one",
            "Taking(Theme=bluecup)",
            "'the red cup' is corrected to 'the blue one'",
        ),
        (
            "take the red cup, I mean blue",
            "Taking(Theme=bluecup)",
            "'the red cup' is corrected to 'blue'",
        ),
        (
            "take the kettle, sorry, I meant the bowl",
            "Taking(Theme=bowl1)",
            "'the kettle' is corrected to 'the bowl'",
        ),
        (
            "go to the kitchen, wait, no, to the studio",
            "Motion(Goal=studio1)",
            "'to the kitchen' is corrected to 'to the studio'",
        ),
        (
            "put the milk on the table, or rather on the desk",
            "Placing(Theme=milk1, Goal=desk1)",
            "'on the table' is corrected to 'on the desk'",
        ),
        (
            "put the milk on the table, no, the desk",
            "Placing(Theme=milk1, Goal=desk1)",
            "'on the table' is corrected to 'the desk'",
        ),
        (
            "put the milk on the table, no, the kettle",
            "Placing(Theme=kettle1, Goal=table1)",
            "'the milk' is corrected to 'the kettle'",
        ),
        (
            "bring the milk to me, no, to Nora",
            "Bringing(Theme=milk1, Beneficiary=nora1)",
            "'to me' is corrected to 'to Nora'",
        ),
        (
            "take the kettle. No, the bowl.",
            "Taking(Theme=bowl1)",
            "'the kettle' is corrected to 'the bowl'",
        ),
        (
            "open the oven. No, forget that, close the fridge.",
            "Closure(Containing_object=fridge1)",
            "'open the oven' is corrected to 'close the fridge'",
        ),
        (
            "open the oven, no wait, go to the kitchen",
            "Motion(Goal=kitchen1)",
            "'open the oven' is corrected to 'go to the kitchen'",
        ),
    ],
)
def test_what_follows_a_correction_replaces_the_last_words_of_its_kind(read, text, step, doubt):
    understood = read(text)
    assert texts(understood) == [step]
    assert understood.doubts == (doubt,)


@pytest.mark.parametrize(
    ("text", "steps"),
    [
        ("take the cups, no more than two of them", 1),
        ("take the milk. Sorry, could you also open the fridge?", 2),
        ("take no milk", 1),
        ("no, take the milk", 1),
    ],
)
def test_not_every_no_or_sorry_is_a_correction(read, text, steps):
    understood = read(text)
    assert len(understood.steps) == steps
    assert not any("corrected" in doubt for doubt in understood.doubts)


def test_a_drink_without_an_article_after_no_is_an_exception(read):
    understood = read("bring me something to drink, no milk")
    assert "corrected" not in " ".join(understood.doubts)
    assert "milk1" not in understood.steps[0].roles["Theme"][0].entities or understood.doubts


@pytest.mark.parametrize(
    "text",
    [
        "take the kettle, uh, no, the bowl",
        "take the kettle uh sorry the bowl",
        "take the kettle, um, I mean the bowl",
        "take the kettle, er, actually, the bowl",
        "take the kettle, uh, rather the bowl",
        "prendi il bollitore, ehm, no, la ciotola",
        "prendi il bollitore ehm scusa la ciotola",
        "prendi il bollitore, ehm, anzi la ciotola",
        "prendi il bollitore, cioè, la ciotola",
    ],
)
def test_hesitation_before_a_correction_does_not_hide_it(read, text):
    understood = read(text)
    assert texts(understood) == ["Taking(Theme=bowl1)"]
    assert [doubt for doubt in understood.doubts if "is corrected to" in doubt] == list(understood.doubts)


@pytest.mark.parametrize("text", ["um, take the milk", "take, uh, the milk", "take the, er, milk"])
def test_hesitation_is_left_out(read, text):
    understood = read(text)
    assert texts(understood) == ["Taking(Theme=milk1)"]
    assert (understood.doubts, understood.unknown) == ((), ())
