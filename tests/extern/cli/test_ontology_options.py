import click
import pytest
from click.testing import CliRunner

from semmap.nodes.extern.cli.ontology_options import import_option, require_there, tbox_file
from semmap.ontology import HOUSEHOLD_TTL
from semmap.schemas import errors


@click.command()
@import_option
def show(imports):
    for iri, file in imports:
        click.echo(f"{iri} {file.name}")


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("b.ttl", "b=c.ttl"):
        (tmp_path / name).write_text("")
    return lambda *words: CliRunner().invoke(show, words)


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("http://o.org/b=b.ttl", "http://o.org/b b.ttl"),
        ("<http://o.org/b>=b.ttl", "http://o.org/b b.ttl"),
        ("http://o.org/b?v=1=b.ttl", "http://o.org/b?v=1 b.ttl"),
        ("http://o.org/b=b=c.ttl", "http://o.org/b b=c.ttl"),
    ],
)
def test_an_import_has_an_iri_and_a_file(run, word, said):
    assert run("--import", word, "--import", word).output == f"{said}\n{said}\n"


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("b.ttl", "'b.ttl' is not IRI=FILE"),
        ("=b.ttl", "'=b.ttl' is not IRI=FILE"),
        ("http://o.org/b=", "is not IRI=FILE"),
        ("http://o.org/b=nowhere.ttl", "there is no file nowhere.ttl"),
    ],
)
def test_what_is_neither_is_reported(run, word, said):
    result = run("--import", word)
    assert result.exit_code == 2
    assert said in result.output


def test_the_word_household_is_the_shipped_tbox_and_a_path_is_a_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "household").write_text("")
    assert tbox_file("household") == HOUSEHOLD_TTL
    assert tbox_file("./household").resolve() == tmp_path / "household"


@pytest.mark.parametrize(
    ("word", "text"),
    [
        ("my.ttl", "there is no file my.ttl"),
        ("./household", "there is no file household"),
        ("houshold", "there is no file houshold; for the TBox of semmap use: household"),
    ],
)
def test_a_tbox_that_does_not_exist_is_reported(tmp_path, monkeypatch, word, text):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(errors.BadFile) as caught:
        require_there(tbox_file(word))
    assert caught.value.text == text
