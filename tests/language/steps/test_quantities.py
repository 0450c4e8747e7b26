"""Quantities, exceptions and what verbs take with them: each word of a command is used or reported."""

import pytest


def texts(understood):
    return [step.text for step in understood.steps]


@pytest.mark.parametrize(
    ("text", "step"),
    [
        ("bring no more than two plates", "Bringing(Theme=at most 2 of plate1|plate2)"),
        (
            "bring me at least two cups",
            'Bringing(Beneficiary="me", Theme=at least 2 of bluecup|cup1|redcup)',
        ),
        ("bring me up to two cups", 'Bringing(Beneficiary="me", Theme=at most 2 of bluecup|cup1|redcup)'),
        (
            "bring me up to a dozen cups",
            'Bringing(Beneficiary="me", Theme=at most 12 of bluecup|cup1|redcup)',
        ),
        ("take at most half a dozen cups", "Taking(Theme=at most 6 of bluecup|cup1|redcup)"),
        ("take at most two dozen cups", "Taking(Theme=at most 24 of bluecup|cup1|redcup)"),
        ("take at most a couple of cups", "Taking(Theme=at most 2 of bluecup|cup1|redcup)"),
        ("take the cups, at most two of them", "Taking(Theme=at most 2 of bluecup|cup1|redcup)"),
        ("take the cups, up to a dozen", "Taking(Theme=at most 12 of bluecup|cup1|redcup)"),
        ("take the cups, two at most", "Taking(Theme=at most 2 of bluecup|cup1|redcup)"),
        ("pick up to two cups", "Taking(Theme=at most 2 of bluecup|cup1|redcup)"),
        ("count up to two cups", "Counting(Theme=at most 2 of bluecup|cup1|redcup)"),
        ("prendi fino a una dozzina di tazze", "Taking(Theme=at most 12 of bluecup|cup1|redcup)"),
        ("prendi un paio di tazze", "Taking(Theme=2 of bluecup|cup1|redcup)"),
        ("take more than two cups", "Taking(Theme=at least 3 of bluecup|cup1|redcup)"),
        ("take fewer than three cups", "Taking(Theme=at most 2 of bluecup|cup1|redcup)"),
        ("take two cups at most", "Taking(Theme=at most 2 of bluecup|cup1|redcup)"),
        ("take two cups or more", "Taking(Theme=at least 2 of bluecup|cup1|redcup)"),
        ("take two or three cups", "Taking(Theme=2 to 3 of bluecup|cup1|redcup)"),
        ("take between two and three cups", "Taking(Theme=2 to 3 of bluecup|cup1|redcup)"),
        ("take one or a couple of cups", "Taking(Theme=1 to 2 of bluecup|cup1|redcup)"),
        ("take between one and half a dozen cups", "Taking(Theme=1 to 6 of bluecup|cup1|redcup)"),
        ("take between two and a dozen cups", "Taking(Theme=2 to 12 of bluecup|cup1|redcup)"),
        ("take exactly two cups", "Taking(Theme=2 of bluecup|cup1|redcup)"),
        ("take two of the three cups", "Taking(Theme=2 of bluecup|cup1|redcup)"),
        ("take a few cups", "Taking(Theme=at least 2 of bluecup|cup1|redcup)"),
        ("take both plates", "Taking(Theme=plate1|plate2)"),
        ("bring both the red cup and the blue cup", "Bringing(Theme=redcup, Theme=bluecup)"),
        ("take half of the plates", "Taking(Theme=1 of plate1|plate2)"),
        ("take most of the cups", "Taking(Theme=at least 2 of bluecup|cup1|redcup)"),
        ("take all but one of the cups", "Taking(Theme=2 of bluecup|cup1|redcup)"),
        ("take all cups except two cups", "Taking(Theme=1 of bluecup|cup1|redcup)"),
        ("take none of the cups", "not Taking(Theme=bluecup|cup1|redcup)"),
        ("take neither cup", "not Taking(Theme=bluecup|cup1|redcup)"),
        ("take only the red cup", "Taking(Theme=redcup)"),
        ("put at most two cups on the table", "Placing(Theme=at most 2 of bluecup|cup1|redcup, Goal=table1)"),
        ("porta non più di due piatti", "Bringing(Theme=at most 2 of plate1|plate2)"),
        ("portami almeno due tazze", 'Bringing(Beneficiary="mi", Theme=at least 2 of bluecup|cup1|redcup)'),
        ("portami fino a due tazze", 'Bringing(Beneficiary="mi", Theme=at most 2 of bluecup|cup1|redcup)'),
        ("prendi al massimo una tazza", "Taking(Theme=at most 1 of bluecup|cup1|redcup)"),
        ("prendi la metà dei piatti", "Taking(Theme=1 of plate1|plate2)"),
        ("prendi nessuna delle tazze", "not Taking(Theme=bluecup|cup1|redcup)"),
        ("prendi solo la tazza rossa", "Taking(Theme=redcup)"),
    ],
)
def test_a_quantity_is_of_the_things_and_says_no_more(read, text, step):
    understood = read(text)
    assert (texts(understood), understood.doubts) == ([step], ())


