"""Explanations: reasons, clarification questions and near matches."""

import pytest

from semmap.nodes.language.reference_resolution import explanation
from semmap.nodes.language.reference_resolution.missing import missing
from semmap.nodes.language.reference_resolution.resolution import find
from tests.language.reference_resolution.kitchen import Written, item, known
from tests.language.reference_resolution.phrases import PHRASES


def told(text, **options):
    return explanation.explain(find(text, known(), Written(**options)))


@pytest.mark.parametrize("row", PHRASES, ids=[row[0] for row in PHRASES])
def test_matches_are_explained(row):
    text, _, names, said, reasons = row
    answer = explanation.explain(find(text, known(), Written(has_viewer=True), "anna"))
    assert (answer.question or answer.text) == said
    assert [candidate.entity for candidate in answer.candidates] == names.split()
    assert "; ".join(answer.candidates[0].reasons if answer.candidates else ()) == reasons


def test_each_thing_comes_with_what_fits_it():
    (only,) = told("the red cup on the table").candidates
    assert (only.entity, only.class_, only.called) == ("cup1", "Cup", "cup")
    assert only.reasons == ("called cup", "red", "on table1")
    (of_anna,) = told("Anna's mug").candidates
    assert of_anna.reasons == ("called favourite mug", "of anna")


@pytest.mark.parametrize(
    ("text", "question"),
    [
        ("the red cup", "Which one: the cup on the table or the one in the sink?"),
        ("the cup on the table", "Which one: the red cup or the blue one?"),
        ("la tazza rossa", "Quale: la tazza sul tavolo o quella nel lavandino?"),
        ("la tazza sul tavolo", "Quale: la tazza rossa o quella blu?"),
    ],
)
def test_the_question_tells_the_candidates_apart(text, question):
    assert told(text).question == question


@pytest.mark.parametrize(
    ("text", "because", "nearest"),
    [
        ("the cat", "nothing in the map is called 'cat'", []),
        ("the unicorn", "unknown word 'unicorn': no class or entity has this name", []),
        ("the open fridge", "the only thing called 'fridge' does not match 'open'", ["fridge1"]),
        (
            "the blue cup in the sink",
            "none of the 3 things called 'cup' matches 'in the sink'",
            ["cup2", "cup3"],
        ),
        ("the four cups", "only 3 things match 'the four cups'", ["cup1", "cup2", "cup3"]),
    ],
)
def test_what_nothing_fits_says_which_part_and_what_is_nearest(text, because, nearest):
    found = told(text)
    assert (found.text, [candidate.entity for candidate in found.nearest]) == (because, nearest)


def test_what_is_missing_is_known_by_its_noun_and_qualities():
    sought = missing(find("the blue cup in the sink", known(), Written()))
    assert sought.is_such(item("cup9", "Cup", hasColor="color_blue"))
    assert not sought.is_such(item("cup9", "Cup", hasColor="color_red"))
    assert not sought.is_such(item("table9", "Table", hasColor="color_blue"))
    assert ("cup2", "isInside", "sink1") in sought.pairs
    assert missing(find("the cup", known(), Written())) is None
