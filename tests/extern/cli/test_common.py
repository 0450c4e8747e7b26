"""Error messages about options of commands."""

import json

import click
import pytest

from semmap.nodes.extern.cli.all_commands import app
from semmap.nodes.extern.cli.app import execute
from semmap.nodes.extern.cli.common import drop_unset, print_lines


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
        (
            ["keys", "add", "anna", "keys"],
            "missing option --role; choose from: viewer, operator, perception, robot, admin, node",
        ),
        (["completion"], "missing argument SHELL; choose from: bash, zsh, fish"),
        (["list", "-n", "3"], "unknown option '-n'; did you mean --limit?"),
        (["list", "Cup"], "unexpected argument 'Cup'; did you mean --class Cup?"),
        (["move", "cup1", "2", "1", "0"], "unexpected arguments '2' '1' '0'; did you mean --at 2 1 0?"),
        (
            ["find", "the", "cup"],
            "unexpected argument 'cup'; a text with spaces must be quoted: semmap find 'the cup'",
        ),
        (
            ["get", "cup1", "cup2"],
            "unexpected argument 'cup2'; a value with spaces must be quoted;"
            " usage: semmap get [OPTIONS] NAME",
        ),
        (["move", "cup1", "--to", "2", "1", "0"], "unknown option '--to'; did you mean --at?"),
        (["undo", "cup1"], "invalid value for COMMIT: 'cup1' is not a whole number"),
    ],
)
def test_an_error_of_usage_names_the_next_step(capsys, words, said):
    assert execute(words) == 2
    assert capsys.readouterr().err == f"semmap: {said}\n"


TEXT_ONLY = {
    "completion",
    "export",
    "fleet mirror",
    "keys zenohd",
    "mcp",
    "node",
    "replay",
    "ros",
    "run",
    "up",
    "web",
}
"""Commands that serve, or whose output is a document of another format."""


def commands(command, name=()):
    if not isinstance(command, click.Group):
        yield " ".join(name), command
        return
    context = click.Context(command)
    for word in command.list_commands(context):
        yield from commands(command.get_command(context, word), (*name, word))


def test_every_other_command_prints_json():
    formats = {
        name: {c for p in found.params for c in getattr(p.type, "choices", ())}
        for name, found in commands(app)
    }
    assert {name for name, choices in formats.items() if "json" not in choices} == TEXT_ONLY


@pytest.mark.parametrize(
    ("words", "status", "error"),
    [
        (["add", "Cup", "--yaw", "90"], 2, {"code": "bad-request", "text": "for degrees write 90deg"}),
        (["add"], 2, {"code": "bad-request", "text": "missing argument CLASS"}),
        (["list", "--connect", "http://x"], 2, {"code": "bad-request", "text": "is not a valid endpoint"}),
        (["list", "--connect", "tcp/127.0.0.1:1"], 3, {"code": "no-answer", "text": "no response"}),
    ],
)
def test_with_json_an_error_is_json_alone_on_stdout(capsys, words, status, error):
    assert execute([*words, "--format", "json"]) == status
    out, err = capsys.readouterr()
    (found,) = json.loads(out).values()
    assert found["code"] == error["code"]
    assert error["text"] in found["text"]
    assert err == ""


def test_columns_are_named_by_the_headers_of_the_table(capsys):
    assert execute(["list", "--columns", "name,zz"]) == 2
    assert "unknown column 'zz'; did you mean z?" in capsys.readouterr().err


def test_notes_are_printed_to_stderr(capsys):
    print_lines(["added cup1", "note: fridge1 is closed"])
    out, err = capsys.readouterr()
    assert (out, err) == ("added cup1\n", "note: fridge1 is closed\n")
