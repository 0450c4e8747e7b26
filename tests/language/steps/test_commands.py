"""Commands of all kinds in the shipped flat: which step each becomes, and what is answered or left open."""

import pytest

OPEN_TIME = "is a time; nothing is done then by itself"
OPEN_CONDITION = "is a condition; it is not checked"


def texts(understood):
    return [step.text for step in understood.steps]


@pytest.mark.parametrize(
    ("text", "steps"),
    [
        ("find me a cup", ["Locating(Sought_entity=bluecup|cup1|redcup)"]),
        ("walk Nora to the sofa", ["Guiding(Cotheme=nora1, Goal=couch1)"]),
        ("show Nora the way to the kitchen", ["Guiding(Cotheme=nora1, Goal=kitchen1)"]),
        ("bring Nora to the kitchen", ["Guiding(Cotheme=nora1, Goal=kitchen1)"]),
        ("follow Nora to the kitchen", ["Cotheme(Cotheme=nora1, Goal=kitchen1)"]),
        ("bring the cup here", ['Bringing(Theme=cup1, Goal="here")']),
        ("come here", ['Motion(Goal="here")']),
        ("put the kettle here", ['Placing(Theme=kettle1, Goal="here")']),
        ("go quickly to the kitchen", ['Motion(Manner="quickly", Goal=kitchen1)']),
        ("go to the kitchen quickly", ['Motion(Goal=kitchen1, Manner="quickly")']),
        ("bring me a little water", ['Bringing(Beneficiary="me", Theme=water1)']),
        ("turn left", ['Change_direction(Direction="left")']),
        ("search the kitchen for a cup", ["Locating(Ground=kitchen1, Sought_entity=bluecup|redcup)"]),
        ("look for the kettle", ["Locating(Sought_entity=kettle1)"]),
        ("go through the kitchen to the studio", ["Motion(Path=kitchen1, Goal=studio1)"]),
        ("robot, take the kettle", ["Taking(Theme=kettle1)"]),
        ("hey robot, take the kettle", ["Taking(Theme=kettle1)"]),
        ("go get the milk", ["Taking(Theme=milk1)"]),
        ("you should take the milk", ["Taking(Theme=milk1)"]),
        ("could you please take the milk", ["Taking(Theme=milk1)"]),
        (
            "go to the kitchen and, please, take the milk",
            ["Motion(Goal=kitchen1)", "Taking(Theme=milk1)"],
        ),
        ("put the cup on the table and go", ["Placing(Theme=cup1, Goal=table1)", "Motion()"]),
        ("turn the lamp on", ["Change_operational_state(Device=lamp1)"]),
        ("put the cup down", ["Placing(Theme=cup1)"]),
        ("leave the milk on the table", ["Placing(Theme=milk1, Goal=table1)"]),
        ("never open the oven", ["not Closure(Containing_object=oven1)"]),
        ("bring the milk for Nora", ["Bringing(Theme=milk1, Beneficiary=nora1)"]),
        ("introduce yourself to Nora", ['Introducing(Theme="yourself", Addressee=nora1)']),
        ("introduce Nora to me", ['Introducing(Theme=nora1, Addressee="to me")']),
        ("bring me a plate or a bowl", ['Bringing(Beneficiary="me", Theme=plate1|plate2|bowl1)']),
        ("take the milk, or the water", ["Taking(Theme=milk1|water1)"]),
        (
            "bring me a plate, a bowl and the milk",
            ['Bringing(Beneficiary="me", Theme=plate1|plate2, Theme=bowl1, Theme=milk1)'],
        ),
    ],
)
def test_an_action_is_a_step_with_all_that_it_names(read, text, steps):
    understood = read(text)
    assert texts(understood) == steps
    assert (understood.doubts, understood.unknown, understood.question) == ((), (), "")


@pytest.mark.parametrize(
    ("text", "steps"),
    [
        (
            "bring the milk to Nora and the kettle to me",
            ["Bringing(Theme=milk1, Beneficiary=nora1)", 'Bringing(Theme=kettle1, Beneficiary="to me")'],
        ),
        (
            "give the milk to Nora and the kettle to the sofa",
            ["Giving(Theme=milk1, Recipient=nora1)", "Giving(Theme=kettle1, Goal=couch1)"],
        ),
        (
            "put the milk on the table and the kettle on the desk",
            ["Placing(Theme=milk1, Goal=table1)", "Placing(Theme=kettle1, Goal=desk1)"],
        ),
        (
            "take the red cup to the studio and the blue one to the kitchen",
            ["Bringing(Theme=redcup, Goal=studio1)", "Bringing(Theme=bluecup, Goal=kitchen1)"],
        ),
    ],
)
def test_a_verb_may_be_left_out_the_second_time(read, text, steps):
    assert texts(read(text)) == steps


