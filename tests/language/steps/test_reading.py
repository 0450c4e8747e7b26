"""The steps of commands in the shipped flat, with persons, cups and masses added."""

import pytest


def texts(understood):
    return [step.text for step in understood.steps]


def filler(understood, role, step=0):
    return understood.steps[step].roles[role][0]


@pytest.mark.parametrize(
    ("text", "steps"),
    [
        (
            "Could you take the red cup and bring it to Nora?",
            ["Taking(Theme=redcup)", "Bringing(Theme=redcup, Beneficiary=nora1)"],
        ),
        (
            "Head over to the studio, then to the kitchen.",
            ["Motion(Goal=studio1)", "Motion(Goal=kitchen1)"],
        ),
        (
            "Put a plate on the desk and a cup on it",
            [
                "Placing(Theme=plate1|plate2, Goal=desk1)",
                "Placing(Theme=bluecup|cup1|redcup, Goal=plate1|plate2)",
            ],
        ),
        (
            "In the kitchen, find Nora and say hello to her",
            ["Locating(Sought_entity=nora1, Ground=kitchen1)", "Greeting(Addressee=nora1)"],
        ),
        (
            "Look in the studio for the laptop",
            ["Locating(Ground=studio1, Sought_entity=laptop1)"],
        ),
        (
            "Take Nora from the kitchen to the sofa",
            ["Guiding(Cotheme=nora1, Source=kitchen1, Goal=couch1)"],
        ),
        (
            "Take the kettle to the studio",
            ["Bringing(Theme=kettle1, Goal=studio1)"],
        ),
        (
            "I'd like the milk, please",
            ['Bringing(Beneficiary="I", Theme=milk1)'],
        ),
        (
            "Tell Nora to come to the studio",
            ['Request(Addressee=nora1, Message="to come to the studio")'],
        ),
        (
            "Pick the kettle up",
            ["Taking(Theme=kettle1)"],
        ),
        (
            "Nora is in the kitchen. Follow her.",
            ["Being_located(Theme=nora1, Location=kitchen1)", "Cotheme(Cotheme=nora1)"],
        ),
        (
            "Give me the name of the person at the sink",
            ['Telling(Addressee="me", Message="the name", Topic="of the person at the sink")'],
        ),
        (
            "get the kettle, the laptop and the red cup, and put them on the desk",
            [
                "Taking(Theme=kettle1, Theme=laptop1, Theme=redcup)",
                "Placing(Theme=kettle1|laptop1|redcup, Goal=desk1)",
            ],
        ),
        (
            "fetch either the red cup or the blue one",
            ["Taking(Theme=redcup|bluecup)"],
        ),
        (
            "go to the kitchen find Nora give her the kettle",
            [
                "Motion(Goal=kitchen1)",
                "Locating(Sought_entity=nora1)",
                "Giving(Recipient=nora1, Theme=kettle1)",
            ],
        ),
        (
            "The kettle should be on the counter, bring it to Nora",
            ["Being_located(Theme=kettle1, Location=counter1)", "Bringing(Theme=kettle1, Beneficiary=nora1)"],
        ),
        (
            "the kettle on the counter, bring it to Nora",
            ["Bringing(Theme=kettle1, Beneficiary=nora1)"],
        ),
        (
            "Turn the oven off and then to follow Nora",
            ["Change_operational_state(Device=oven1)", "Cotheme(Cotheme=nora1)"],
        ),
        (
            "make sure the fridge is closed",
            ['Inspecting(Ground=fridge1, Desired_state="is closed")'],
        ),
        (
            "give one of the plates to Nora",
            ["Giving(Theme=plate1|plate2, Recipient=nora1)"],
        ),
        (
            "tell everyone in the kitchen that we are leaving",
            ['Telling(Addressee=nora1, Message="that we are leaving")'],
        ),
        (
            "leave the kitchen",
            ["Motion(Source=kitchen1)"],
        ),
        ("Never mind, bring me the milk", ['Bringing(Beneficiary="me", Theme=milk1)']),
        ("Please don't forget to close the fridge", ["Closure(Containing_object=fridge1)"]),
        (
            "take the milk and the kettle and bring both to Nora",
            ["Taking(Theme=milk1, Theme=kettle1)", "Bringing(Theme=milk1|kettle1, Beneficiary=nora1)"],
        ),
        ("take all cups but the red one", ["Taking(Theme=bluecup|cup1)"]),
        (
            "go to the kitchen but do not enter the studio",
            ["Motion(Goal=kitchen1)", "not Arriving(Goal=studio1)"],
        ),
        (
            "close all doors except the one of the kitchen",
            ["Closure(Container_portal=door1|door2|door4|door5|door6)"],
        ),
        ("take all plates except the broken one", ['Taking(Theme="all plates except the broken one")']),
        (
            "take everything from the table except the wine",
            ["Taking(Theme=apple1|bluecup|bowl1|glass1|plate1|plate2|redcup|water1, Source=table1)"],
        ),
        ("take all cups except for the one on the table", ["Taking(Theme=cup1)"]),
        (
            "clean all rooms except the kitchen and the bathroom and go to Nora",
            ["Cleaning(Theme=bedroom1|livingroom1|studio1)", "Motion(Goal=nora1)"],
        ),
        ("take everything on the desk except the lamp, the book and the laptop", ["Taking(Theme=cup1)"]),
        ("open the door of the fridge", ["Closure(Container_portal=fridge1)"]),
        ("take a glass of water", ["Taking(Theme=water1)"]),
    ],
)
def test_a_command_is_a_list_of_steps(read, text, steps):
    understood = read(text)
    assert texts(understood) == steps
    assert (understood.doubts, understood.unknown, understood.question) == ((), (), "")


