"""`semmap learn`, `learned` and `forget` of a data folder, which need no system."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from semmap.nodes.extern.cli.app import execute
from tests.extern.cli.commands.test_perceive import SEEN, write_frame


def box_of(number):
    rows, columns = np.nonzero(SEEN.truth == number)
    return [str(n) for n in (columns.min(), rows.min(), columns.max() + 1, rows.max() + 1)]


def said(capsys, *words):
    assert execute([*words]) == 0
    return capsys.readouterr().out


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_frame(tmp_path / "shown" / "0001")
    return tmp_path


def classes(capsys, *words):
    said(capsys, "perceive", "--frames", "shown", "--json", "found.json", *words)
    (row,) = json.loads(Path("found.json").read_text())
    return [thing["class"] for thing in row["objects"]]


def test_what_was_shown_is_recognised_until_it_is_forgotten(here, capsys):
    before = classes(capsys)
    learn = ["learn", "dog", "--frames", "shown", "--data", "map", "--box", *box_of(1)]
    told = said(capsys, *learn)
    assert "learned Dog from 1 frame in shown" in told
    assert "semmap forget 1" in told
    assert "Dog" in said(capsys, "learned", "--data", "map")
    assert classes(capsys, "--data", "map") == ["Dog", "Dog"]  # two cubes that look the same
    assert classes(capsys) == before
    assert json.loads(said(capsys, "learned", "--data", "map", "--format", "json"))[0]["class"] == "Dog"
    assert "forgot Dog" in said(capsys, "forget", "1", "--data", "map")
    assert said(capsys, "learned", "--data", "map") == "no exemplars\n"
    assert classes(capsys, "--data", "map") == before


def test_a_kind_that_no_class_names_becomes_a_class_below_object(here, capsys):
    learn = ["learn", "power drill", "--frames", "shown", "--data", "map", "--box", *box_of(1)]
    assert execute(learn) == 2
    assert (
        "unknown class 'power drill'; did you mean Power_Plug?; to make a new class below Object"
        in capsys.readouterr().err
    )
    assert "learned Power_Drill from" in said(capsys, *learn, "--new-class")
    assert classes(capsys, "--data", "map") == ["Power_Drill", "Power_Drill"]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["learn", "Dog", "--data", "map"], "--frames DIR or --entity NAME"),
        (["learn", "Dog", "--frames", "shown", "--entity", "dog1"], "--frames DIR or --entity NAME"),
        (["learn", "Dog", "--entity", "dog1", "--data", "map"], "--entity requires a running system"),
        (["learn", "Dog", "--entity", "dog1", "--box", "1", "2", "3", "4"], "--box requires --frames"),
        (["learn", "Dgo", "--frames", "shown", "--data", "map"], "unknown class 'Dgo'; did you mean Dog?"),
        (["learn", "Object", "--frames", "shown", "--data", "map"], "name a more specific class"),
        (["learn", "Dog", "--frames", "nowhere", "--data", "map"], "no file or folder nowhere"),
        (["learn", "Dog", "--frames", "empty", "--data", "map"], "empty has no folders of frames"),
        (["learn", "Dog", "--frames", "shown", "--data", "map", "--box", "9", "9", "2", "2"], "640 x 480"),
        (
            ["learn", "Dog", "--frames", "shown", "--data", "map", "--box", "0", "0", "9", "9"],
            "nothing in that",
        ),
        (["perceive", "--frames", "shown", "--data", "map"], "no exemplars in map"),
    ],
)
def test_what_cannot_be_shown_is_reported_in_one_line(here, capsys, words, told):
    (here / "empty").mkdir()
    assert execute(words) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1


def test_a_lesson_that_there_is_not_is_refused(here, capsys):
    assert execute(["forget", "3", "--data", "map"]) == 1
    assert "no exemplar with number 3; none is stored" in capsys.readouterr().err
