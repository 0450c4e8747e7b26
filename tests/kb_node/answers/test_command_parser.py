"""Commands in the shipped flat, with two more cups on its table."""

import pytest

from semmap.nodes.kb_node.answers.command_parser import CommandParser
from semmap.nodes.kb_node.answers.entity_search import EntitySearch
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Understand
from semmap.schemas.commits import Transaction
from semmap.schemas.entities import Pose


@pytest.fixture
def understanding(flat):
    x, y, _ = flat.entity("table1").pose.position_m
    _, _, top = flat.entity("bowl1").pose.position_m
    for colour, left in (("red", -0.3), ("blue", 0.3)):
        pose = Pose(position_m=(x + left, y + 0.1, top))
        cup = entity_triples.describe(
            f"{colour}cup", v.dm("Cup"), pose=pose, size_m=[0.08, 0.08, 0.1], preferred=f"{colour} cup"
        )
        flat.commit(Transaction(id=colour, source="operator", insert=tuple(cup)))
    return CommandParser(flat, EntitySearch(flat))


@pytest.mark.parametrize(
    ("text", "understood"),
    [
        ("take the cup from the desk", ["Taking(Theme=cup1, Source=desk1)"]),
        ("take the cup that is on the desk", ["Taking(Theme=cup1)"]),
        ("go to the person who is in the studio", ["Motion(Goal=person1)"]),
        (
            "take all the cups from the table to the kitchen",
            ["Bringing(Theme=bluecup|redcup, Source=table1, Goal=kitchen1)"],
        ),
        ("open the kitchen door", ["Closure(Container_portal=door3|door7)"]),
        ("apri la porta della cucina", ["Closure(Container_portal=door3|door7)"]),
        ("prendi la tazza blu e quella rossa", ["Taking(Theme=bluecup, Theme=redcup)"]),
        ("take the blue cup and the red one", ["Taking(Theme=bluecup, Theme=redcup)"]),
        ("give me something to read", ['Giving(Recipient="me", Theme=book1|book2|book3)']),
        ("portami qualcosa da bere", ['Bringing(Beneficiary="mi", Theme=milk1|water1)']),
        ("portami qualcosa da leggere", ['Bringing(Beneficiary="mi", Theme=book1|book2|book3)']),
        ("bring something to me", ['Bringing(Theme="something", Beneficiary="to me")']),
        ("spegni le lampade", ["Change_operational_state(Device=abat_jour1|lamp1)"]),
        ("open the fridge door", ["Closure(Containing_object=fridge1)"]),
    ],
)
def test_details_of_a_description_select_the_entity(understanding, text, understood):
    assert [frame.text for frame in understanding.parse(Understand(text=text)).frames] == understood


def test_an_ambiguous_word_leads_to_one_clarification_question(understanding):
    understood = understanding.parse(Understand(text="take the cup on the table and put it in the sink"))
    assert understood.frames[1].arguments[0].candidates == ("bluecup", "redcup")
    assert understood.question.startswith("Which one: the cup called blue cup or the one called red cup?")
    assert understood.question.count("red cup") == 1


@pytest.mark.parametrize(
    ("text", "understood", "doubts"),
    [
        (
            "take the red cup from the desk",
            "Taking(Theme=redcup, Source=desk1)",
            ("redcup is not on or in desk1; it is on table1",),
        ),
        ("take the red cup from the table", "Taking(Theme=redcup, Source=table1)", ()),
        ("take the laptop from the studio", "Taking(Theme=laptop1, Source=studio1)", ()),
        ("take 3 plates", "Taking(Theme=3 of plate1|plate2)", ("'3 plates': there are only 2",)),
        ("prendi due tazze", "Taking(Theme=2 of bluecup|cup1|redcup)", ()),
    ],
)
def test_parts_that_do_not_match_the_map_are_reported(understanding, text, understood, doubts):
    told = understanding.parse(Understand(text=text))
    assert ([frame.text for frame in told.frames], told.doubts) == ([understood], doubts)


OF_DESK = "{} is not on or in desk1; it is on table1"
READ = [
    # text, mood, steps, answer, doubts, unknown verbs
    ("take the red cup", "command", ["Taking(Theme=redcup)"], "", (), ()),
    (
        "take the red cup and put it on the desk",
        "command",
        ["Taking(Theme=redcup)", "Placing(Theme=redcup, Goal=desk1)"],
        *("", (), ()),
    ),
    ("where is the laptop", "question", None, "laptop1 is on desk1", (), ()),
    ("is the red cup on the table?", "question", None, "yes: redcup", (), ()),
    ("take the red cup. is the blue cup on the table?", "command", None, "yes: bluecup", (), ()),
    ("take 2 laptops", "command", None, "", ("'2 laptops': there is only 1",), ()),
    ("take the purple cup", "command", None, "", ("no purple cup is known",), ()),
    (
        "take the red cup and the blue cup from the desk",
        *("command", None, ""),
        (OF_DESK.format("redcup"), OF_DESK.format("bluecup")),
        (),
    ),
    (
        "frobnicate the fridge",
        *("command", [], ""),
        ("'frobnicate the fridge' is not understood",),
        ("frobnicate",),
    ),
    ("hello", "command", [], "", (), ()),
]


def test_steps_answers_doubts_and_unknown_verbs(understanding):
    for text, mood, steps, answer, doubts, unknown in READ:
        found = understanding.parse(Understand(text=text))
        assert (found.mood, found.answer, found.doubts, found.unknown) == (mood, answer, doubts, unknown)
        assert steps is None or [step.text for step in found.steps] == steps
        assert bool(found.steps) == (steps != [])
        assert found.question == ""
        assert mood == "command" or found.frames == ()


def test_a_new_entity_is_known_to_the_next_command(flat, understanding):
    (frame,) = understanding.parse(Understand(text="take the green cup")).frames
    assert frame.text == "Taking(Theme=bluecup|cup1|redcup)"
    cup = entity_triples.describe(
        "greencup", v.dm("Cup"), pose=Pose(position_m=(0, 0, 0)), preferred="green cup"
    )
    flat.commit(Transaction(id="green", source="operator", insert=tuple(cup)))
    (frame,) = understanding.parse(Understand(text="take the green cup")).frames
    assert frame.text == "Taking(Theme=greencup)"


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("?!", "the command contains no words"),
        ("take " + "the " * 199 + "cup", "the command has 201 words; the maximum is 200"),
    ],
)
def test_a_command_has_words_but_not_too_many(semantic_map, text, problem):
    parser = CommandParser(semantic_map, EntitySearch(semantic_map))
    with pytest.raises(errors.BadRequest, match=problem):
        parser.parse(Understand(text=text))
