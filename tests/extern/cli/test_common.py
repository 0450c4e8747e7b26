"""Error messages about options of commands."""

import pytest

from semmap.nodes.extern.cli.app import execute
from semmap.nodes.extern.cli.common import drop_unset


def test_what_is_left_out_is_not_given():
    assert drop_unset({"name": "cup1", "at": None, "alt": (), "wait": False}) == {"name": "cup1"}


def test_zero_is_given():
    assert drop_unset({"yaw": 0.0, "speed": 0, "ref": "", "wait": True}) == {
        "yaw": 0.0,
        "speed": 0,
        "ref": "",
        "wait": True,
    }


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--at", "1,2,3"], "--at requires 3 values, separated by spaces: --at X Y Z"),
        (["--at", "1", "2"], "--at requires 3 values, separated by spaces: --at X Y Z"),
        (
            ["--at", "1m", "2m", "0"],
            "invalid value for '--at': '1m' is not a number; use metres without a unit",
        ),
        (["--ref"], "option '--ref' requires an argument"),
    ],
)
def test_the_values_of_an_option_are_named(capsys, words, said):
    assert execute(["add", "Cup", *words]) == 2
    assert capsys.readouterr().err.startswith(f"semmap: {said}")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ["set", "cup1", "isOpen"],
            "missing argument VALUE; usage: semmap set [OPTIONS] NAME PROPERTY VALUE...",
        ),
        (["attach", "cup1"], "missing option --to HOLDER; see: semmap attach --help"),
        (["completion"], "missing argument SHELL; choose from: bash, zsh, fish"),
        (["list", "x"], "got unexpected extra argument (x)"),
    ],
)
def test_an_error_of_usage_names_the_next_step(capsys, words, said):
    assert execute(words) == 2
    assert capsys.readouterr().err == f"semmap: {said}\n"
