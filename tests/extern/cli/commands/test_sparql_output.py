"""`semmap sparql` and `semmap watch --sparql` through a whole system."""

import io
import json
import os
import signal

import pytest

from semmap.schemas import errors, keys
from tests.conftest import until

CHAIRS = "SELECT ?c { ?c a dm:Chair } ORDER BY ?c"
SEATS = "SELECT ?c { ?c a dm:Seat } ORDER BY ?c"


@pytest.fixture(scope="module")
def system(empty_map):
    with empty_map.client() as client:
        client.add("Chair", "chair1", at=(1.0, 2.0, 0.0), ref="chair")
    return empty_map


def test_every_form_has_its_format(system):
    assert ":chair1" in system.cli("sparql", CHAIRS)
    assert "0 rows" in system.cli("sparql", SEATS)
    assert "1 row (commit" in system.cli("sparql", SEATS, "--inferred")
    document = json.loads(system.cli("sparql", CHAIRS, "--format", "json"))
    assert document["results"]["bindings"][0]["c"]["value"].endswith("#chair1")
    assert "#chair1" in system.cli("sparql", CHAIRS, "--format", "csv")
    assert system.cli("sparql", "ASK { :chair1 a dm:Chair }") == "true\n"
    assert "a dm:Chair" in system.cli("sparql", "DESCRIBE :chair1")
    assert "dm:Chair" in system.cli("sparql", "DESCRIBE :chair1", "--format", "table")


def test_a_query_comes_from_a_file_or_stdin(system, tmp_path, monkeypatch):
    (tmp_path / "chairs.rq").write_text(CHAIRS)
    assert ":chair1" in system.cli("sparql", f"@{tmp_path / 'chairs.rq'}")
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(CHAIRS.encode())))
    assert ":chair1" in system.cli("sparql", "-")


def test_a_query_of_the_past(system):
    with system.client() as client:
        before = client.status().commit
        client.add("Chair", "chair9", at=(1.0, 3.0, 0.0))
        then = client.sparql("ASK { :chair9 a dm:Seat }", inferred=True, as_of=before)
        assert (then.verdict, then.seq) == (False, before)
        client.remove("chair9")
        assert client.sparql("ASK { :chair9 a dm:Seat }", inferred=True, as_of=before + 1).verdict
    assert system.cli("sparql", "ASK { :chair9 a dm:Chair }", "--as-of", str(before + 1)) == "true\n"
    note = "note: unknown term :chair9; did you mean :chair1?\n"
    assert system.cli("sparql", "ASK { :chair9 a dm:Chair }") == f"false\n{note}"


BAD = [
    (("sparql", CHAIRS, "--as-of", "9999"), 1, "there is no commit 9999 yet"),
    (("sparql", CHAIRS, "--as-of", "soon"), 2, "'soon' is neither a commit number nor a time"),
    (("sparql", "SELECT ?c { ?c a foo:Bar }", "--as-of", "1"), 2, "unknown prefix 'foo:'"),
    (("sparql", "SELECT ?c { ?c a"), 2, "line 1, column 17"),
    (("sparql", "SELECT ?c { ?c a foo:Bar }"), 2, "unknown prefix 'foo:'"),
    (("sparql", ""), 2, "query must be a text"),
    (("sparql", "DELETE WHERE { ?s ?p ?o }"), 1, "DELETE is an update"),
    (("sparql", "SELECT * { SERVICE <http://x.org/> { ?s ?p ?o } }"), 1, "SERVICE is not allowed"),
    (("sparql", "SELECT * FROM <http://x.org/> { ?s ?p ?o }"), 1, "FROM is not allowed"),
    (
        ("sparql", "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i }", "--timeout", "0.5"),
        1,
        "cancelled after 0.5 s",
    ),
    (("sparql", "SELECT * { ?a ?b ?c . ?d ?e ?f }"), 1, "more than 10000 rows"),
    (("sparql", CHAIRS, "--format", "xml"), 2, "xml"),
    (("sparql", CHAIRS, "--format", "turtle"), 2, "requires a CONSTRUCT or DESCRIBE query"),
    (("sparql", CHAIRS, "--timeout", "-1"), 2, "timeout must be a number above 0"),
    (("sparql", CHAIRS, "--limit", "0"), 2, "limit must be a whole number from 1"),
    (("sparql", "@nowhere.rq"), 2, "there is no file nowhere.rq"),
    (("watch", "--sparql", "ASK { ?s ?p ?o }"), 2, "only a SELECT query can be watched"),
    (("watch", "--sparql", "SELECT ?x {"), 2, "not a valid SPARQL query"),
]


@pytest.mark.parametrize(("words", "status", "said"), BAD, ids=lambda value: str(value)[:60])
def test_bad_words(system, words, status, said):
    assert said in system.cli(*words, status=status)
    assert ":chair1" in system.cli("sparql", CHAIRS)


ASK = "query=ASK {:chair1 a dm:Seat}"


def test_a_selector_asks_too(system):
    with system.client() as client:
        selector = f"{keys.CMD}/sparql?{ASK};inferred=true;format=json"
        (reply,) = until(lambda: list(client.session.get(selector)), "a new peer has met the others")
        assert json.loads(reply.ok.payload.to_bytes())["verdict"] is True


def test_rows_are_watched_over_a_restart_of_the_knowledge_base(system):
    with system.spawned("watch", "--sparql", SEATS, "--inferred") as watching, system.client() as client:
        lines = iter(watching.stdout)
        assert any("watching" in line for line in lines)
        commit = client.add("Chair", "chair2").commit
        assert next(lines) == f"+ ?c :chair2  (commit {commit})\n"
        client.update("chair2", ref="armchair")
        commit = client.remove("chair2").commit
        assert next(lines) == f"- ?c :chair2  (commit {commit})\n"
        os.kill(system.pid("kb_node"), signal.SIGKILL)
        until(lambda: _answers(client), "the knowledge base is back")
        client.add("Chair", "chair3")
        assert next(lines).startswith("+ ?c :chair3  (commit")
        client.remove("chair3")
    assert watching.wait(timeout=10) == 130


def _answers(client):
    try:
        return client.sparql(CHAIRS).rows
    except errors.NoAnswer:
        return None