@pytest.mark.parametrize("text", ["prendi una mezza dozzina di tazze", "take a half a dozen cups"])
def test_half_a_dozen_is_six(read, text):
    (theme,) = read(text).steps[0].roles["Theme"]
    assert theme.description.quantity == 6


@pytest.mark.parametrize("noun", ["Milk", "Apples"])
@pytest.mark.parametrize("excluding", ["except", "but"])
def test_a_noun_with_a_capital_letter_is_no_person_after_all_except(read, noun, excluding):
    written = read(f"take all {excluding} {noun}")
    lower = read(f"take all {excluding} {noun.lower()}")
    assert [step.frame for step in written.steps] == ["Taking"]
    assert written.steps[0].roles["Theme"][0].entities == lower.steps[0].roles["Theme"][0].entities


@pytest.mark.parametrize("name", ["Nora", "Ben"])
def test_a_name_after_all_except_is_a_person(read, name):
    (step,) = read(f"guide all except {name} to the kitchen").steps
    assert step.roles["Cotheme"][0].description.excluded == (name,)


def test_the_bounds_of_a_number_are_in_the_description(read):
    (theme,) = read("take two or three cups").steps[0].roles["Theme"]
    assert (theme.description.quantity, theme.description.at_least, theme.description.at_most) == (2, 2, 3)


@pytest.mark.parametrize(
    ("text", "doubt"),
    [
        ("take both cups", "'both cups': there are 3"),
        ("take the two cups", "'the two cups': there are 3"),
        ("prendi entrambe le tazze", "'entrambe le tazze': there are 3"),
        ("take at least four cups", "'at least four cups': there are only 3"),
        ("take two dozen cups", "'two dozen cups': there are only 3"),
        ("take two or three dozen cups", "'two or three dozen cups': there are only 3"),
        ("bring at most three", "'three' refers to nothing that was mentioned"),
        ("bring me up to a dozen", "'dozen' refers to nothing that was mentioned"),
        ("take half of the cups", "'half of the cups': there are 3"),
        ("take every second cup", "'every second cup': how many are meant is not clear"),
        ("take about two cups", "'about two cups': how many are meant is not clear"),
        ("take almost all the cups", "'almost all the cups': how many are meant is not clear"),
        ("take enough cups", "'enough cups': how many are meant is not clear"),
        ("take another cup", "'another cup': nothing of the kind was mentioned before"),
        ("take the rest of the cups", "'the rest of the cups': nothing of the kind was mentioned before"),
        ("take the red cup and no plates", "'no plates' is not meant"),
        ("bring salt", "'salt': no salt is known"),
        ("throw the cup out", "'out' is not understood"),
        ("grab the cup with your left hand", "'with your left hand' is not understood"),
        ("stop Nora", "'Nora' is not understood"),
    ],
)
def test_what_is_not_clear_is_a_doubt(read, text, doubt):
    assert read(text).doubts == (doubt,)