@pytest.mark.parametrize("joined", [", to", ", then to", " and then to", ", and to", ", and then, to"])
def test_several_goals_are_several_steps(read, joined):
    understood = read(f"go to the table{joined} the desk")
    assert texts(understood) == ["Motion(Goal=table1)", "Motion(Goal=desk1)"]
    assert understood.doubts == ()


@pytest.mark.parametrize(
    ("text", "theme"),
    [
        ("take the plates near the bowl", "plate1|plate2"),
        ("take the plates around the bowl", "plate1|plate2"),
        ("take the plates next to the bowl", "plate1|plate2"),
        ("take the cup at the desk", "cup1"),
        ("take the apple in the bowl", "apple1"),
        ("take the book lying on the desk", "book1"),
        ("take the plates that are on the table", "plate1|plate2"),
        ("take a pair of plates", "plate1|plate2"),
        ("take two plates", "plate1|plate2"),
        ("take the biggest cup", "cup1"),
        ("take the thinnest book", "book3"),
        ("take the largest plate on the table", "plate1"),
        ("take the longest thing", "bed1"),
        ("take the kitchen's milk", "milk1"),
        ("take the milk of the kitchen", "milk1"),
        ("take your cup", "cup1"),
        ("bring some water in a cup", "water1"),
        ("bring a glass of milk", "milk1"),
        ("take all plates but the biggest one", "plate2"),
        ("take all cups except the red cup on the table", "bluecup"),
        ("take all cups except the one on the desk and the red cup on the table", "bluecup"),
    ],
)
def test_a_description_is_resolved_to_the_things_that_it_fits(read, text, theme):
    understood = read(text)
    (step,) = understood.steps
    assert "|".join(step.roles["Theme"][0].entities) == theme
    assert (understood.doubts, understood.question) == ((), "")


@pytest.mark.parametrize("text", ["but not the lamp", "but no lamp", "except the lamp", "but the lamp"])
def test_an_exception_after_a_place_is_one_of_the_object(read, text):
    assert texts(read(f"take everything from the desk {text}")) == [
        "Taking(Theme=book1|cup1|laptop1, Source=desk1)"
    ]


def test_things_on_the_floor_are_those_that_stand_on_nothing(read):
    entities = read("take everything on the floor").steps[0].roles["Theme"][0].entities
    assert {"chair1", "table1", "bed1"} <= set(entities)
    assert set(entities).isdisjoint({"kettle1", "cup1", "apple1", "book3"})
    assert read("pick up the chairs that are not on the floor").doubts == (
        "'the chairs that are not on the floor': no such chair is known",
    )


@pytest.mark.parametrize(
    "text",
    [
        "take the cup to the left of the bowl",
        "take the book behind the lamp",
        "take the cup that is broken",
        "take the cup that is not broken",
    ],
)
def test_a_description_that_the_map_cannot_check_denotes_no_entity(read, text):
    understood = read(text)
    (step,) = understood.steps
    assert step.roles["Theme"][0].entities == ()
    assert understood.doubts == ()


@pytest.mark.parametrize(
    ("text", "doubt"),
    [
        ("take the bread under the table", "bread1 is not under table1; it is on counter1"),
        ("take the book under book3", "no book is known under book3"),
        ("take the plates at the bowl", "no plate is known on or in bowl1"),
        ("take the cup above the table", "no cup is known above table1"),
        ("take the plates between the red cup and the blue cup", "no plate is known there"),
        ("take three plates", "'three plates': there are only 2"),
        ("close the fridge door", "no fridge door is known"),
        ("take the milk for the kettle", "'for the kettle' is not understood"),
        ("in the kitchen, take it", "'in the kitchen' is not understood"),
        ("in the kitchen wait", "'in the kitchen wait' is not understood"),
        ("the milk, please", "'the milk' is not understood"),
        ("the milk is white, take it", "'the milk is white' is not understood"),
        ("if you can", "'if you can' is not understood"),
        ("when is dinner", "'when is dinner' is not understood"),
        ("what is it", "'what is it' is not understood"),
        ("she is in the kitchen", "'she' refers to nothing that was mentioned"),
        ("answer her question", "'her' refers to nothing that was mentioned"),
        ("answer Nora's question in the kitchen", "'in the kitchen' is not understood"),
    ],
)
def test_a_part_that_does_not_fit_is_named(read, text, doubt):
    assert doubt in read(text).doubts


