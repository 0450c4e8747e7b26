"""Scores of what was understood."""

import json

import pytest

from benchmarks.language import __main__ as language
from benchmarks.language import trials
from benchmarks.language.scoring import scores
from nodes.language.grounding import Thing
from nodes.training.language import corpus
from nodes.training.language.corpus import Example, Filled, Role
from schemas.language import Argument, Frame, Grounded, Understood
from tests.data import data_folder

WORDS = ("take", "the", "book", "to", "me")
EXAMPLE = Example(
    "1",
    "group",
    WORDS,
    (Filled("Bringing", (1,), (Role("Theme", 2, 3, 3), Role("Beneficiary", 4, 5))),),
    (Thing("book1", "Book"),),
    ((3, "book1"), (5, "nobody")),
)
THEME = Argument("Theme", "the book", (2, 3), 3, "book1")
TO_ME = Argument("Beneficiary", "to me", (4, 5), 5)


GROUNDED = (Grounded(3, "book1"),)


def said(name, *arguments, groundings=GROUNDED):
    return scores([(EXAMPLE, Understood(WORDS, (Frame(name, (1,), arguments),), groundings))])


def test_all_right_is_one():
    found = said("Bringing", THEME, TO_ME)
    assert (found.frames, found.spans, found.heads, found.groundings, found.whole) == (1, 1, 1, 1, 1)


def test_arguments_of_a_wrong_frame_are_wrong():
    found = said("Taking", THEME, TO_ME)
    assert (found.frames, found.spans, found.spans_in_right_frames, found.whole) == (0, 0, 0, 0)


def test_a_span_may_be_wrong_and_its_head_right():
    found = said("Bringing", Argument("Theme", "book", (3, 3), 3, "book1"), TO_ME)
    assert (found.spans, found.heads, found.whole) == (0.5, 1, 1)


def test_too_much_and_too_little_cost():
    assert said("Bringing", THEME).spans == pytest.approx(2 / 3)
    assert said("Bringing", THEME, TO_ME, TO_ME).spans == pytest.approx(4 / 5)
    assert said("Bringing", THEME, TO_ME, groundings=()).whole == 0
    assert said("Bringing", THEME, TO_ME, groundings=(Grounded(3, "cup1"),)).groundings == 0
    assert said("Bringing", THEME, TO_ME, groundings=(Grounded(3, "book1"), Grounded(5, "x"))).groundings == 1


def test_what_ships_evaluates_a_folder(tmp_path, monkeypatch, capsys):
    folder = data_folder() / "huric" / "Simpleset"
    out = tmp_path / "predictions.json"
    monkeypatch.setattr("sys.argv", ["x", "--evaluate", str(folder), "--predictions", str(out)])
    language.main()
    assert "whole command" in capsys.readouterr().out
    written = json.loads(out.read_text())
    assert {row["id"] for row in written} == {path.stem for path in folder.glob("*.hrc")}
    assert {"role", "span", "head", "entity"} == set(written[0]["frames"][0]["arguments"][0])


def test_the_order_of_a_map_does_not_tell_what_is_meant():
    examples = corpus.read(data_folder() / "huric")[::10]
    interpreter = language.shipped()
    for example in examples:
        read = [interpreter.read(example.words, trials.scene_of(example, seed)) for seed in range(3)]
        assert read[0] == read[1] == read[2]
