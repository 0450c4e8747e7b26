"""Commands as people say them: politeness, relative clauses without a pronoun, manner, lists of places."""

import pytest


def texts(understood):
    return [step.text for step in understood.steps]


@pytest.mark.parametrize(
    ("text", "step"),
    [
        ("how about you take the milk", "Taking(Theme=milk1)"),
        ("what I want you to do is take the milk", "Taking(Theme=milk1)"),
        ("could somebody take the milk", "Taking(Theme=milk1)"),
        ("hey buddy, take the milk, will you?", "Taking(Theme=milk1)"),
        ("carefully take the milk", 'Taking(Theme=milk1, Manner="carefully")'),
        ("slowly go to the kitchen", 'Motion(Goal=kitchen1, Manner="slowly")'),
        ("take the milk with both hands", 'Taking(Theme=milk1, Manner="with both hands")'),
        ("take the kettle along to the studio", "Bringing(Theme=kettle1, Goal=studio1)"),
        ("find the kettle for me", "Locating(Sought_entity=kettle1)"),
        ("find the biggest cup in the house", 'Locating(Sought_entity=cup1, Ground="in the house")'),
        ("take a cup that is not red", "Taking(Theme=bluecup|cup1)"),
        ("take the cup down from the desk", "Taking(Theme=cup1, Source=desk1)"),
        ("take the plates stacked on the table", "Taking(Theme=plate1|plate2)"),
        ("take the plates we have on the table", "Taking(Theme=plate1|plate2)"),
        ("greet the lady waiting at the table", 'Greeting(Addressee="the lady waiting at the table")'),
        ("greet the boy whose arm is raised", 'Greeting(Addressee="the boy whose arm is raised")'),
        ("follow the person that just came in", 'Cotheme(Cotheme="the person that just came in")'),
        ("look for the kettle in the kitchen and the studio",
         "Locating(Sought_entity=kettle1, Ground=kitchen1, Ground=studio1)"),
        ("tell me the shirt colour of the person in the kitchen",
         'Telling(Addressee="me", Message="the shirt colour", Topic=nora1)'),
    ],
)  # fmt: skip
def test_what_people_say_is_read_without_doubts(read, text, step):
    understood = read(text)
    assert texts(understood) == [step]
    assert (understood.doubts, understood.unknown, understood.question) == ((), (), "")


@pytest.mark.parametrize(
    ("text", "steps"),
    [
        ("do you know where the kettle is? bring it here",
         ['Telling(Message="where", Topic=kettle1)', 'Bringing(Theme=kettle1, Goal="here")']),
        ("take the milk and carefully put it on the table",
         ["Taking(Theme=milk1)", 'Placing(Theme=milk1, Goal=table1, Manner="carefully")']),
        ("only go to the kitchen if it is dark", ["Motion(Goal=kitchen1) [if it is dark]"]),
        ("I think Nora is in the kitchen, follow her",
         ["Being_located(Theme=nora1, Location=kitchen1)", "Cotheme(Cotheme=nora1)"]),
        ("someone in the kitchen is waving, go there",
         ['Being_located(Theme="someone in the kitchen is waving")', "Motion(Goal=kitchen1)"]),
        ("on the desk there is a laptop: take it",
         ["Being_located(Theme=laptop1, Location=desk1)", "Taking(Theme=laptop1)"]),
        ("find out the name of the person in the kitchen and report it to me",
         ['Telling(Message="the name", Topic=nora1)', 'Telling(Topic="it", Addressee="to me")']),
        ("after you've put the milk on the table, come back",
         ["Motion() [after you've put the milk on the table]"]),
        ("make sure nobody is in the kitchen", ['Inspecting(Desired_state="nobody is in the kitchen")']),
        ("answer whatever Nora asks", ['Communication_response(Trigger="whatever Nora asks")']),
        ("take the red or the blue cup", ["Taking(Theme=redcup|bluecup)"]),
        ("take the person standing next to the stove to the sofa, he is called Ben",
         ['Guiding(Cotheme="the person standing next to the stove", Goal=couch1)']),
        ("Meet Nora in the kitchen, ask her to leave",
         ["Make_acquaintance(Individual_2=nora1)", 'Request(Addressee=nora1, Message="to leave")']),
        ("Nora's waiting in the kitchen, bring her the milk",
         ["Being_located(Theme=nora1, Location=kitchen1)", "Bringing(Beneficiary=nora1, Theme=milk1)"]),
        ("the kettle belongs on the desk, put it there", ['Placing(Theme=kettle1, Goal=desk1)']),
        ("take the cup from the desk, not the one from the table", ["Taking(Theme=cup1, Source=desk1)"]),
        ("guide Nora and Ben to the sofa one after the other",
         ['Guiding(Cotheme=nora1, Cotheme="Ben", Goal=couch1, Manner="one after the other")']),
        ("bring Nora and Ben a plate each",
         ['Bringing(Beneficiary=nora1, Beneficiary="Ben", Theme=plate1|plate2, Manner="each")']),
        ("ask Nora for her name and tell it to me",
         ['Questioning(Addressee=nora1, Message="for her name")', 'Telling(Topic="it", Addressee="to me")']),
        ("keep an eye on Nora", ["Perception_active(Phenomenon=nora1)"]),
        ("I'd prefer the milk", ['Bringing(Beneficiary="I", Theme=milk1)']),
        ("give me whatever is on the desk", ['Giving(Recipient="me", Theme=book1|cup1|lamp1|laptop1)']),
    ],
)  # fmt: skip
def test_several_clauses_keep_their_words(read, text, steps):
    assert texts(read(text)) == steps


def test_a_way_that_is_not_understood_is_named(read):
    understood = read("go to the kitchen using the back door")
    assert texts(understood) == ["Motion(Goal=kitchen1)"]
    assert understood.doubts == ("'using the back door' is not understood",)


def test_no_thing_without_a_colour_is_a_doubt(read):
    assert read("take the milk that is not white").doubts == ()
    understood = read("take the red cup that is not red")
    assert understood.doubts


def test_a_room_is_not_carried(read):
    understood = read("Nora, who is in the kitchen, needs a plate. Take it to her.")
    assert "kitchen1" not in understood.steps[-1].text
    assert any("who is in the kitchen" in doubt for doubt in understood.doubts)
