"""Interpretation of commands with the shipped taggers."""

import random

import pytest

from semmap.nodes.language.understanding.grounding import Thing
from semmap.nodes.language.understanding.interpretation import shipped
from tests.language.household import THINGS, there


def read(text, things=THINGS):
    return shipped().understand(text, there(things))


def frames(text, things=THINGS):
    return [frame.text for frame in read(text, things).frames]


@pytest.mark.parametrize(
    ("text", "understood"),
    [
        ("take the bottle from the kitchen table", ["Taking(Theme=bottle1, Source=table1)"]),
        ("Could you bring the novel to the sofa?", ["Bringing(Agent=robot1, Theme=book1, Goal=couch1)"]),
        (
            "go to the kitchen and open the fridge",
            ["Motion(Goal=kitchen1)", "Closure(Containing_object=fridge1)"],
        ),
        (
            "find the novel and bring it to me",
            ["Locating(Sought_entity=book1)", 'Bringing(Theme=book1, Beneficiary="to me")'],
        ),
        ("follow me slowly", ['Cotheme(Cotheme="me", Manner="slowly")']),
        ("this is the kitchen", ['Being_in_category(Item="this", Category=kitchen1)']),
        ("don't open the fridge", ["not Closure(Containing_object=fridge1)"]),
        ("turn left by 90 degrees", ['Change_direction(Direction="left", Angle="by 90 degrees")']),
    ],
)
def test_a_command_is_frames_with_entities(text, understood):
    assert frames(text) == understood


@pytest.mark.parametrize(
    ("text", "understood", "groundings"),
    [
        (
            "bring me the novel and the bottle",
            ['Bringing(Beneficiary="me", Theme=book1)'],
            {4: "book1", 7: "bottle1"},
        ),
        (
            "take the bottle and the novel to the kitchen",
            ["Bringing(Theme=bottle1, Goal=kitchen1)"],
            {3: "bottle1", 6: "book1", 9: "kitchen1"},
        ),
        (
            "take the mug from the table in the kitchen to the sofa",
            ['Bringing(Theme="the mug", Source=table2, Goal=kitchen1)'],
            {6: "table2", 9: "kitchen1", 12: "couch1"},
        ),
        (
            "open the door of the fridge",
            ['Closure(Container_portal="the door of the fridge")'],
            {6: "fridge1"},
        ),
        ("open the fridge door", ["Closure(Container_portal=fridge1)"], {3: "fridge1", 4: "fridge1"}),
        (
            "close the fridge and switch on the lamp",
            [
                "Closure(Containing_object=fridge1)",
                'Change_operational_state(Operational_state="on", Device="the lamp")',
            ],
            {3: "fridge1"},
        ),
        ("take the blue cup and the red one", ['Taking(Theme="the blue cup and the red one")'], {}),
        ("bring two books to the sofa", ["Bringing(Theme=book1, Goal=couch1)"], {3: "book1", 6: "couch1"}),
        ("put it on the table", ['Placing(Theme="it", Goal=table2)'], {5: "table2"}),
        (
            "could you please go to the kitchen",
            ["Motion(Theme=robot1, Goal=kitchen1)"],
            {2: "robot1", 7: "kitchen1"},
        ),
        (
            "go to the kitchen and then to the bedroom",
            ['Motion(Goal=kitchen1, Goal="to the bedroom")'],
            {4: "kitchen1"},
        ),
        (
            "go to the kitchen, take the bottle and bring it here",
            ["Motion(Goal=kitchen1)", "Taking(Theme=bottle1)", 'Bringing(Theme=bottle1, Goal="here")'],
            {4: "kitchen1", 7: "bottle1", 10: "bottle1"},
        ),
        (
            "please follow the person slowly to the kitchen",
            ['Cotheme(Cotheme="the person", Manner="slowly", Goal=kitchen1)'],
            {8: "kitchen1"},
        ),
        (
            "the book is on the table",
            ["Being_located(Theme=book1, Location=table2)"],
            {2: "book1", 6: "table2"},
        ),
        (
            "do not take the bottle and do not open the fridge",
            ["not Taking(Theme=bottle1)", "not Closure(Containing_object=fridge1)"],
            {5: "bottle1", 11: "fridge1"},
        ),
        (
            "find the book near the fridge",
            ["Locating(Sought_entity=book1, Ground=fridge1)"],
            {3: "book1", 6: "fridge1"},
        ),
        (
            "search for the bottle in the kitchen and in the bedroom",
            ['Locating(Sought_entity=bottle1, Ground=kitchen1, Ground="in the bedroom")'],
            {4: "bottle1", 7: "kitchen1"},
        ),
        (
            "check if the fridge is open",
            ['Inspecting(Ground=fridge1, Desired_state="is open")'],
            {4: "fridge1"},
        ),
        ("give the book to the man", ['Giving(Theme=book1, Recipient="to the man")'], {3: "book1"}),
        ("give me the book", ['Giving(Recipient="me", Theme=book1)'], {4: "book1"}),
        ("hand him the novel", ['Giving(Recipient="him", Theme=book1)'], {4: "book1"}),
        ("move along the wall", ['Motion(Path="along the wall")'], {}),
        ("move away from the table", ["Motion(Source=table2)"], {5: "table2"}),
        ("move the chair next to the table", ['Motion(Theme="the chair", Goal=table2)'], {7: "table2"}),
        ("turn to the left", ['Change_direction(Direction="to the left")'], {}),
        ("turn around", ['Change_direction(Direction="around")'], {}),
        ("this is a table", ['Being_in_category(Item="this", Category=table2)'], {4: "table2"}),
        ("look at the picture", ['Perception_active(Phenomenon="at the picture")'], {}),
        ("inspect the oven", ['Inspecting(Ground="the oven")'], {}),
        ("release the bottle", ["Releasing(Theme=bottle1)"], {3: "bottle1"}),
        (
            "grasp the handle of the fridge",
            ['Manipulation(Entity="the handle of the fridge")'],
            {6: "fridge1"},
        ),
        ("come with me to the kitchen", ['Cotheme(Cotheme="with me", Goal=kitchen1)'], {6: "kitchen1"}),
        (
            "put the books on the table under the lamp",
            ["Placing(Theme=book1, Goal=table2)"],
            {3: "book1", 6: "table2"},
        ),
        ("take it to the kitchen", ['Bringing(Theme="it", Goal=kitchen1)'], {5: "kitchen1"}),
        (
            "bring the book or the bottle to the table",
            ["Bringing(Theme=book1, Goal=table2)"],
            {3: "book1", 6: "bottle1", 9: "table2"},
        ),
        ("frobnicate the book", [], {}),
        (
            "i want you to bring the newspaper near the couch",
            ["Bringing(Agent=robot1, Theme=book1, Goal=couch1)"],
            {3: "robot1", 7: "book1", 10: "couch1"},
        ),
        (
            "take all the books to the kitchen",
            ["Bringing(Theme=book1, Goal=kitchen1)"],
            {4: "book1", 7: "kitchen1"},
        ),
    ],
)
def test_a_command_has_frames_and_words_that_name_entities(text, understood, groundings):
    found = read(text)
    assert [frame.text for frame in found.frames] == understood
    assert {one.token: one.entity for one in found.groundings} == groundings
    for frame in found.frames:
        for argument in frame.arguments:
            first, last = argument.span
            assert 1 <= first <= argument.head <= last <= len(found.words)


