"""Commands with everything that is read of them, in the shipped flat.

Each paragraph of a file in `readings/` is a command and its reading: the steps with the verb, condition and
time. For each role these are its words with the head between stars, its entities after `=`, the step and role
that a pronoun refers to after `@`, and the description in parentheses. An answer is after `=`, a doubt after
`!`, and the question that would be asked after `?`.
"""

from pathlib import Path

import pytest

from tests.language.steps.rendering import render

FILES = sorted((Path(__file__).parent / "readings").glob("*.txt"))
READINGS = [paragraph.splitlines() for file in FILES for paragraph in file.read_text().split("\n\n")]


@pytest.mark.parametrize("lines", READINGS, ids=[lines[0].removeprefix("> ") for lines in READINGS])
def test_a_command_is_read_completely(read, lines):
    command, *reading = lines
    assert render(read(command.removeprefix("> "))) == reading