@pytest.mark.parametrize(
    ("text", "attributes"),
    [
        ("follow the waving person in the studio", ("waving",)),
        ("follow the woman who is pointing to the left in the studio", ("woman", "pointing to the left")),
        ("follow the guest with long hair in the studio", ("with long hair",)),
        ("follow the man in the green coat in the studio", ("man", "in the green coat")),
        ("follow the person raising their left arm in the studio", ("raising their left arm",)),
    ],
)
def test_a_person_told_by_looks_is_no_entity_of_the_map(read, text, attributes):
    person = filler(read(text), "Cotheme")
    assert (person.entities, person.description.attributes) == ((), attributes)
    assert [place.entities for place in person.description.relation] == [("studio1",)]


def test_a_person_told_by_place_is_whom_the_map_has_there(read):
    assert filler(read("follow the person in the kitchen"), "Cotheme").entities == ("nora1",)


def test_an_unknown_name_stays_open_and_a_known_one_keeps_the_stated_place(read):
    unknown = filler(read("greet Noor in the studio"), "Addressee")
    assert (unknown.entities, unknown.description.name) == ((), "Noor")
    known = filler(read("greet Nora in the studio"), "Addressee")
    assert (known.entities, known.description.relation[0].entities) == (("nora1",), ("studio1",))


@pytest.mark.parametrize(
    ("text", "condition", "time"),
    [
        ("if Nora leaves, take the kettle", "if Nora leaves", ""),
        ("take the kettle if Nora leaves", "if Nora leaves", ""),
        ("when the oven is on take the kettle", "when the oven is on", ""),
        ("take the kettle as soon as it is hot", "as soon as it is hot", ""),
        ("don't take the kettle unless I say so", "unless I say so", ""),
        ("wait until the oven is off, then take the kettle", "wait until the oven is off", ""),
        ("after closing the door, take the kettle", "after closing the door", ""),
        ("at 10:00 take the kettle", "", "at 10:00"),
        ("take the kettle in five minutes", "", "in five minutes"),
        ("take the kettle every morning", "", "every morning"),
        ("tomorrow evening take the kettle", "", "tomorrow evening"),
    ],
)
def test_conditions_and_times_are_in_the_step_and_in_the_doubts(read, text, condition, time):
    understood = read(text)
    (step,) = understood.steps
    assert (step.frame, step.condition, step.time) == ("Taking", condition, time)
    assert any((condition or time) in doubt for doubt in understood.doubts)


def test_a_condition_holds_for_all_steps_of_its_sentence(read):
    understood = read("if Nora leaves, take the kettle and go to the studio. Open the fridge.")
    assert [step.condition for step in understood.steps] == ["if Nora leaves", "if Nora leaves", ""]


