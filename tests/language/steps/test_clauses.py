"""Clauses without their verb, and phrases that mean a part of what was mentioned or in a condition."""

import pytest

OPEN_CONDITION = "is a condition; it is not checked"


def texts(understood):
    return [step.text for step in understood.steps]


@pytest.mark.parametrize(
    ("text", "steps"),
    [
        (
            "bring the milk to the kitchen, the plates to the table, and then go to the sofa",
            [
                "Bringing(Theme=milk1, Goal=kitchen1)",
                "Bringing(Theme=plate1|plate2, Goal=table1)",
                "Motion(Goal=couch1)",
            ],
        ),
        (
            "bring the milk to Nora, the kettle to me and the plates to the desk",
            [
                "Bringing(Theme=milk1, Beneficiary=nora1)",
                'Bringing(Theme=kettle1, Beneficiary="to me")',
                "Bringing(Theme=plate1|plate2, Goal=desk1)",
            ],
        ),
        (
            "put the milk on the table, the kettle on the desk",
            ["Placing(Theme=milk1, Goal=table1)", "Placing(Theme=kettle1, Goal=desk1)"],
        ),
        (
            "put the kettle on the table, the desk and the sofa",
            ["Placing(Theme=kettle1, Goal=table1, Goal=desk1, Goal=couch1)"],
        ),
        (
            "bring me the milk, the plates and the bowl",
            ['Bringing(Beneficiary="me", Theme=milk1, Theme=plate1|plate2, Theme=bowl1)'],
        ),
        (
            "put the milk on the table, then the kettle on the desk",
            ["Placing(Theme=milk1, Goal=table1)", "Placing(Theme=kettle1, Goal=desk1)"],
        ),
        (
            "give Nora the milk and me the kettle and go to the kitchen",
            [
                "Giving(Recipient=nora1, Theme=milk1)",
                'Giving(Recipient="me", Theme=kettle1)',
                "Motion(Goal=kitchen1)",
            ],
        ),
        (
            "give Nora the milk, me the kettle",
            ["Giving(Recipient=nora1, Theme=milk1)", 'Giving(Recipient="me", Theme=kettle1)'],
        ),
        (
            "put the red cup on the desk, the blue one on the sofa",
            ["Placing(Theme=redcup, Goal=desk1)", "Placing(Theme=bluecup, Goal=couch1)"],
        ),
        (
            "porta a Nora il latte e a me il bollitore",
            ["Bringing(Beneficiary=nora1, Theme=milk1)", 'Bringing(Beneficiary="a me", Theme=kettle1)'],
        ),
        (
            "bring one cup to Nora and two to me",
            [
                "Bringing(Theme=1 of bluecup|cup1|redcup, Beneficiary=nora1)",
                'Bringing(Theme=2 of bluecup|cup1|redcup, Beneficiary="to me")',
            ],
        ),
        (
            "porta il latte sul tavolo e i piatti sulla scrivania",
            ["Bringing(Theme=milk1, Goal=table1)", "Bringing(Theme=plate1|plate2, Goal=desk1)"],
        ),
        (
            "porta tutti i piatti tranne il più grande in cucina",
            ["Bringing(Theme=plate2, Goal=kitchen1)"],
        ),
    ],
)
def test_each_object_of_a_list_has_its_own_place(read, text, steps):
    understood = read(text)
    assert texts(understood) == steps
    assert (understood.doubts, understood.unknown, understood.question) == ((), (), "")


