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
        ("is the bowl full and clean?", "it is not known whether bowl1 is full and clean; look there"),
        ("is the oven on and clean?", "no: oven1 is not on"),
        (
            "is the cup clean, dry and empty?",
            "it is not known whether cup1 is clean and dry and empty; look there",
        ),
        ("is the fridge in the kitchen and open?", "it is not known whether fridge1 is open; look there"),
        ("the fridge is open and clean?", "it is not known whether fridge1 is open and clean; look there"),
        ("il frigo è aperto e pulito?", "it is not known whether fridge1 is open and clean; look there"),
        ("è aperto il frigo e pulito?", "it is not known whether fridge1 is open and clean; look there"),
        ("is the milk or the bread on the desk?", "no: milk1 is on counter1; no: bread1 is on counter1"),
        ("are any cups red and clean?", "'any cups red and clean': the map cannot tell; look there"),
        ("is the light off now?", "no: light1 is not off"),
        ("is the light off please?", "no: light1 is not off"),
        ("is the light really off?", "no: light1 is not off"),
        ("is the light not on anymore?", "no: light1 is on"),
        ("la luce è spenta adesso?", "no: light1 is not off"),
        ("la luce è ancora accesa?", "yes: light1"),
        ("la luce è già spenta?", "no: light1 is not off"),
        ("is there the milk?", "yes: milk1"),
        ("c'è il latte?", "yes: milk1"),
        ("is there the milk and the bread?", "yes: milk1; yes: bread1"),
        ("is the milk?", "'the milk': the map cannot tell; look there"),
        ("is the red cup bigger?", "it is not known whether redcup is bigger; look there"),
        (
            "is the red cup bigger than the blue cup?",
            "it is not known whether redcup is bigger than the blue cup; look there",
        ),
        ("is the table the smallest?", "it is not known whether table1 is the smallest; look there"),
        ("il tavolo è il più piccolo?", "it is not known whether table1 is the smallest; look there"),
    ],
)
def test_a_question_for_a_state_is_answered_from_the_map(read, text, answer):
    understood = read(text)
    assert (understood.mood, understood.answer, understood.unknown) == ("question", answer, ())
    assert not any("understood" in doubt for doubt in understood.doubts)


@pytest.mark.parametrize("text", ["is the light off in the kitchen?", "la luce è accesa in cucina?"])
def test_a_place_after_a_state_is_where_the_thing_has_to_be(read, text):
    understood = read(text)
    assert (understood.answer.endswith("the map cannot tell; look there"), understood.doubts) == (True, ())


@pytest.mark.parametrize(
    "text",
    ["is the light off foo?", "is the light in the house off foo bar?", "is the milk there?"],
)
def test_words_that_are_not_understood_are_not_answered_yes(read, text):
    understood = read(text)
    assert not understood.answer.startswith("yes")
    assert "look there" in understood.answer


@pytest.mark.parametrize(
    "text",
    [
        "is the oven off and then clean?",
        "is the oven off, clean?",
        "is the bowl full or empty and clean?",
        "is the fridge open, close it?",
        "is the oven off and look in the kitchen?",
        "è spento il forno e poi pulisci?",
    ],
)
def test_a_question_with_is_makes_no_other_step_and_says_what_is_not_understood(read, text):
    understood = read(text)
    assert [step.frame for step in understood.steps] == ["Telling"]
    assert any("not understood" in doubt for doubt in understood.doubts)


def test_a_request_after_a_question_is_a_step(read):
    understood = read("is the oven off and can you clean it?")
    assert texts(understood)[1:] == ["Cleaning(Theme=oven1)"]


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