@pytest.mark.parametrize(
    ("text", "steps"),
    [
        ("bring the cups, not the blue one", ["Bringing(Theme=cup1|redcup)"]),
        ("bring all the cups with the exception of the blue one", ["Bringing(Theme=cup1|redcup)"]),
        ("bring all but the blue cup", ["Bringing(Theme=cup1|redcup)"]),
        ("take any cup but the red one", ["Taking(Theme=bluecup|cup1)"]),
        ("put the cups except the red one on the desk", ["Placing(Theme=bluecup|cup1, Goal=desk1)"]),
        ("porta tutte le tazze a parte quella blu", ["Bringing(Theme=cup1|redcup)"]),
        ("prendi tutte le tazze tranne quella sulla scrivania", ["Taking(Theme=bluecup|redcup)"]),
        ("prendi tutte le tazze tranne quella che è sulla scrivania", ["Taking(Theme=bluecup|redcup)"]),
        ("prendi tutte le tazze tranne che la rossa", ["Taking(Theme=bluecup|cup1)"]),
        ("prendi tutte le tazze ad esclusione di quella rossa", ["Taking(Theme=bluecup|cup1)"]),
        (
            "prendi tutto quello che è sul tavolo tranne la tazza blu",
            ["Taking(Theme=apple1|bowl1|glass1|plate1|plate2|redcup|water1)"],
        ),
        (
            "take everything that is on the table except the blue cup",
            ["Taking(Theme=apple1|bowl1|glass1|plate1|plate2|redcup|water1)"],
        ),
        ("take the red cup and the other cups", ["Taking(Theme=redcup, Theme=bluecup|cup1)"]),
        (
            "take the red cup and bring another",
            ["Taking(Theme=redcup)", "Bringing(Theme=bluecup|cup1)"],
        ),
        ("take the red cup and leave the rest", ["Taking(Theme=redcup)", "not Taking(Theme=bluecup|cup1)"]),
        (
            "prendi la tazza rossa e lascia le altre",
            ["Taking(Theme=redcup)", "not Taking(Theme=bluecup|cup1)"],
        ),
        (
            "take the cups and bring two of them to Nora",
            [
                "Taking(Theme=bluecup|cup1|redcup)",
                "Bringing(Theme=2 of bluecup|cup1|redcup, Beneficiary=nora1)",
            ],
        ),
    ],
)
def test_what_is_excluded_is_not_acted_on(read, text, steps):
    understood = read(text)
    assert (texts(understood), understood.doubts) == (steps, ())


@pytest.mark.parametrize(
    "text", ["porta la tazza rossa a tutti tranne Nora", "take the red cup to everyone except Nora"]
)
def test_an_exception_of_persons_is_not_one_of_the_things(read, text):
    (step,) = read(text).steps
    (theme,), (receiver,) = step.roles["Theme"], step.roles["Beneficiary"]
    assert (theme.entities, theme.description.excluded) == (("redcup",), ())
    assert (receiver.entities, receiver.description.excluded) == ((), ("Nora",))


@pytest.mark.parametrize(
    ("text", "left"),
    [
        ("bring the cups but leave the blue one", "not Bringing(Theme=bluecup)"),
        ("bring the cups. Leave the blue one.", "not Bringing(Theme=bluecup)"),
        ("bring the cups but don't take the blue one", "not Taking(Theme=bluecup)"),
        ("bring the cups but leave the blue one on the table", "Placing(Theme=bluecup, Goal=table1)"),
        ("porta le tazze ma lascia quella blu", "not Bringing(Theme=bluecup)"),
    ],
)
def test_what_must_be_left_is_an_exception_of_what_was_said_before(read, text, left):
    understood = read(text)
    assert texts(understood) == ["Bringing(Theme=cup1|redcup)", left]
    (doubt,) = understood.doubts
    assert doubt.endswith("is read as an exception")


