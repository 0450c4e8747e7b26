"""Natural-language commands and descriptions through the command line and the client."""

import json

import pytest

from semmap.schemas import errors
from tests.extern.cli.commands.test_query import said


@pytest.fixture(scope="module")
def system(empty_map):
    with empty_map.client() as client:
        client.add("Kitchen", "kitchen1", at=(0, 0, 0), size=(4, 4, 3))
        client.add("Bottle", "bottle1", at=(1, 1, 0), ref="lemonade")
    return empty_map


def test_a_command_is_understood_in_the_light_of_the_map(system, monkeypatch):
    text, status = said(system, monkeypatch, "understand", "Bring the lemonade to the kitchen, please!")
    assert (text, status) == ("Bringing(Theme=bottle1, Goal=kitchen1)\n", 0)
    with system.client() as client:
        client.update("bottle1", ref="wine")
        assert client.understand("bring the wine to the kitchen").frames[0].arguments[0].entity == "bottle1"
        assert client.understand("bring the beer").frames[0].text == 'Bringing(Theme="the beer")'
        client.update("bottle1", ref="lemonade")


def test_other_forms(system, monkeypatch):
    text, _ = said(system, monkeypatch, "understand", "grab the lemonade", "--format", "lu4r")
    frame = json.loads(text)["frames"][0]
    assert (frame["cfr"], frame["groundedCfr"]) == ('TAKING(theme:"the lemonade")', "TAKING(theme:bottle1)")
    text, _ = said(system, monkeypatch, "understand", "grab the lemonade", "--format", "json")
    assert json.loads(text)["frames"][0]["arguments"][0]["span"] == [2, 3]


def test_the_map_is_described_in_few_words(system, monkeypatch, capsys):
    text, status = said(system, monkeypatch, "tell")
    assert (text, status) == ("The map has one place and one thing. The kitchen has a lemonade.\n", 0)
    text, _ = said(system, monkeypatch, "tell", "kitchen", "--words", "20", "--format", "json")
    told = json.loads(text)
    assert told["text"] == "The kitchen (kitchen1) has one thing. It has a lemonade."
    assert (told["words"], told["left_out"]) == (10, 0)
    with system.client() as client:
        assert client.tell("lemonade", words=20).text.startswith(
            "bottle1 is a lemonade in the kitchen (kitchen1)."
        )
        with pytest.raises(errors.BadRequest, match="words must be"):
            client.tell(words=3)
    for words, wrong, sentence in (
        (("tell", "teapot"), 1, "no entity has the name, label or class 'teapot'"),
        (("tell", "--words", "0"), 2, "0 is not in the range"),
        (("tell", ""), 1, ""),
    ):
        text, status = said(system, monkeypatch, *words)
        assert (text, status) == ("", wrong)
        assert sentence in capsys.readouterr().err


def test_italian_needs_no_flag(system, monkeypatch):
    text, status = said(system, monkeypatch, "understand", "Portami la bottiglia, per favore!")
    assert (text, status) == ('Bringing(Beneficiary="mi", Theme=bottle1)\n', 0)
    text, _ = said(
        system, monkeypatch, "understand", "prendi bottle1", "--language", "italian", "--format", "json"
    )
    document = json.loads(text)
    assert (document["language"], document["frames"][0]["arguments"][0]["entity"]) == ("italian", "bottle1")
    with system.client() as client:
        assert client.understand("prendi la bottiglia").language == "italian"
        with pytest.raises(errors.BadRequest, match="one of english, italian"):
            client.understand("prendi la bottiglia", language="klingon")


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("how are you", "is a question"),
        ("i took the lemonade", "is a statement about the past"),
        ("hi", "example: take the cup"),
    ],
)
def test_another_text_than_a_command_has_a_reason(system, monkeypatch, capsys, text, why):
    assert said(system, monkeypatch, "understand", text) == ("", 1)
    assert why in capsys.readouterr().err


def test_which_of_several_is_meant_is_asked_back(system, monkeypatch):
    with system.client() as client:
        client.add("Table", "table1", at=(3, 0, 0), size=(1, 1, 0.7))
        client.add("Desk", "desk1", at=(0, 3, 0), size=(1, 1, 0.7))
        client.add("Cup", "cup1", at=(3, 0, 0.7), size=(0.1, 0.1, 0.1))
        client.add("Cup", "cup2", at=(0, 3, 0.7), size=(0.1, 0.1, 0.1))
        try:
            text, status = said(system, monkeypatch, "understand", "take the cup")
            question = "Which one: the cup on the table or the one on the desk?"
            assert (text, status) == (f"Taking(Theme=cup1|cup2)\n{question}\n", 0)
            understood = client.understand("prendi la tazza")
            assert understood.question == "Quale: la tazza sul tavolo o quella sulla scrivania?"
            assert understood.frames[0].arguments[0].ambiguous
            assert client.understand("take the cup on the desk").frames[0].arguments[0].entity == "cup2"
            assert client.understand("prendi la tazza sulla scrivania").frames[0].text == "Taking(Theme=cup2)"
            for text in (
                "take a cup",
                "take the cups",
                "prendi una tazza",
                "prendi le tazze",
                "take the lemonade",
            ):
                assert not client.understand(text).question, text
        finally:
            for name in ("cup1", "cup2", "table1", "desk1"):
                client.remove(name)


