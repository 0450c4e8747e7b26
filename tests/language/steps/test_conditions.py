"""Conditions in commands: which steps they hold for, and that none of their words are lost."""

import itertools

import pytest

ENGLISH = [
    # A condition after its clause ends where the next clause begins.
    ("take the cup if it is clean and bring it to Nora", ["if it is clean", "if it is clean"]),
    ("bring me the milk only if it is cold and then go to the studio", ["only if it is cold"] * 2),
    ("take the milk unless it is hot and close the fridge", ["unless it is hot"] * 2),
    ("greet Nora when she arrives and follow her", ["when she arrives"] * 2),
    ("give Nora the milk as soon as she comes in and close the oven", ["as soon as she comes in"] * 2),
    ("give Nora the milk every time she comes in and close the oven", ["every time she comes in"] * 2),
    ("take the milk before you open the oven and go to the kitchen", ["before you open the oven"] * 2),
    ("take the milk after Nora has left and come back", ["after Nora has left"] * 2),
    ("take the milk in case Nora is thirsty and bring it to her", ["in case Nora is thirsty"] * 2),
    ("take the milk if it is cold but do not open the oven", ["if it is cold"] * 2),
    ("take the milk if it is clean and not broken", ["if it is clean and not broken"]),
    ("take the cup if it is empty or open", ["if it is empty or open"]),
    ("take the cup if it is here and Nora is there", ["if it is here and Nora is there"]),
    ("tell Nora to come if she is free and then go to the studio", ["if she is free"] * 2),
    ("ask Nora to come if she is free and then go to the studio", ["if she is free"] * 2),
    ("turn off the oven 5 minutes after Nora leaves", ["5 minutes after Nora leaves"]),
    # A condition before its clause, also without a comma.
    ("if the milk is cold go to the kitchen", ["if the milk is cold"]),
    ("if the milk is cold and the oven is on take the milk", ["if the milk is cold and the oven is on"]),
    ("if you see Nora and follow her, take the milk", ["if you see Nora and follow her"]),
    ("before you take the milk open the oven and come back", ["before you take the milk"] * 2),
    ("after lunch close the fridge", ["after lunch"]),
    ("next time Nora comes, greet her", ["next time Nora comes"]),
    ("with Nora gone, close the oven and come back", ["with Nora gone"] * 2),
    ("with the oven on, go to the studio", ["with the oven on"]),
    ("should Nora be in the kitchen bring her the milk", ["should Nora be in the kitchen"]),
    ("wait until Nora arrives and take the milk", ["wait until Nora arrives"]),
    ("go to the studio and wait until Nora arrives and then come", ["", "wait until Nora arrives"]),
    # A condition in the middle of its clause.
    ("take, if it is cold, the milk and bring it to Nora", ["if it is cold"] * 2),
    ("bring the milk, if it is cold, to Nora", ["if it is cold"]),
    ("tell Nora, if she is in the kitchen, to come here", ["if she is in the kitchen"]),
    # Several conditions.
    ("if Nora is here, bring her the milk if it is cold", ["if Nora is here; if it is cold"]),
    (
        "take the milk when Nora leaves and if the oven is on close it",
        ["when Nora leaves", "if the oven is on"],
    ),
    ("if it is cold take the milk, if it is hot go to the studio", ["if it is cold", "if it is hot"]),
    # What is over when the next clause begins.
    ("follow Nora until she stops and take the milk", ["until she stops", "not (until she stops)"]),
    ("follow Nora while she walks and then come", ["while she walks", "not (while she walks)"]),
    ("wait here while Nora eats and then close the fridge", ["not (while Nora eats)"]),
]

OTHERWISE = [
    (
        "if it is cold, take the milk, otherwise go to the studio",
        ["if it is cold", "otherwise: not (if it is cold)"],
    ),
    (
        "If it is cold, take the milk. Otherwise close the oven.",
        ["If it is cold", "Otherwise: not (If it is cold)"],
    ),
    ("if it is cold take the milk; if not, close the oven", ["if it is cold", "if not: not (if it is cold)"]),
    ("bring the milk to Nora if she is in else close the oven", ["if she is in", "else: not (if she is in)"]),
    (
        "if it is cold take the milk, otherwise if it is on close the oven, otherwise go to the studio",
        [
            "if it is cold",
            "otherwise: not (if it is cold); if it is on",
            "otherwise: not (if it is cold); otherwise: not (if it is on)",
        ],
    ),
    ("if it is cold, squonk it, otherwise close the oven", ["otherwise: not (if it is cold)"]),
    ("unless told otherwise, take the milk", ["unless told otherwise"]),
    ("take the milk if not too cold and come back", ["if not too cold"] * 2),
]

ITALIAN = [
    ("prendi la tazza se è pulita e portala a Nora", ["se è pulita"] * 2),
    ("Se il latte è freddo dallo a Nora", ["Se il latte è freddo"]),
    ("Se Nora è in cucina dalle il latte e vai nello studio", ["Se Nora è in cucina"] * 2),
    ("se è freddo prendi il latte, se è caldo chiudi il forno", ["se è freddo", "se è caldo"]),
    ("se il latte è freddo portalo a Nora, altrimenti vai in cucina",
     ["se il latte è freddo", "altrimenti: not (se il latte è freddo)"]),
    ("se è freddo prendi il latte, in caso contrario chiudi il forno",
     ["se è freddo", "in caso contrario: not (se è freddo)"]),
    ("segui Nora fino a quando si ferma e prendi il latte",
     ["fino a quando si ferma", "not (fino a quando si ferma)"]),
    ("prendi il latte prima di aprire il forno e vai in cucina", ["prima di aprire il forno"] * 2),
    ("prima di prendere il latte apri il forno", ["prima di prendere il latte"]),
    ("dopo aver preso il latte chiudi il forno", ["dopo aver preso il latte"]),
    ("a meno che il latte sia caldo prendilo e chiudi il forno", ["a meno che il latte sia caldo"] * 2),
    ("appena Nora arriva dalle il latte e chiudi il forno", ["appena Nora arriva"] * 2),
    ("ogni volta che il forno è acceso spegnilo", ["ogni volta che il forno è acceso"]),
    ("nel caso in cui il latte sia freddo portalo a Nora", ["nel caso in cui il latte sia freddo"]),
    ("se non trovi il latte vai in cucina", ["se non trovi il latte"]),
    ("porta il latte, se è freddo, a Nora", ["se è freddo"]),
    ("chiedi a Nora di venire quando è freddo e poi vai in cucina", ["quando è freddo"] * 2),
]  # fmt: skip