@pytest.mark.parametrize(
    ("text", "first", "second"),
    [
        ("go to the studio, and if the lamp is on, turn it off", "", "if the lamp is on"),
        ("go to the studio and if the lamp is on turn it off", "", "if the lamp is on"),
        ("take the milk, but only if it is there, and bring it to Nora", *["only if it is there"] * 2),
        ("take the milk and bring it to Nora if she is there", *["if she is there"] * 2),
    ],
)
def test_a_condition_between_and_and_its_clause_is_only_its_own(read, text, first, second):
    assert [step.condition for step in read(text).steps] == [first, second]


@pytest.mark.parametrize(
    ("text", "first", "second"),
    [
        ("at ten o'clock go to the kitchen and take the milk", *["at ten o'clock"] * 2),
        ("at ten go to the kitchen and take the milk", *["at ten"] * 2),
        ("at ten o'clock go to the kitchen. Take the milk", "at ten o'clock", ""),
        ("in five minutes open the fridge and in ten minutes close it", "in five minutes", "in ten minutes"),
        ("go to the kitchen and take the milk, tomorrow. Thanks.", "", "tomorrow"),
    ],
)
def test_a_time_before_the_verb_is_that_of_all_clauses_after_it(read, text, first, second):
    assert [step.time for step in read(text).steps] == [first, second]


@pytest.mark.parametrize("word", ["if so", "otherwise", "in that case"])
def test_a_condition_on_the_step_before_holds_from_there_on(read, word):
    understood = read(f"look whether the oven is on, and {word}, bring Nora the kettle")
    assert [step.condition for step in understood.steps] == ["", word]


def test_whom_a_condition_mentions_is_whom_a_pronoun_means(read):
    understood = read("in case you see Nora, give her the kettle")
    assert filler(understood, "Recipient").entities == ("nora1",)


def test_negation_is_of_its_own_clause(read):
    understood = read("don't take the red cup, take the blue one")
    assert texts(understood) == ["not Taking(Theme=redcup)", "Taking(Theme=bluecup)"]
    assert texts(read("take any cup but not the red one")) == ["Taking(Theme=bluecup|cup1)"]


@pytest.mark.parametrize(
    ("text", "doubt"),
    [
        ("take the red kettle", "red"),
        ("take the yellow fridge", "fridge1 is not yellow; it is white"),
        ("take the laptop that is not on the desk", "the laptop that is not on the desk"),
        ("take the cups from the oven", "no cup is known on or in oven1"),
        ("take the kettle from the desk", "kettle1 is not on or in desk1"),
        ("take the three plates", "'the three plates': there are only 2"),
        ("take the cup of Nora", "no cup is known that belongs to Nora"),
        ("take the plate of the desk", "no plate is known that belongs to the desk"),
        ("clean the window of the bathroom", "no window is known that belongs to the bathroom"),
        ("take all cups except the red one and the plates", "'the plates' is read as an exception"),
        ("Not the red cup, take the blue one", "the red cup"),
        ("Tomorrow. Take the milk.", "Tomorrow"),
        ("bring me the one on the desk", "'one' refers to nothing that was mentioned"),
        ("take Nora's cup", "no cup is known that belongs to Nora"),
        ("take Gregor's cup", "'Gregor' is not known"),
        ("take my cup", "'my cup': the owner is not known"),
        ("bring the frobnicator", "'frobnicator' is not known"),
        ("take the violin", "violin"),
        ("go to the balcony", "balcony"),
        ("take the umbrella that Nora likes", "no umbrella is known"),
        ("take the kettle off", "off"),
        ("take the kettle upstairs", "upstairs"),
        ("take something shiny from the frobnicator", "frobnicator"),
        ("the person at the sink would like a cup", "would like"),
        ("take it", "'it' refers to nothing that was mentioned"),
        ("go to the kitchen by helicopter", "by helicopter"),
        ("this morning was nice, take the kettle", "nice"),
    ],
)
def test_every_word_is_used_or_named(read, text, doubt):
    understood = read(text)
    assert doubt in " ".join((*understood.doubts, *understood.unknown, understood.question))