def test_where_things_are_tells_taking_from_bringing():
    near = [t for t in THINGS if t.name != "table2"]
    assert frames("take the bottle on the table", near)[0].startswith("Taking")
    far = [t for t in THINGS if t.name != "table1"]
    assert frames("take the bottle on the table", far) == ["Bringing(Theme=bottle1, Goal=table2)"]


def test_of_several_things_the_nearest_tells():
    chairs = tuple(Thing(f"chair{n}", "Chair", (), (2.0 + n, 2.5, 0.0)) for n in range(5))
    things = (Thing("desk1", "Desk", (), (6.2, 2.5, 0.0)), *chairs)
    for order in (things, things[::-1]):
        assert frames("take the chair near the desk", order) == ["Taking(Theme=chair4)"]


@pytest.mark.parametrize(
    ("text", "ambiguous"),
    [
        ("take the bottle", True),
        ("take a bottle", False),
        ("take the bottles", False),
        ("take both bottles", False),
        ("prendi la bottiglia", True),
        ("prendi le bottiglie", False),
        ("prendi una bottiglia", False),
    ],
)
def test_any_and_several_are_not_ambiguous(text, ambiguous):
    bottles = tuple(Thing(f"bottle{n}", "Bottle") for n in (1, 2))
    assert read(text, bottles).frames[0].arguments[0].ambiguous == ambiguous


def test_noun_phrases_are_resolved_in_the_map():
    bottles = tuple(Thing(f"bottle{n}", "Bottle") for n in (1, 2, 3))
    asked = []

    def resolve(text):
        asked.append(text)
        return ("bottle2", "bottle3", "cup1")

    theme = (
        shipped().understand("take the red bottle", there(bottles), resolve=resolve).frames[0].arguments[0]
    )
    assert asked == ["the red bottle"]
    assert theme.candidates == ("bottle2", "bottle3")


LISTED = (
    *(thing for thing in THINGS if thing.name != "fridge1"),
    Thing("oven1", "Oven", ("oven",), (7.0, 0.4, 0.0), ("Openable_Thing",)),
    Thing("door1", "Door", (), (5.0, 5.0, 0.0)),
    Thing("door2", "Door", (), (9.0, 5.0, 0.0)),
    Thing("fridge1", "Fridge", ("fridge",), (6.4, 0.4, 0.0), ("Openable_Thing",)),
)