@pytest.mark.parametrize(("text", "conditions"), [*ENGLISH, *OTHERWISE, *ITALIAN])
def test_a_condition_is_that_of_its_steps_and_ends_where_the_next_clause_begins(read, text, conditions):
    understood = read(text)
    assert [step.condition for step in understood.steps] == conditions
    doubts = " ".join(understood.doubts)
    parts = [part for condition in conditions for part in condition.split("; ")]
    assert all(part.removeprefix("not (").removesuffix(")") in doubts for part in parts)


CONJUNCTIONS = [
    *(
        "if",
        "only if",
        "when",
        "whenever",
        "unless",
        "until",
        "while",
        "once",
        "after",
        "before",
        "as soon as",
    ),
    *(
        "as long as",
        "in case",
        "provided that",
        "every time",
        "the moment",
        "by the time",
        "even if",
        "only when",
    ),
]
CLAUSES = [
    *("the milk is cold", "the door opens", "you see Ben", "Ben and Nora leave", "you are done with it"),
    *("there is a cup on the table", "it is not hot", "I say so"),
]


@pytest.mark.parametrize(
    "pattern",
    [
        "take the milk {} and turn it off",
        "go to the kitchen {}, then come back",
        "{} do not open the fridge and follow Nora",
        "{}, tell me the time and find the kettle",
        "put the cup in the fridge, {}, and give me the milk",
        "count the plates on the table and go there {}",
        "ask Nora to come and then answer her question {}",
    ],
)
def test_no_step_loses_its_condition_nor_a_condition_a_word(read, pattern):
    for conjunction, clause in zip(CONJUNCTIONS, itertools.cycle(CLAUSES), strict=False):
        condition = f"{conjunction} {clause}"
        steps = read(pattern.format(condition)).steps
        assert [condition in step.condition for step in steps] == [True, True]


def test_a_condition_of_what_is_not_understood_is_not_that_of_the_sentence_before(read):
    understood = read("go to the studio. if the milk is cold, squonk it. take the milk")
    assert [step.condition for step in understood.steps] == ["", ""]
    assert "'if the milk is cold' is not understood" in understood.doubts


@pytest.mark.parametrize(
    ("text", "entities"),
    [
        ("open the fridge, take the milk and close it", ("fridge1",)),
        ("take the milk out of the fridge and close it", ("fridge1",)),
        ("put the milk in the fridge, take the kettle and close it", ("fridge1",)),
        ("take the kettle from the oven and turn it on", ("kettle1",)),
        ("put the red cup into the oven and turn it on", ("oven1",)),
        ("take the cups from the fridge and the oven and close them", ("fridge1", "oven1")),
        ("open the milk and close it", ("milk1",)),
        ("prendi il latte dal frigorifero e chiudilo", ("fridge1",)),
        ("metti la tazza rossa nel forno e accendilo", ("oven1",)),
    ],
)
def test_a_pronoun_means_what_affords_the_action(read, text, entities):
    understood = read(text)
    (filler,) = next(iter(understood.steps[-1].roles.values()))
    assert filler.refers is not None
    assert not any("is not known to be" in doubt for doubt in understood.doubts)
    step, role = filler.refers.step, filler.refers.role
    assert filler.entities == entities or (not filler.entities and understood.steps[step - 1].roles[role])


def test_a_pronoun_for_something_that_does_not_afford_the_action_is_doubted(read):
    understood = read("take the milk from the counter and open it")
    assert understood.steps[1].roles["Containing_object"][0].entities == ("milk1",)
    assert understood.doubts == ("'it': milk1 is not known to be openable",)


@pytest.mark.parametrize(
    ("text", "answer"),
    [
        ("The kettle is on the desk?", "no: kettle1 is on counter1"),
        ("Nora is in the kitchen?", "yes: nora1"),
        ("there are two plates on the table?", "yes: plate1, plate2"),
        ("the kettle is not on the desk?", "yes: kettle1"),
        ("Il bollitore è sulla scrivania?", "no: kettle1 is on counter1"),
        ("Il bollitore si trova sulla scrivania?", "no: kettle1 is on counter1"),
        ("C'è il bollitore sulla scrivania?", "no: kettle1 is on counter1"),
        ("Nora è in cucina?", "yes: nora1"),
    ],
)
def test_a_question_may_have_the_order_of_a_statement(read, text, answer):
    understood = read(text)
    assert (understood.mood, [step.frame for step in understood.steps]) == ("question", ["Telling"])
    assert understood.answer.startswith(answer)


def test_a_statement_is_no_question_and_a_command_with_a_question_mark_is_done(read):
    assert read("The kettle is on the desk.").steps[0].frame == "Being_located"
    assert read("the kettle is on the counter, bring it to Nora?").steps[-1].frame == "Bringing"
    assert read("the kettle is where?").answer == ""