def test_an_unknown_verb_is_named_beside_the_steps_that_are_known(read):
    understood = read("defenestrate the kettle and go to the kitchen")
    assert (understood.unknown, texts(understood)) == (("defenestrate",), ["Motion(Goal=kitchen1)"])


def test_a_pronoun_refers_to_what_was_described_even_if_it_is_not_known(read):
    understood = read("take a beer from the fridge and put it on the table")
    theme = filler(understood, "Theme", 1)
    assert (theme.entities, theme.description.class_, theme.refers.step) == ((), "Beer", 1)
    assert filler(understood, "Goal", 1).entities == ("table1",)


@pytest.mark.parametrize(
    ("text", "entities"),
    [
        ("find Nora in the kitchen and follow her", ("nora1",)),
        ("find Nora in the kitchen and follow them", ("nora1",)),
        ("take the red cup, find Nora, and give it to her", ("nora1",)),
        ("when Nora arrives, greet her", ("nora1",)),
    ],
)
def test_pronouns_of_persons(read, text, entities):
    last = read(text).steps[-1]
    assert list(last.roles.values())[-1][0].entities == entities


@pytest.mark.parametrize(
    ("text", "entities", "superlative"),
    [
        ("take the smallest cup on the table", None, "smallest"),
        ("take the leftmost cup on the table", ("bluecup", "redcup"), "leftmost"),
        ("take the oldest cup on the table", ("bluecup", "redcup"), "oldest"),
    ],
)
def test_superlatives_stay_in_the_description(read, text, entities, superlative):
    theme = filler(read(text), "Theme")
    assert theme.description.superlative == superlative
    assert entities is None or theme.entities == entities


@pytest.mark.parametrize(
    ("text", "answer"),
    [
        ("how many plates are on the table?", "2: plate1, plate2"),
        ("tell me how many cups are in the oven", "0: 'cups are in the oven': none is known; look there"),
        ("who is in the kitchen?", "nora1"),
        ("where is the kettle?", "kettle1 is on counter1"),
        ("what color is the fridge?", "fridge1: color white"),
        ("is the kettle on the desk?", "no: kettle1 is on counter1"),
        ("is the kettle in the kitchen?", "yes: kettle1"),
        ("what is the name of the person in the kitchen?", "nora1: name Nora"),
        ("what's on the desk?", "book1, cup1, lamp1, laptop1"),
        ("find out what colour the fridge is", "fridge1: colour white"),
        ("how many plates are lying on the table?", "2: plate1, plate2"),
        ("which of the cups is the oldest?", "'of the cups is the oldest': the map cannot tell; look there"),
        ("tell me the pose of Nora", "'of Nora': the map does not have the pose; look there"),
        (
            "how many people in the kitchen are waving?",
            "'people in the kitchen are waving': the map cannot tell; look there",
        ),
    ],
)
def test_a_question_is_answered_from_the_map_or_one_has_to_look(read, text, answer):
    understood = read(text)
    assert (understood.answer, understood.doubts) == (answer, ())


@pytest.mark.parametrize("text", ["how are you", "what a day", "I took the kettle", "hi"])
def test_another_text_than_a_command_has_no_steps(read, text):
    assert read(text).steps == ()


def test_every_text_ends_in_steps_or_doubts(read):
    words = ("the", "cup", "if", "on", "and", ",", "who", "'s", "not", "in", "that", "all", "one", "at", "it")
    for first in words:
        for second in words:
            understood = read(f"take {first} {second}")
            assert understood.steps or understood.doubts or understood.unknown


