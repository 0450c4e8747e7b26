import click
import pytest
from click.testing import CliRunner

from semmap.nodes.extern.cli.ontology_options import import_option


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
