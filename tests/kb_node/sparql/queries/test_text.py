import pytest

from semmap.nodes.kb_node.sparql.queries import text
from semmap.nodes.kb_node.sparql.queries.evaluation import evaluate
from semmap.nodes.kb_node.sparql.triples.dataset import Dataset
from semmap.schemas import errors


@pytest.mark.parametrize(
    ("query", "form"),
    [
        ("SELECT ?x { ?x a dm:Chair }", "SELECT"),
        ("# DELETE\nPREFIX load: <x:y> ask { load:a load:b load:c }", "ASK"),
        (
            "BASE <http://x.org/FROM> CONSTRUCT { ?add ?from 'LOAD' } WHERE { ?add ?from 3 }",
            "CONSTRUCT",
        ),
        ("DESCRIBE :service", "DESCRIBE"),
        ('SELECT ?x { ?x rdfs:label "SERVICE" , """FROM "a" """ , \'\'\'it\'s FROM\'\'\' }', "SELECT"),
        ("SELECT ?x { ?x rdfs:label 'SERVICE'@from . _:from ?p ?x } # FROM", "SELECT"),
    ],
)
def test_queries_that_read_are_accepted(query, form):
    assert text.require_reading(query) == form


@pytest.mark.parametrize(
    ("query", "word"),
    [
        ("INSERT DATA { :a a dm:Chair }", "INSERT is an update"),
        ("PREFIX x: <x:y> delete where { ?s ?p ?o }", "DELETE is an update"),
        ("LOAD <http://x.org/>", "LOAD is an update"),
        ("WITH <x:g> DELETE { ?s ?p ?o } WHERE { ?s ?p ?o }", "WITH is an update"),
        ("CLEAR ALL", "CLEAR is an update"),
        ("SELECT * { SERVICE <http://x.org/> { ?s ?p ?o } }", "SERVICE is not allowed"),
        ("SELECT * { ?a ?b '#' . service silent <http://x.org/> { ?s ?p ?o } }", "SERVICE is not allowed"),
        ("SELECT * FROM <http://x.org/> { ?s ?p ?o }", "FROM is not allowed"),
        ("SELECT * FROM NAMED <http://x.org/> { ?s ?p ?o }", "FROM is not allowed"),
        ("SELECT*{?s?p?o}#\nFROM", "FROM is not allowed"),
    ],
)
def test_updates_and_external_access_are_rejected(query, word):
    with pytest.raises(errors.Refused, match=word):
        text.require_reading(query)


@pytest.mark.parametrize("query", ["", "hello", "?select", "# SELECT", "<SELECT>"])
def test_invalid_queries_are_rejected(query):
    with pytest.raises(errors.BadRequest, match="it needs SELECT, ASK, CONSTRUCT or DESCRIBE"):
        text.require_reading(query)


def test_the_prefixes_of_a_tbox_do_not_replace_known_ones_except_by_another_scheme():
    known = text.query_prefixes(
        {"schema": "http://schema.org/", "owl": "http://x.org/owl#", "x": "http://x/"}
    )
    assert known == {**text.PREFIXES, "schema": "http://schema.org/", "x": "http://x/"}


def test_only_select_can_be_watched():
    with pytest.raises(errors.BadRequest, match=r"only a SELECT query can be watched, and this is .* ASK"):
        text.require_select("ASK { ?s ?p ?o }")


@pytest.mark.parametrize(
    ("query", "said"),
    [
        ("SELECT ?x { ?x a", "line 1, column 17: unexpected end"),
        ("SELECT ?x {\n  ?x a foo:Bar }", "line 2, column 15: unknown prefix 'foo:'; known are dm:, :, "),
        (
            "SELECT ?x { ?x a dm:Chair } }",
            "line 1, column 30: unexpected end, or an error before it",
        ),
        ("SELECT ?x { ?x a 'x' 4 }", "line 1, column 25: unexpected end, or"),
        ("SELECT ?x ?x {}", "a variable is selected twice"),
        ("SELECT ?y (COUNT(?x) AS ?n) { ?x ?p ?y }", "neither binds nor groups by"),
        ("SELECT ?x { ?x ?p <a b> }", "an IRI is malformed"),
    ],
)
def test_a_syntax_error_has_a_position_and_a_reason(query, said):
    with pytest.raises(errors.BadRequest) as error:
        evaluate(query, Dataset(0, ()), inferred=False, limit=10)
    assert error.value.text.startswith("not a valid SPARQL query: ")
    assert said in error.value.text
    assert "\n" not in error.value.text