@pytest.mark.parametrize(
    ("text", "steps"),
    [
        ("Vai in cucina e poi trova Nora.", ["Motion(Goal=kitchen1)", "Locating(Sought_entity=nora1)"]),
        (
            "Prendi la tazza rossa dal tavolo e portala a Nora.",
            ["Taking(Theme=redcup, Source=table1)", "Bringing(Theme=redcup, Beneficiary=nora1)"],
        ),
        (
            "Porta la tazza blu in cucina e mettila sulla scrivania.",
            ["Bringing(Theme=bluecup, Goal=kitchen1)", "Placing(Theme=bluecup, Goal=desk1)"],
        ),
        ("Segui Nora dalla cucina allo studio.", ["Cotheme(Cotheme=nora1, Source=kitchen1, Goal=studio1)"]),
        ("Accompagna Nora allo studio.", ["Guiding(Cotheme=nora1, Goal=studio1)"]),
        ("Saluta Nora e poi seguila.", ["Greeting(Addressee=nora1)", "Cotheme(Cotheme=nora1)"]),
        (
            "Incontra Nora in cucina e accompagnala nello studio.",
            ["Make_acquaintance(Individual_2=nora1)", "Guiding(Cotheme=nora1, Goal=studio1)"],
        ),
        ("Dammi il bollitore.", ['Giving(Recipient="mi", Theme=kettle1)']),
        ("Dai il bollitore a Nora.", ["Giving(Theme=kettle1, Recipient=nora1)"]),
        ("Portami il latte.", ['Bringing(Beneficiary="mi", Theme=milk1)']),
        (
            "Trova Nora in cucina e dille una barzelletta.",
            ["Locating(Sought_entity=nora1, Ground=kitchen1)",
             'Telling(Addressee=nora1, Message="una barzelletta")'],
        ),
        (
            "Rispondi alla domanda di Nora.",
            ['Communication_response(Trigger="alla domanda", Addressee=nora1)'],
        ),
        ("Presentati a Nora.", ['Introducing(Theme="ti", Addressee=nora1)']),
        ("Chiedi a Nora come si chiama.", ['Questioning(Addressee=nora1, Message="come si chiama")']),
        ("Non toccare il bollitore.", ["not Manipulation(Entity=kettle1)"]),
        (
            "Non prendere la tazza rossa, prendi quella blu.",
            ["not Taking(Theme=redcup)", "Taking(Theme=bluecup)"],
        ),
        (
            "Prendi due piatti e mettili sulla scrivania.",
            ["Taking(Theme=plate1|plate2)", "Placing(Theme=plate1|plate2, Goal=desk1)"],
        ),
        ("Pulisci la cucina.", ["Cleaning(Theme=kitchen1)"]),
        ("Apri il frigorifero e chiudi il forno.",
         ["Closure(Containing_object=fridge1)", "Closure(Containing_object=oven1)"]),
        ("Conta i piatti sul tavolo.", ["Counting(Theme=plate1|plate2)"]),
        ("Versa il latte in una tazza.", ["Pouring(Theme=milk1, Goal=bluecup|cup1|redcup)"]),
        ("Spegni il forno.", ["Change_operational_state(Device=oven1)"]),
        ("Vai da Nora.", ["Motion(Goal=nora1)"]),
        (
            "Prendi il latte e il bollitore e portali entrambi a Nora.",
            ["Taking(Theme=milk1, Theme=kettle1)", "Bringing(Theme=milk1|kettle1, Beneficiary=nora1)"],
        ),
        (
            "Non prendere niente dalla scrivania.",
            ["not Taking(Theme=book1|cup1|lamp1|laptop1, Source=desk1)"],
        ),
        (
            "Prendi tutto dalla scrivania tranne il libro.",
            ["Taking(Theme=cup1|lamp1|laptop1, Source=desk1)"],
        ),
        (
            "Prima apri il frigorifero, poi prendi il latte.",
            ["Closure(Containing_object=fridge1)", "Taking(Theme=milk1)"],
        ),
        ("Dai a Nora il latte.", ["Giving(Recipient=nora1, Theme=milk1)"]),
        ("Da' il latte a Nora.", ["Giving(Theme=milk1, Recipient=nora1)"]),
        (
            "Di' a Nora che il latte è finito.",
            ['Telling(Addressee=nora1, Message="che il latte è finito")'],
        ),
        ("Non aprire il frigorifero né il forno.", ["not Closure(Containing_object=fridge1|oven1)"]),
        ("Non toccare mai la tazza rossa.", ["not Manipulation(Entity=redcup)"]),
        ("Evita di aprire il forno.", ["not Closure(Containing_object=oven1)"]),
        ("Non dimenticare di chiudere il frigorifero.", ["Closure(Containing_object=fridge1)"]),
        ("Non voglio il latte.", ['not Bringing(Beneficiary="voglio", Theme=milk1)']),
        (
            "Vai in cucina ma non entrare nello studio.",
            ["Motion(Goal=kitchen1)", "not Arriving(Goal=studio1)"],
        ),
        ("Cerca il portatile nello studio.", ["Locating(Sought_entity=laptop1, Ground=studio1)"]),
    ],
)  # fmt: skip
def test_an_italian_command_has_the_same_steps(read, text, steps):
    understood = read(text)
    assert understood.language == "italian"
    assert texts(understood) == steps
    assert (understood.doubts, understood.unknown, understood.question) == ((), (), "")