@pytest.mark.parametrize(
    "text",
    ["take the cup and not the plate", "take the cup, not the plate", "take the cup but not the plate"],
)
def test_the_description_names_what_is_not_meant(read, text):
    understood = read(text)
    (step,) = understood.steps
    (theme,) = step.roles["Theme"]
    assert (theme.entities, theme.description.excluded) == (("cup1",), ("the plate",))
    assert understood.doubts == ()


@pytest.mark.parametrize(
    ("text", "steps"),
    [
        ("let me know where the kettle is", ['Telling(Addressee="me", Message="where", Topic=kettle1)']),
        (
            "let Nora know that dinner is ready",
            ['Telling(Addressee=nora1, Message="that dinner is ready")'],
        ),
        ("let Nora know", ["Telling(Addressee=nora1)"]),
        ("tell me about the kettle", ['Telling(Addressee="me", Topic=kettle1)']),
        ("report back to me", ['Telling(Addressee="to me")']),
        ("describe the kettle to Nora", ["Telling(Topic=kettle1, Addressee=nora1)"]),
        ("say something to me", ['Telling(Message="something", Addressee="to me")']),
        ("say hello to Nora", ["Greeting(Addressee=nora1)"]),
        ("show Nora where the kettle is", ['Telling(Addressee=nora1, Message="where", Topic=kettle1)']),
        (
            "tell me, where is the kettle",
            ['Telling(Addressee="me")', 'Telling(Message="where is", Topic=kettle1)'],
        ),
        ("ask Nora to leave the kitchen", ['Request(Addressee=nora1, Message="to leave the kitchen")']),
        ("ask Nora not to leave", ['Request(Addressee=nora1, Message="not to leave")']),
        ("ask for the milk", ['Questioning(Message="for the milk")']),
        ("ask Nora for her name", ['Questioning(Addressee=nora1, Message="for her name")']),
        (
            "ask Nora where the kettle is",
            ['Questioning(Addressee=nora1, Message="where the kettle is")'],
        ),
        (
            "ask Nora the way to the kitchen",
            ['Questioning(Addressee=nora1, Message="the way to the kitchen")'],
        ),
        ("ask", ["Questioning()"]),
        ("answer Nora", ["Communication_response(Addressee=nora1)"]),
        ("answer Nora in the kitchen", ["Communication_response(Addressee=nora1)"]),
        ("answer the person in the kitchen", ["Communication_response(Addressee=nora1)"]),
        ("answer the question", ['Communication_response(Trigger="the question")']),
        (
            "answer Nora's question",
            ['Communication_response(Trigger="question", Addressee=nora1)'],
        ),
        (
            "answer the question of Nora",
            ['Communication_response(Trigger="the question", Addressee=nora1)'],
        ),
        (
            "answer a question from Nora",
            ['Communication_response(Trigger="a question", Addressee=nora1)'],
        ),
        (
            "answer to the question of the person in the kitchen",
            ['Communication_response(Trigger="the question", Addressee=nora1)'],
        ),
        ("count how many cups are on the table", ["Counting(Theme=bluecup|redcup)"]),
        ("check how many cups there are", ['Telling(Message="how many", Topic=bluecup|cup1|redcup)']),
        ("check the oven", ["Inspecting(Ground=oven1)"]),
        ("make sure that the oven is off", ['Inspecting(Desired_state="that the oven is off")']),
        ("check whether the oven is on", ['Inspecting(Desired_state="whether the oven is on")']),
        ("look if the oven is on", ['Inspecting(Desired_state="if the oven is on")']),
    ],
)
def test_a_message_has_its_words_and_its_recipient(read, text, steps):
    understood = read(text)
    assert texts(understood) == steps
    assert (understood.doubts, understood.unknown, understood.question) == ((), (), "")


def test_the_head_of_a_message_is_the_word_that_carries_it(read):
    def head(text):
        return read(text).steps[-1].roles["Message"][0].head

    assert head("ask Nora for her name") == "name"
    assert head("ask Nora how old she might be") == "old"
    assert head("ask Nora to leave the kitchen") == "leave"
    assert head("ask Nora the way to the kitchen") == "way"
    assert head("tell me how many plates are on the table") == "many"


