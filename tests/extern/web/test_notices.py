import pytest

from semmap.nodes.extern.web.notices import strip_cli_hints


@pytest.mark.parametrize(
    ("said", "shown"),
    [
        ("the name 'cup1' is taken; see: semmap get cup1", "the name 'cup1' is taken"),
        (
            "fridge1 is an object (Fridge), and as a Kitchen it would be a place;"
            " if that is intended, add --force",
            "fridge1 is an object (Fridge), and as a Kitchen it would be a place",
        ),
        ("2 classes are unknown; --skip-unknown leaves these out", "2 classes are unknown"),
        ("unknown class 'Zz' (of c1); see: semmap classes; --skip-unknown leaves these out",
         "unknown class 'Zz' (of c1)"),
        ("the scene decides what exists (--truth scene): it is added again",
         "the scene decides what exists: it is added again"),
        ("the cup is not there (it was removed)", "the cup is not there (it was removed)"),
    ],
)  # fmt: skip
def test_hints_to_the_command_line_are_removed(said, shown):
    assert strip_cli_hints(said) == shown