@pytest.mark.parametrize(
    ("text", "understood"),
    [
        ("\x1b[31mtake\x07 the lemonade\x00", "Taking(Theme=bottle1)"),
        ("<b>take</b> the lemonade <script src='x'>", "Taking(Theme=bottle1)"),
        ("take 🍋 the 🍋 lemonade", "Taking(Theme=bottle1)"),
        ("TAKE THE LEMONADE!!!", "Taking(Theme=bottle1)"),
        ("take Bottle", "Taking(Theme=bottle1)"),  # what is also a class
        ("nimm die Flasche vom Tisch", ""),
        ("возьми бутылку", ""),
        ("ボトルを取って", ""),
        ("\"; -- '' take", "Taking()"),
    ],
)
def test_whatever_is_said_is_answered(system, text, understood):
    with system.client() as client:
        assert "".join(frame.text for frame in client.understand(text).frames) == understood


def test_another_text_than_a_command_is_reported(system, monkeypatch, capsys):
    text, status = said(system, monkeypatch, "understand", "frobnicate the lemonade")
    assert (text, status) == ("", 1)
    assert "unknown verb: frobnicate" in capsys.readouterr().err
    text, status = said(system, monkeypatch, "understand", "🤖")
    assert (text, status) == ("", 2)
    assert "contains no words" in capsys.readouterr().err
    with system.client() as client:
        with pytest.raises(errors.BadRequest, match="the maximum is 200"):
            client.understand("go " * 300)
        with pytest.raises(errors.BadRequest, match="1 to 1000 characters"):
            client.understand("go " * 10_000)
        with pytest.raises(errors.BadRequest, match="1 to 1000 characters"):
            client.understand("")


@pytest.fixture
def kitchen(system):
    with system.client() as client:
        client.add("Table", "table1", at=(0, 0, 0), size=(0.8, 1.2, 0.75))
        client.add("Cup", "cup1", at=(0, 0.3, 0.75))
        client.set("cup1", "hasColor", "red")
        client.add("Cup", "cup2", at=(1, -1, 0))
        client.set("cup2", "hasColor", "blue")
        yield system
        client.remove("table1", "cup1", "cup2")


def test_a_thing_is_found_by_what_is_said_of_it(kitchen, monkeypatch):
    text, status = said(kitchen, monkeypatch, "find", "the red cup on the kitchen table")
    assert (text, status) == ("cup1: a cup, red, on table1\n", 0)
    text, status = said(kitchen, monkeypatch, "find", "la tazza blu", "--format", "json")
    found = json.loads(text)
    assert (found["outcome"], found["candidates"][0]["entity"], status) == ("one", "cup2", 0)
    with kitchen.client() as client:
        found = client.find("the cup left of the table", viewpoint=(-2.0, -0.5, 1.0, 0.0))
        assert (found.outcome, found.seq) == ("none", client.status().commit)


def test_what_is_ambiguous_is_asked_back_and_what_is_not_there_is_reported(kitchen, monkeypatch, capsys):
    text, status = said(kitchen, monkeypatch, "find", "the cup")
    assert text.splitlines()[-1] == "Which one: the red cup or the blue one?"
    assert status == 0
    text, status = said(kitchen, monkeypatch, "find", "the green cup")
    assert (text, status) == ("", 1)
    reason = "none of the 2 things called 'cup' matches 'green'\nnearest:\n"
    assert capsys.readouterr().err.startswith(reason)


@pytest.mark.parametrize(
    ("text", "because"),
    [
        ("🤖", "contains no words"),
        ("", "1 to 1000 characters"),
        ("cup " * 100, "the maximum is 60"),
        ("the cup that was on the table", "asks about the past"),
        ("the second cup from the left", "require a viewpoint"),
    ],
)
def test_what_cannot_be_found_by_says_what_can(kitchen, monkeypatch, capsys, text, because):
    printed, status = said(kitchen, monkeypatch, "find", text)
    assert (printed, status) == ("", 2)
    assert because in capsys.readouterr().err