@pytest.mark.parametrize(
    ("text", "condition", "time"),
    [
        ("tell Nora at ten o'clock", "", "at ten o'clock"),
        ("tell Nora in five minutes, please", "", "in five minutes"),
        ("tell me tomorrow", "", "tomorrow"),
        ("describe the kettle to Nora at ten o'clock, please", "", "at ten o'clock"),
        ("is there a cup on the table in five minutes", "", "in five minutes"),
        ("wash the cup for ten minutes", "", "for ten minutes"),
        ("tell Nora, if she is awake, that dinner is ready", "if she is awake", ""),
        ("tell Nora to come if she is free", "if she is free", ""),
        ("tell me how many plates there are on the table if you can", "if you can", ""),
    ],
)
def test_a_time_or_condition_is_kept_beside_a_message(read, text, condition, time):
    understood = read(text)
    (step,) = understood.steps
    assert (step.condition, step.time) == (condition, time)
    assert (
        f"'{time}' {OPEN_TIME}" in understood.doubts or f"'{condition}' {OPEN_CONDITION}" in understood.doubts
    )


@pytest.mark.parametrize(
    ("text", "step"),
    [
        ("you will find Nora in the kitchen", "Being_located(Theme=nora1, Location=kitchen1)"),
        ("you find the milk on the counter", "Being_located(Theme=milk1, Location=counter1)"),
        (
            "you can probably see the kettle on the counter",
            "Being_located(Theme=kettle1, Location=counter1)",
        ),
        ("there you will find Nora", "Being_located(Theme=nora1)"),
        ("there is a cup on the table", "Being_located(Theme=bluecup|cup1|redcup, Location=table1)"),
        ("there should be a cup on the table", "Being_located(Theme=bluecup|cup1|redcup, Location=table1)"),
        ("the lamp is probably on the desk", "Being_located(Theme=lamp1, Location=desk1)"),
        ("Nora is in the kitchen", "Being_located(Theme=nora1, Location=kitchen1)"),
        ("someone is waving in the kitchen", 'Being_located(Theme="someone is waving", Location=kitchen1)'),
    ],
)
def test_a_statement_of_a_place_is_a_step_too(read, text, step):
    assert texts(read(text)) == [step]


@pytest.mark.parametrize(
    ("text", "answer"),
    [
        ("which plates are on the table", "plate1, plate2"),
        ("which of the plates is on the table", "plate1, plate2"),
        ("tell me where the cup is", "cup1 is on desk1"),
        ("Hello robot, where is the milk", "milk1 is on counter1"),
        ("where is Nora", "nora1 is in dining_corner1"),
        ("who is in the studio", "person1"),
        ("find out who is in the kitchen", "nora1"),
        ("is any milk left", "yes: milk1"),
        ("is there a cup on the table", "yes: bluecup, redcup"),
        ("are there plates", "yes: plate1, plate2"),
        ("what colour is the fridge", "fridge1: colour white"),
        ("tell me what colour the fridge is", "fridge1: colour white"),
        ("what is the colour of the fridge", "fridge1: colour white"),
        ("what is the size of the kettle", "kettle1: size 0.16 x 0.22 x 0.22 m"),
        ("what is the weight of the kettle", "kettle1: the weight is not known; look at it"),
        ("tell me Nora's name", "nora1: name Nora"),
        ("tell me the name of the person in the kitchen please", "nora1: name Nora"),
        (
            "tell me the colour of the fridge and the kettle",
            "fridge1: colour white; kettle1: the colour is not known; look at it",
        ),
        ("what does Nora look like", "'Nora': the map does not have look like; look there"),
        ("how does Nora look", "'Nora': the map does not have look; look there"),
        (
            "tell me how the person in the kitchen looks",
            "'the person in the kitchen': the map does not have looks; look there",
        ),
        ("what is under the laptop", "'what is under the laptop': none is known; look there"),
        ("how many cups are in the oven", "0: 'cups are in the oven': none is known; look there"),
        (
            "what is the heaviest thing on the table",
            "'the heaviest thing on the table': the map cannot tell; look there",
        ),
    ],
)
def test_a_question_is_answered_or_one_has_to_look(read, text, answer):
    understood = read(text)
    assert (understood.answer, understood.doubts) == (answer, ())


