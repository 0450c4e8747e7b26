import click
import pytest
from click.testing import CliRunner

from semmap.nodes.extern.cli.command import NegativeNumbers


@click.command(cls=NegativeNumbers, context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("name")
@click.argument("values", nargs=-1)
@click.option("--if-is")
def show(name, values, if_is):
    click.echo(f"{name} {' '.join(values)} {if_is}")


def run(*words):
    return CliRunner().invoke(show, words)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("x", "-3"), "x -3 None"),
        (("x", "-12.5", "--if-is", "-1e-3", "-.5"), "x -12.5 -.5 -1e-3"),
        (("x", "--if-is=-2", "4"), "x 4 -2"),
        (("x", "--", "-text", "--if-is"), "x -text --if-is None"),
    ],
)
def test_a_negative_number_is_a_value(words, said):
    assert run(*words).output == f"{said}\n"


@pytest.mark.parametrize("word", ["--if-iz", "-x", "-3x", "--3"])
def test_another_option_that_does_not_exist_is_refused(word):
    result = run("x", word)
    assert result.exit_code == 2
    assert f"'{word}'" in result.output
