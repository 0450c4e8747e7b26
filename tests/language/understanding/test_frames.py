"""Commands as frames with the words, the head and the entities of each argument.

Each paragraph of a file in `frames/` is a command and its frames: the name with the indices of the verb's
words, a line for each argument with its words, and the words that denote entities. The descriptions in the
flat are resolved in the whole map. Those in the household are not, as in the corpus of the taggers.
"""

from pathlib import Path

import pytest

from semmap.nodes.language.understanding.interpretation import shipped
from tests.language.household import there
from tests.language.understanding.rendering import render

FOLDER = Path(__file__).parent / "frames"


def cases(name):
    found = [paragraph.splitlines() for paragraph in (FOLDER / name).read_text().split("\n\n")]
    return pytest.mark.parametrize("lines", found, ids=[lines[0].removeprefix("> ") for lines in found])


@pytest.fixture(scope="module")
def household():
    return there()


@cases("household.txt")
def test_a_command_has_the_frames_of_its_verbs(household, lines):
    command, *frames = lines
    assert render(shipped().understand(command.removeprefix("> "), household)) == frames


@cases("flat.txt")
def test_the_arguments_are_resolved_in_the_map(read, lines):
    command, *frames = lines
    assert render(read(command.removeprefix("> "))) == frames