@pytest.mark.parametrize(
    ("text", "understood"),
    [
        ("open the fridge and the oven", ["Closure(Containing_object=fridge1, Containing_object=oven1)"]),
        ("apri il frigo e il forno", ["Closure(Containing_object=fridge1, Containing_object=oven1)"]),
        (
            "bring the bottle, the novel and the robot to the kitchen",
            ["Bringing(Theme=bottle1, Theme=book1, Theme=robot1, Goal=kitchen1)"],
        ),
        ("go to the kitchen and the sofa", ["Motion(Goal=kitchen1, Goal=couch1)"]),
        ("take the bottle and go to the sofa", ["Taking(Theme=bottle1)", "Motion(Goal=couch1)"]),
        (
            "place the bottle between the sofa and the fridge",
            ["Placing(Theme=bottle1, Goal=couch1, Goal=fridge1)"],
        ),
        (
            "grab the bottle from the kitchen table and the novel from the side table",
            ["Taking(Theme=bottle1, Source=table1)", "Taking(Theme=book1, Source=table2)"],
        ),
        ("push the sofa to the side table", ["Manipulation(Entity=couch1, Goal=table2)"]),
        (
            "porta la bottiglia e il libro in cucina",
            ["Bringing(Theme=bottle1, Theme=book1, Goal=kitchen1)"],
        ),
        ("open the door of the fridge", ["Closure(Containing_object=fridge1)"]),
        ("apri la porta del frigo", ["Closure(Containing_object=fridge1)"]),
        ("open the door", ["Closure(Container_portal=door1|door2)"]),
        ("take the bottle that is on the side table", ["Taking(Theme=bottle1)"]),
    ],
)
def test_a_list_has_an_argument_for_each_thing(text, understood):
    told = shipped().understand(text, there(LISTED), resolve=lambda _: ())
    assert [frame.text for frame in told.frames] == understood


@pytest.mark.parametrize(
    ("text", "slot", "entity", "head"),
    [
        ("open the door of the fridge", "Containing_object", "fridge1", 6),
        ("please open the door of the oven", "Containing_object", "oven1", 7),
        ("open the fridge door", "Containing_object", "fridge1", 3),
        ("open the door of the kitchen", "Container_portal", "door2", 3),
        ("open the door of the sofa", "Container_portal", "door1", 3),
    ],
)
def test_what_has_a_door_of_its_own_is_what_is_opened_and_named_by_its_own_word(text, slot, entity, head):
    """Between rooms a door is a thing of its own."""
    (frame,) = shipped().understand(text, there(LISTED), resolve=lambda _: ()).frames
    (argument,) = frame.arguments
    assert (argument.role, argument.entity, argument.head) == (slot, entity, head)


def test_the_corpus_has_lists_and_relative_clauses_whole():
    assert frames("grab the bottle and the novel") == ["Taking(Theme=bottle1)"]
    assert len(frames("take the bottle that is on the side table")) == 2


def test_words_count_from_one_and_heads_are_inside():
    understood = read("take the bottle from the kitchen table")
    theme, source = understood.frames[0].arguments
    assert (understood.words[theme.head - 1], theme.span) == ("bottle", (2, 3))
    assert (understood.words[source.head - 1], source.text) == ("table", "from the kitchen table")
    assert {(g.token, g.entity) for g in understood.groundings} == {
        (3, "bottle1"),
        (6, "table1"),
        (7, "table1"),
    }


@pytest.mark.parametrize(
    ("text", "understood", "unknown"),
    [
        ("frobnicate the bottle", [], ("frobnicate",)),
        ("stop", [], ("stop",)),
        ("wait here", [], ("wait",)),
        ("fermati", [], ("stop",)),
        ("clean the sofa", [], ("clean",)),
        ("take the bottle and wash it", ["Taking(Theme=bottle1)"], ("wash",)),
        (
            "go to the kitchen, open the fridge",
            ["Motion(Goal=kitchen1)", "Closure(Containing_object=fridge1)"],
            (),
        ),
        ("non andare mai in cucina", ["not Motion(Goal=kitchen1)"], ()),
        ("prendi la bottiglia che e' sul divano", ["Taking(Theme=bottle1)"], ()),
    ],
)
def test_unknown_verbs_are_said_to_be_unknown(text, understood, unknown):
    told = shipped().understand(text, there(), resolve=lambda _: ())
    assert ([frame.text for frame in told.frames], told.unknown) == (understood, unknown)


def test_what_may_be_several_is_none_of_them():
    bottles = (*THINGS, *(type(THINGS[4])(f"bottle{n}", "Bottle", ("bottle",), None) for n in (2, 3)))
    theme = read("grab the bottle", bottles).frames[0].arguments[0]
    assert (theme.entity, theme.candidates) == (None, ("bottle1", "bottle2", "bottle3"))


def test_the_order_of_the_map_does_not_matter():
    text = "take the bottle near the novel on the table to the sofa"
    expected = read(text)
    for seed in range(5):
        assert read(text, random.Random(seed).sample(THINGS, len(THINGS))) == expected


@pytest.mark.parametrize("text", ["", "please", "the the the", "of on to", "9 9 9", "and and", "you"])
def test_other_moods_have_no_frames(text):
    assert read(text).frames == ()