@pytest.mark.parametrize(
    ("text", "steps"),
    [
        ("do not take the milk but the water", ["not Taking(Theme=milk1)", "Taking(Theme=water1)"]),
        ("non prendere il latte ma l'acqua", ["not Taking(Theme=milk1)", "Taking(Theme=water1)"]),
        (
            "do not bring me the milk but the water, and go to the sofa",
            [
                'not Bringing(Beneficiary="me", Theme=milk1)',
                'Bringing(Beneficiary="me", Theme=water1)',
                "Motion(Goal=couch1)",
            ],
        ),
        (
            "do not bring the kettle to Nora but to me",
            [
                "not Bringing(Theme=kettle1, Beneficiary=nora1)",
                'Bringing(Theme=kettle1, Beneficiary="to me")',
            ],
        ),
        ("do not take the red cup but the blue one", ["not Taking(Theme=redcup)", "Taking(Theme=bluecup)"]),
        ("non prendere né il latte né l'acqua", ["not Taking(Theme=milk1|water1)"]),
        ("non portarmi né il latte né l'acqua", ['not Bringing(Beneficiary="mi", Theme=milk1|water1)']),
        ("do not take the plates but the biggest one", ["not Taking(Theme=plate2)"]),
        ("take all plates but the biggest", ["Taking(Theme=plate2)"]),
    ],
)
def test_what_is_to_be_done_instead_is_a_step_of_its_own(read, text, steps):
    understood = read(text)
    assert texts(understood) == steps
    assert understood.doubts == ()


@pytest.mark.parametrize(
    ("text", "last", "excluded"),
    [
        ("put one plate on the desk and the other on the sofa", "Placing", "one plate"),
        ("put a plate on the desk and another one on the sofa", "Placing", "a plate"),
        ("bring two of the cups to Nora and the other one to the sofa", "Bringing", "two of the cups"),
        ("bring two cups to Nora and the rest to the sofa", "Bringing", "two cups"),
        ("take a plate and put the other one on the sofa", "Placing", "a plate"),
        ("metti un piatto sulla scrivania e un altro sul divano", "Placing", "un piatto"),
        ("metti una tazza sulla scrivania e un'altra sul divano", "Placing", "una tazza"),
    ],
)
def test_the_other_one_is_not_the_one_before_although_any_may_be_that(read, text, last, excluded):
    understood = read(text)
    first, other = understood.steps
    (theme,) = other.roles["Theme"]
    assert (other.frame, other.roles["Goal"][0].entities) == (last, ("couch1",))
    assert set(theme.entities) == set(first.roles["Theme"][0].entities)
    assert theme.description.excluded == (excluded,)
    assert (understood.doubts, understood.question) == ((), "")


def test_what_is_left_is_not_taken(read):
    step = read("take one plate and leave the other").steps[1]
    assert (step.frame, step.negated) == ("Taking", True)
    assert step.roles["Theme"][0].description.excluded == ("one plate",)


@pytest.mark.parametrize(
    ("text", "step"),
    [
        ("if there are two plates on the table, bring me one of them", "1 of plate1|plate2"),
        ("if there are more than two plates on the table, bring me one", "1 of plate1|plate2"),
        ("if at least two plates are on the table, bring me one of them", "1 of plate1|plate2"),
        ("if there are two plates on the table, bring me both", "plate1|plate2"),
        ("when there are no plates on the table, bring me it", "table1"),
        ("se ci sono due piatti sul tavolo, portamene uno", "1 of plate1|plate2"),
        ("se ci sono due piatti sul tavolo, portameli", "plate1|plate2"),
    ],
)
def test_a_pronoun_refers_to_the_things_of_a_condition_before_it(read, text, step):
    understood = read(text)
    assert f"Theme={step})" in texts(understood)[0]
    assert [doubt.endswith(OPEN_CONDITION) for doubt in understood.doubts] == [True]


def test_a_condition_after_but_is_only_that_of_its_own_clause(read):
    steps = read("take the milk, but if it is not there, take the water").steps
    assert [step.condition for step in steps] == ["", "if it is not there"]


@pytest.mark.parametrize(
    ("text", "condition"),
    [
        ("take the cup but not if it is red", "but not if it is red"),
        ("take the cup, but not when Nora is here", "but not when Nora is here"),
        ("prendi la tazza ma non se è rossa", "ma non se è rossa"),
    ],
)
def test_a_negated_condition_keeps_its_negation(read, text, condition):
    understood = read(text)
    (step,) = understood.steps
    assert (step.negated, step.condition) == (False, condition)
    assert understood.doubts == (f"'{condition}' {OPEN_CONDITION}",)