def test_a_later_pronoun_refers_to_what_is_left_of_the_things(read):
    understood = read("bring the cups but don't take the blue one, then give them to Nora")
    assert texts(understood)[-1] == "Giving(Theme=cup1|redcup, Recipient=nora1)"


@pytest.mark.parametrize(
    ("text", "steps"),
    [
        ("show me the red cup", ['Cause_to_perceive(Perceiver="me", Phenomenon=redcup)']),
        ("show the red cup to Nora", ["Cause_to_perceive(Phenomenon=redcup, Perceiver=nora1)"]),
        ("show Nora the kitchen", ["Guiding(Cotheme=nora1, Goal=kitchen1)"]),
        ("show Nora the way to the kitchen", ["Guiding(Cotheme=nora1, Goal=kitchen1)"]),
        ("mostrami la tazza rossa", ['Cause_to_perceive(Perceiver="mi", Phenomenon=redcup)']),
        ("fill the glass with water", ["Filling(Theme=water1, Goal=glass1)"]),
        (
            "fill the red cup with water and bring it to me",
            ["Filling(Theme=water1, Goal=redcup)", 'Bringing(Theme=redcup, Beneficiary="to me")'],
        ),
        ("riempi il bicchiere d'acqua", ["Filling(Theme=water1, Goal=glass1)"]),
        ("riempi la tazza rossa con l'acqua", ["Filling(Theme=water1, Goal=redcup)"]),
        ("empty the red cup into the glass", ["Emptying(Source=redcup, Goal=glass1)"]),
        ("svuota la tazza rossa", ["Emptying(Source=redcup)"]),
        ("pour the milk out", ["Pouring(Theme=milk1)"]),
        ("clean the table with water", ["Cleaning(Instrument=water1, Theme=table1)"]),
        ("stop following Nora", ['Activity_stop(Activity="following", Cotheme=nora1)']),
        ("never stop following Nora", ['not Activity_stop(Activity="following", Cotheme=nora1)']),
        ("quit cleaning the table", ['Activity_stop(Activity="cleaning", Theme=table1)']),
        ("stop looking for the red cup", ['Activity_stop(Activity="looking", Sought_entity=redcup)']),
        ("cancel the order", ['Activity_stop(Activity="the order")']),
        ("stop", ["Activity_stop()"]),
        ("stop the oven", ["Change_operational_state(Device=oven1)"]),
        ("smetti di seguire Nora", ['Activity_stop(Activity="seguire", Cotheme=nora1)']),
        ("start following Nora", ["Cotheme(Cotheme=nora1)"]),
        ("continue to clean the table", ["Cleaning(Theme=table1)"]),
        ("continua a seguirmi", ['Cotheme(Cotheme="mi")']),
        ("don't follow Nora anymore", ['not Cotheme(Cotheme=nora1, Manner="anymore")']),
        ("non seguire più Nora", ['not Cotheme(Manner="più", Cotheme=nora1)']),
    ],
)
def test_a_verb_takes_what_it_acts_with_and_on(read, text, steps):
    understood = read(text)
    assert (texts(understood), understood.doubts) == (steps, ())


@pytest.mark.parametrize(
    "text",
    [
        "except for the red cup, take all cups",
        "apart from the red cup take all the cups",
        "except for the red one, take all cups",
        "tranne la tazza rossa, prendi tutte le tazze",
    ],
)
def test_an_exception_may_stand_before_the_verb(read, text):
    understood = read(text)
    assert texts(understood) == ["Taking(Theme=bluecup|cup1)"]
    assert understood.doubts == ()


@pytest.mark.parametrize(
    "text",
    [
        "except for the red cup, take the blue cup",
        "take the milk. except for the red cup",
        "except for the red cup, take the milk. take all cups",
    ],
)
def test_an_exception_of_nothing_is_not_understood(read, text):
    assert any("red cup" in doubt for doubt in read(text).doubts)