@pytest.mark.parametrize(
    ("text", "step", "doubt"),
    [
        (
            "Se Nora è in cucina, portale il bollitore.",
            "Bringing(Beneficiary=nora1, Theme=kettle1) [Se Nora è in cucina]",
            "'Se Nora è in cucina' is a condition",
        ),
        (
            "Tra cinque minuti spegni il forno.",
            "Change_operational_state(Device=oven1) [Tra cinque minuti]",
            "'Tra cinque minuti' is a time",
        ),
        (
            "Domani mattina porta il bollitore a Nora.",
            "Bringing(Theme=kettle1, Beneficiary=nora1) [Domani mattina]",
            "'Domani mattina' is a time",
        ),
        (
            "Alle 10:30 porta il bollitore a Nora.",
            "Bringing(Theme=kettle1, Beneficiary=nora1) [Alle 10:30]",
            "'Alle 10:30' is a time",
        ),
        (
            "Alle dieci porta il bollitore a Nora.",
            "Bringing(Theme=kettle1, Beneficiary=nora1) [Alle dieci]",
            "'Alle dieci' is a time",
        ),
        (
            "Ogni mattina apri il frigorifero.",
            "Closure(Containing_object=fridge1) [Ogni mattina]",
            "'Ogni mattina' is a time",
        ),
        (
            "Prendi il bollitore solo se è vuoto.",
            "Taking(Theme=kettle1) [solo se è vuoto]",
            "'solo se è vuoto' is a condition",
        ),
        (
            "Porta il bollitore a Nora a meno che non sia vuoto.",
            "Bringing(Theme=kettle1, Beneficiary=nora1) [a meno che non sia vuoto]",
            "'a meno che non sia vuoto' is a condition",
        ),
        (
            "Prendi il bollitore dal forno.",
            'Taking(Theme="il bollitore", Source=oven1)',
            "kettle1 is not on or in oven1",
        ),
        (
            "Prendi la tazza di Nora.",
            'Taking(Theme="la tazza di Nora")',
            "no cup is known that belongs to Nora",
        ),
    ],
)  # fmt: skip
def test_nothing_of_an_italian_command_is_lost(read, text, step, doubt):
    understood = read(text)
    assert texts(understood) == [step]
    assert doubt in " ".join(understood.doubts)


@pytest.mark.parametrize(
    ("text", "answer"),
    [
        ("Quanti piatti ci sono sul tavolo?", "2: plate1, plate2"),
        ("Chi è in cucina?", "nora1"),
        ("Dov'è il bollitore?", "kettle1 is on counter1"),
    ],
)
def test_a_question_in_italian_is_answered(read, text, answer):
    assert read(text).answer == answer


@pytest.mark.parametrize(
    "text", ["Not the red cup, take the blue one", "Don't just stand there, take the blue cup"]
)
def test_a_negation_holds_only_for_its_own_words(read, text):
    assert texts(read(text)) == ["Taking(Theme=bluecup)"]


def test_a_negation_before_an_insertion_is_kept(read):
    (step,) = read("Do not, under any circumstances, open the oven").steps
    assert step.negated


@pytest.mark.parametrize("text", ["Is the oven on?", "Is the fridge not open?", "How many lamps are off?"])
def test_a_state_that_the_map_does_not_have_is_not_confirmed(read, text):
    assert "yes" not in read(text).answer
    assert "lamp1" not in read(text).answer


@pytest.mark.parametrize("text", ["is", "are there", "sono"])
def test_a_question_that_ends_after_its_verb_has_no_steps(read, text):
    assert not read(text).steps


def test_a_superlative_may_be_a_whole_phrase(read):
    assert read("again most laying").doubts == ("'most laying' is not understood",)
    assert texts(read("find most laying")) == ['Locating(Sought_entity="most laying")']