@pytest.mark.parametrize(
    ("text", "answer"),
    [
        ("are there more than two plates on the table", "no: 2: plate1, plate2"),
        ("are there at least two plates on the table", "yes: plate1, plate2"),
        ("is at least one cup on the table", "yes: bluecup, redcup"),
        ("are there three cups on the table", "no: 2: bluecup, redcup"),
        ("are there at most two cups on the table", "yes: bluecup, redcup"),
        ("are there fewer than three cups in the oven", "yes: 0"),
        ("are there no cups on the table", "no: 2: bluecup, redcup"),
        (
            "are all the cups on the table",
            "no: bluecup is on table1, cup1 is on desk1, redcup is on table1",
        ),
        ("are all the plates on the table", "yes: plate1, plate2"),
        ("which of the books is the smallest", "book3"),
    ],
)
def test_an_answer_respects_the_number_that_is_asked_for(read, text, answer):
    understood = read(text)
    assert (understood.answer, understood.doubts) == (answer, ())


@pytest.mark.parametrize(
    ("text", "step"),
    [
        ("can I have the milk", 'Bringing(Beneficiary="I", Theme=milk1)'),
        ("please can I have the milk?", 'Bringing(Beneficiary="I", Theme=milk1)'),
        (
            "bring me the milk as soon as possible",
            'Bringing(Beneficiary="me", Theme=milk1, Manner="as soon as possible")',
        ),
        ("portami il latte al più presto", 'Bringing(Beneficiary="mi", Theme=milk1, Manner="al più presto")'),
        ("come here as fast as you can", 'Motion(Goal="here", Manner="as fast as you can")'),
        (
            "bring the plates one by one to the kitchen",
            'Bringing(Theme=plate1|plate2, Manner="one by one", Goal=kitchen1)',
        ),
        ("never take more than two plates", "not Taking(Theme=at least 3 of plate1|plate2)"),
        ("bring me the water instead", 'Bringing(Beneficiary="me", Theme=water1)'),
        ("portami invece l'acqua", 'Bringing(Beneficiary="mi", Theme=water1)'),
        ("assicurati che il frigo sia chiuso", 'Inspecting(Desired_state="che il frigo sia chiuso")'),
        ("posso avere il latte?", 'Bringing(Beneficiary="posso avere", Theme=milk1)'),
        ("d'accordo, prendi il latte", "Taking(Theme=milk1)"),
        ("metti la tazza all'interno del frigo", "Placing(Theme=cup1, Goal=fridge1)"),
        ("portami uno dei due piatti", 'Bringing(Beneficiary="mi", Theme=1 of plate1|plate2)'),
        ("segui Nora fino in cucina", "Cotheme(Cotheme=nora1, Goal=kitchen1)"),
        ("take the bigger of the two plates", "Taking(Theme=plate1)"),
        ("take the smallest of the books", "Taking(Theme=book3)"),
        ("prendi il più piccolo dei libri", "Taking(Theme=book3)"),
    ],
)
def test_everyday_expressions_leave_no_doubt(read, text, step):
    understood = read(text)
    assert texts(understood) == [step]
    assert (understood.mood, understood.doubts, understood.unknown) == ("command", (), ())


@pytest.mark.parametrize(
    ("text", "step"),
    [
        ("put the apple on the table or the desk", "Placing(Theme=apple1, Goal=table1|desk1)"),
        ("put the apple on the table or on the desk", "Placing(Theme=apple1, Goal=table1|desk1)"),
        ("metti la mela sul tavolo o sulla scrivania", "Placing(Theme=apple1, Goal=table1|desk1)"),
        ("take the cup from the table or from the desk", "Taking(Theme=cup1, Source=table1|desk1)"),
        ("go to the kitchen or to the bedroom", "Motion(Goal=kitchen1|bedroom1)"),
        ("bring me the milk or water", 'Bringing(Beneficiary="me", Theme=milk1|water1)'),
    ],
)
def test_another_place_after_or_is_a_choice_of_places(read, text, step):
    understood = read(text)
    assert texts(understood) == [step]
    assert not understood.doubts


@pytest.mark.parametrize("other", ["go to the kitchen", "put it on the desk", "bring me the water"])
def test_a_choice_between_commands_is_not_understood(read, other):
    understood = read(f"put the apple on the table or {other}")
    assert texts(understood) == ["Placing(Theme=apple1, Goal=table1)"]
    assert understood.doubts == (f"'{other}' is not understood",)
