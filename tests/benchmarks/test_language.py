"""Scores of what was understood."""

import json
import re

import pytest

from benchmarks.language import __main__ as language
from benchmarks.language import ablations, errors, free, trials
from benchmarks.language.scoring import scores
from semmap.nodes.language import lexicon
from semmap.nodes.language.understanding import predicates, roles
from semmap.nodes.language.understanding.grounding import Thing
from semmap.nodes.language.understanding.sentence import sentence
from semmap.nodes.training.language import corpus
from semmap.nodes.training.language.corpus import Example, Filled, Role
from semmap.schemas.language import Argument, CommandStep, Filler, Grounded, SemanticFrame, Understood
from tests.data import data_folder

WORDS = ("take", "the", "book", "to", "me")
EXAMPLE = Example(
    "1",
    "group",
    WORDS,
    (Filled("Bringing", (1,), (Role("Theme", 2, 3, 3), Role("Beneficiary", 4, 5))),),
    (Thing("book1", "Book"),),
    ((3, "book1"), (5, "missing")),
)
THEME = Argument("Theme", "the book", (2, 3), 3, "book1")
TO_ME = Argument("Beneficiary", "to me", (4, 5), 5)


GROUNDED = (Grounded(3, "book1"),)


def said(name, *arguments, groundings=GROUNDED):
    return scores([(EXAMPLE, Understood(WORDS, (SemanticFrame(name, (1,), arguments),), groundings))])


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


def test_italian_commands_are_read_in_the_maps_of_their_originals():
    pairs = trials.italian(corpus.read(data_folder() / "huric"))
    assert len(pairs) == 60
    assert all(example.words == understood.words for example, understood in pairs)
    found = scores(pairs)
    assert found.frames >= 0.95
    assert found.heads >= 0.88
    assert found.whole >= 0.7


def test_errors_are_grouped_by_what_is_wrong_first():
    wrong = Understood(WORDS, (SemanticFrame("Taking", (1,), (THEME,)),), GROUNDED)
    other_words = Understood(
        WORDS,
        (SemanticFrame("Bringing", (1,), (Argument("Theme", "book", (3, 3), 3, "book1"), TO_ME)),),
        GROUNDED,
    )
    right = Understood(WORDS, (SemanticFrame("Bringing", (1,), (THEME, TO_ME)),), GROUNDED)
    groups = errors.groups(
        [(EXAMPLE, wrong), (EXAMPLE, right), (EXAMPLE, wrong), (EXAMPLE, Understood(WORDS, (), ()))]
    )
    assert [(group.title, len(group.commands)) for group in groups] == [
        ("Taking or Bringing", 2),
        ("a frame not found", 1),
    ]
    assert [g.title for g in errors.groups([(EXAMPLE, Understood(WORDS, (), GROUNDED))])] == [
        "a frame not found"
    ]
    assert errors.groups([(EXAMPLE, other_words)]) == []  # the head is right, and with it the command
    assert list(errors.lines(groups))[1] == "       take the book to me: is Bringing"


def test_features_of_a_group_can_be_left_out():
    seen = ablations.without(r"\bw=")
    assert seen([["bias", "w=take", "Taking|w=take", "pos=verb"]]) == [["bias", "pos=verb"]]


def test_every_group_of_features_is_of_some():
    examples = corpus.read(data_folder() / "huric")[:60]
    seen = set()
    for example in examples:
        s = sentence(example.words, trials.scene_of(example), lexicon.load())
        for word in predicates.features(s) + roles.features(s, 0, "Taking", []):
            seen.update(word)
    for title, pattern in ablations.GROUPS.items():
        assert any(re.search(pattern, name) for name in seen), title


@pytest.mark.parametrize(
    ("text", "doubts", "judged"),
    [
        ("take the cup", (), free.Judged(True, ())),
        ("take the cup", ("'zorp' is not understood",), free.Judged(False, ())),
        ("take the cup", ("'if so' is a condition; it is not checked",), free.Judged(True, ())),
        ("take the green cup", (), free.Judged(True, ("green",))),
    ],
)
def test_free_wording_is_right_with_its_steps_and_signs_and_without_lost_words(text, doubts, judged):
    step = CommandStep("Taking", "take", {"Theme": (Filler("the cup", "cup", ("cup1",)),)})
    understood = Understood(WORDS, (), (), steps=(step,), doubts=doubts)
    command = {"text": text, "steps": ["Taking(Theme=cup1)"], "signal": False}
    assert free.judge(command, understood) == judged
    assert [row.value for row in free.rows([judged])] == [float(judged.is_right), float(bool(judged.lost))]
