"""Questions about states and qualities: answered from the map, or that it is not known."""

import pytest

from tests.language.steps.test_quantities import texts


@pytest.mark.parametrize(
    ("text", "answer"),
    [
        ("is the fridge open?", "it is not known whether fridge1 is open; look there"),
        ("isn't the fridge open?", "it is not known whether fridge1 is open; look there"),
        ("the fridge is open?", "it is not known whether fridge1 is open; look there"),
        ("is the fridge in the kitchen still open?", "it is not known whether fridge1 is open; look there"),
        ("is the fridge open or closed?", "it is not known whether fridge1 is open or closed; look there"),
        ("is the fridge open or not?", "it is not known whether fridge1 is open; look there"),
        ("is there an open fridge?", "it is not known whether fridge1 is open; look there"),
        ("is the door of the fridge open?", "it is not known whether fridge1 is open; look there"),
        ("is the oven hot?", "it is not known whether oven1 is hot; look there"),
        ("is the light on?", "yes: light1"),
        ("is the light turned on?", "yes: light1"),
        ("is the light off?", "no: light1 is not off"),
        ("is the light on or off?", "light1 is on"),
        ("is the oven not on?", "yes: oven1"),
        ("is the oven off and the light on?", "yes: oven1; yes: light1"),
        ("are the oven and the stove off?", "yes: oven1; yes: stove1"),
        ("are the plates and the glass on the table?", "yes: plate1, plate2; yes: glass1"),
        ("is the red cup red?", "yes: redcup"),
        ("is the red cup blue?", "no: redcup is not blue"),
        ("is the red cup not red?", "no: redcup is red"),
        ("is the red cup blue or red?", "redcup is red"),
        ("are the cups red?", "no: bluecup is not red"),
        ("are any cups red?", "yes: redcup"),
        ("is there a green cup?", "it is not known whether cup1 is green; look there"),
        ("is the bowl empty?", "no: bowl1 is not empty"),
        ("is Nora sitting?", "'Nora sitting': the map cannot tell; look there"),
        ("il frigo è aperto?", "it is not known whether fridge1 is open; look there"),
        ("è aperto il frigo?", "it is not known whether fridge1 is open; look there"),
        ("il frigo non è aperto?", "it is not known whether fridge1 is not open; look there"),
        ("il forno è spento?", "yes: oven1"),
        ("è acceso il forno?", "no: oven1 is not on"),
        ("le tazze sono rosse?", "no: bluecup is not red"),
    ],
)
def test_a_question_for_a_state_is_answered_from_the_map(read, text, answer):
    understood = read(text)
    assert (understood.mood, understood.answer, understood.unknown) == ("question", answer, ())
    assert not any("understood" in doubt for doubt in understood.doubts)


def test_a_pronoun_in_a_question_for_a_state_is_what_was_mentioned(read):
    understood = read("go to the oven. is it on?")
    assert (understood.answer, understood.doubts) == ("no: oven1 is not on", ())


@pytest.mark.parametrize("text", ["are the drawers shut?", "i cassetti sono chiusi?"])
def test_a_question_about_unknown_things_says_so(read, text):
    understood = read(text)
    assert understood.answer.endswith("none is known; look there")
    assert understood.doubts[0].endswith("no drawer is known")


@pytest.mark.parametrize(
    ("text", "steps"),
    [
        (
            "go to the kitchen, um, close the fridge",
            ["Motion(Goal=kitchen1)", "Closure(Containing_object=fridge1)"],
        ),
        (
            "vai in cucina, ehm, chiudi il frigo",
            ["Motion(Goal=kitchen1)", "Closure(Containing_object=fridge1)"],
        ),
        ("prendi la, ehm, tazza rossa", ["Taking(Theme=redcup)"]),
    ],
)
def test_hesitation_is_lost_and_nothing_else(read, text, steps):
    understood = read(text)
    assert (texts(understood), understood.doubts, understood.unknown) == (steps, (), ())
