"""Descriptions resolved in a house of three rooms, with the reasons, questions and near matches.

Each paragraph of a file in `found/` is a description and the reply: its outcome, a line for each candidate
with its class, label and reasons, the question after `?`, and what comes near.
"""

from pathlib import Path

import pytest

from semmap.nodes.language.reference_resolution.explanation import explain
from semmap.nodes.language.reference_resolution.resolution import find
from semmap.schemas import errors
from tests.language.reference_resolution.house import House, known
from tests.language.reference_resolution.rendering import render

FILES = sorted((Path(__file__).parent / "found").glob("*.txt"))
FOUND = [paragraph.splitlines() for file in FILES for paragraph in file.read_text().split("\n\n")]


@pytest.fixture(scope="module")
def house():
    return known()


@pytest.mark.parametrize("lines", FOUND, ids=[lines[0].removeprefix("> ") for lines in FOUND])
def test_a_description_is_explained_completely(house, lines):
    text, *reply = lines
    found = explain(find(text.removeprefix("> "), house, House(has_viewer=True), "anna"))
    assert render(found) == reply


@pytest.mark.parametrize(
    ("text", "answer", "names"),
    [
        ("the red book", "Anna's", "book1"),
        ("the red book", "the one of Bob", "book2"),
        ("the red book", "Emma", "book1"),
        ("the red book", "the bigger one", "book2"),
        ("the red book", "the blue one", ""),
        ("the red book", "both", "book1 book2"),
        ("the door", "the open one", "door2"),
        ("the door", "the front door", "door1"),
        ("the door", "not the open one", "door1 door3"),
        ("the box", "the upper one", "box2"),
        ("the box", "the one under the bed", "box3"),
        ("the box", "box1", "box1"),
        ("the box", "a chair", ""),
        ("the drawer", "the top one", "drawer3"),
        ("the chair", "the second from the left", "chair2"),
        ("the chair", "the green one or the white one", "chair3 chair4"),
        ("il libro rosso", "quello di Bob", "book2"),
        ("la scatola", "quella sotto il letto", "box3"),
        ("the blue book", "the one on the table", "book3"),
    ],
)
def test_an_answer_selects_among_the_candidates_of_the_question(house, text, answer, names):
    answered = find(text, house, House(has_viewer=True), "anna", answer)
    assert " ".join(sorted(answered.names)) == names


@pytest.mark.parametrize(
    ("text", "question"),
    [
        ("the lamp", "Which one: the lamp called lamp1, the one called lamp2 or the one called lamp3?"),
        ("the chair", "Which one: the chair called chair1, the one called chair2, the one called chair3 or"
                      " the one called chair4?"),
        ("the first chair", "From where is the first counted? Give a viewer (--from VIEWER) or a reference"
                            " object."),
        ("the red book", "Which one: the book of Anna or the one of Bob?"),
        ("the window", "Which one: the window that is open or the one that is closed?"),
        ("the table", "Which one: the table of wood or the one of glass?"),
    ],
)  # fmt: skip
def test_without_a_viewer_a_question_names_no_position(house, text, question):
    assert explain(find(text, house, House())).question == question


def test_my_needs_a_speaker_unless_the_question_asks_for_the_owner(house):
    with pytest.raises(errors.BadRequest) as raised:
        find("the book in my drawer", house, House(has_viewer=True))
    assert str(raised.value) == "the owner 'my' requires a speaker; add --for PERSON"
    found = explain(find("my book", house, House(has_viewer=True)))
    assert found.question == "Which one: the book of Anna or the one of Bob?"