@pytest.mark.parametrize(
    ("text", "name", "attributes", "entities"),
    [
        ("greet the person called Nora", "Nora", (), ("nora1",)),
        ("greet the person who is called Nora", "Nora", (), ("nora1",)),
        ("greet the person called Bob", "Bob", (), ()),
        ("greet the person with glasses", "", ("with glasses",), ()),
        ("greet the person, who is waving", "", ("waving",), ()),
        ("greet the man with his hands on his head", "", ("man", "with his hands on his head"), ()),
        ("greet the woman pointing at the door", "", ("woman", "pointing at the door"), ()),
        ("greet the woman in the red dress", "", ("woman", "in the red dress"), ()),
        ("greet the person who is not waving", "", ("not waving",), ()),
        ("greet whoever is in the kitchen", "", (), ("nora1",)),
    ],
)
def test_a_person_is_described_by_name_or_looks(read, text, name, attributes, entities):
    (person,) = read(text).steps[0].roles["Addressee"]
    assert (person.description.name, person.entities) == (name, entities)
    assert sorted(person.description.attributes) == sorted(attributes)


@pytest.mark.parametrize(
    ("text", "entities"),
    [
        ("bring me something to drink", ("milk1", "water1")),
        ("bring me something to eat from the table", ("apple1", "water1")),
    ],
)
def test_something_for_a_purpose_is_of_the_class_for_it(read, text, entities):
    (theme,) = read(text).steps[0].roles["Theme"]
    assert theme.entities == entities
    assert theme.description.purpose in ("drink", "eat")


@pytest.mark.parametrize(
    ("text", "last"),
    [
        ("find the person in the kitchen and take them to the sofa", "Guiding(Cotheme=nora1, Goal=couch1)"),
        (
            "find the person in the kitchen and take them from the kitchen",
            "Guiding(Cotheme=nora1, Source=kitchen1)",
        ),
        ("find the plates and take them to the sofa", "Bringing(Theme=plate1|plate2, Goal=couch1)"),
        ("take the plates and give them to me", 'Giving(Theme=plate1|plate2, Recipient="to me")'),
        ("take the red cup and clean the blue one", "Cleaning(Theme=bluecup)"),
        (
            "if you take the milk, bring it to Nora",
            "Bringing(Theme=milk1, Beneficiary=nora1) [if you take the milk]",
        ),
    ],
)
def test_a_pronoun_takes_the_verb_of_a_person_or_of_a_thing(read, text, last):
    assert texts(read(text))[-1] == last


@pytest.mark.parametrize(
    ("text", "question"),
    [
        (
            "put the laptop between the book and the lamp",
            "Which one: the book on the desk, the one called book2 or the one on the book?",
        ),
        (
            "open the door of the kitchen",
            "Which one: the door next to the table or the one next to the fridge?",
        ),
    ],
)
def test_one_of_several_is_asked_for(read, text, question):
    assert read(text).question == question


@pytest.mark.parametrize(
    ("text", "steps"),
    [
        ("Prendi il libro più piccolo.", ["Taking(Theme=book3)"]),
        ("Prendi il libro più grande.", ["Taking(Theme=book1)"]),
        ("Prendi la tazza più pesante.", ["Taking(Theme=bluecup|cup1|redcup)"]),
        ("Prendi il piatto più grande sul tavolo.", ["Taking(Theme=plate1)"]),
        (
            "Prendi il bicchiere più alto e portalo a Nora.",
            ["Taking(Theme=glass1)", "Bringing(Theme=glass1, Beneficiary=nora1)"],
        ),
        ("Rispondi a Nora.", ["Communication_response(Addressee=nora1)"]),
        (
            "Conta le tazze sul tavolo e dimmi quante sono.",
            ["Counting(Theme=bluecup|redcup)", 'Telling(Addressee="mi", Message="quante sono")'],
        ),
    ],
)
def test_italian_superlatives_and_messages(read, text, steps):
    understood = read(text)
    assert texts(understood) == steps
    assert (understood.doubts, understood.unknown, understood.question) == ((), (), "")


@pytest.mark.parametrize(
    ("text", "superlative", "words"),
    [
        ("Prendi il libro più piccolo.", "smallest", "il libro più piccolo"),
        ("Prendi il libro più grande.", "biggest", "il libro più grande"),
        ("Prendi la tazza più pesante.", "heaviest", "la tazza più pesante"),
        ("Prendi il bicchiere più alto.", "tallest", "il bicchiere più alto"),
    ],
)
def test_an_italian_superlative_has_its_place_in_the_text(read, text, superlative, words):
    (theme,) = read(text).steps[0].roles["Theme"]
    assert (theme.description.superlative, theme.text) == (superlative, words)
