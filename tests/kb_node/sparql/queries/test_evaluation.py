import pytest

from semmap.nodes.kb_node.sparql.queries.evaluation import evaluate
from semmap.nodes.kb_node.sparql.triples.dataset import Dataset, Delta
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from tests.kb_node.home import turtle

CHAIR = v.dm("Chair")


@pytest.fixture
def dataset():
    made = Dataset(7, turtle(":a a dm:Chair . :b a dm:Chair ; dm:mass 4.50 . :c a dm:Table ."))
    made.infer(turtle(":a a dm:Seat . :b a dm:Seat ."))
    return made


def ask(dataset, query, *, inferred=False, limit=100):
    return evaluate(query, dataset, inferred=inferred, limit=limit)


def test_the_four_forms(dataset):
    rows = ask(dataset, "SELECT ?x ?m { ?x a dm:Chair OPTIONAL { ?x dm:mass ?m } } ORDER BY ?x")
    assert rows.variables == ("x", "m")
    assert rows.rows[0] == (v.entity_iri("a"), None)
    assert rows.rows[1][0] == v.entity_iri("b")
    assert rows.seq == 7
    assert ask(dataset, "ASK { :c a dm:Table }").verdict
    assert not ask(dataset, "ASK { :c a dm:Chair }").verdict
    graph = ask(dataset, "CONSTRUCT { ?x a dm:Thing } WHERE { ?x a dm:Chair , ?y }")
    assert graph.rows == tuple((v.entity_iri(name), v.RDF_TYPE, v.dm("Thing")) for name in "ab")
    assert len(ask(dataset, "DESCRIBE :b").rows) == 2


def test_inferences_are_included_on_request(dataset):
    for query, asserted, inferred in (
        ("SELECT ?x { ?x a dm:Seat }", 0, 2),
        ("SELECT ?x { ?x a ?c }", 3, 5),
        ("SELECT ?x { GRAPH ?g { ?x a ?c } }", 0, 0),
    ):
        assert len(ask(dataset, query).rows) == asserted
        assert len(ask(dataset, query, inferred=True).rows) == inferred


def test_too_many_rows_are_rejected(dataset):
    assert len(ask(dataset, "SELECT * { ?s a ?o }", limit=3).rows) == 3
    for query in ("SELECT * { ?s a ?o }", "CONSTRUCT { ?s a ?o } WHERE { ?s a ?o }"):
        with pytest.raises(errors.Refused, match="more than 2 rows"):
            ask(dataset, query, limit=2)


def test_a_duplicate_triple_counts_once(dataset):
    graph = ask(dataset, "CONSTRUCT { :a a dm:Thing } WHERE { ?s ?p ?o }", limit=1)
    assert graph.rows == ((v.entity_iri("a"), v.RDF_TYPE, v.dm("Thing")),)


def test_an_unknown_function_is_rejected(dataset):
    with pytest.raises(errors.Refused, match=r"custom function <http://x.org/f> is not supported"):
        ask(dataset, "SELECT (<http://x.org/f>(1) AS ?x) {}")


def test_two_spellings_of_a_number_are_kept_until_both_are_removed():
    spellings = turtle(':a dm:mass "1.0"^^xsd:float , "1.00"^^xsd:float . :b dm:mass "2"^^xsd:float .')
    one, other = (t for t in spellings if t[0] == v.entity_iri("a"))
    for dataset in (Dataset(0, spellings), _by_commits(spellings)):
        dataset.apply(Delta(seq=5, retracted=(one,)))
        assert ask(dataset, "ASK { :a dm:mass ?m FILTER(?m = 1) }").verdict
        dataset.apply(Delta(seq=6, retracted=(other,)))
        assert not ask(dataset, "ASK { :a dm:mass ?m }").verdict
        assert ask(dataset, "ASK { :b dm:mass 2 , ?m FILTER(?m = 2) } ").verdict is False


def _by_commits(triples):
    dataset = Dataset(0, ())
    for seq, triple in enumerate(triples, start=1):
        dataset.apply(Delta(seq=seq, inserted=(triple,)))
    return dataset


@pytest.mark.parametrize(
    ("query", "notes"),
    [
        ("SELECT ?x { ?x dm:masss ?m }", ["unknown term dm:masss; did you mean dm:mass?"]),
        (
            "SELECT (COUNT(*) AS ?n) { ?x a dm:Chiar }",
            ["unknown term dm:Chiar; did you mean dm:Chair?"],
        ),
        ("ASK { :ghost9 a dm:Chair }", ["unknown term :ghost9"]),
        ("PREFIX my: <urn:my#> SELECT * { ?x my:x <urn:y> }", ["... my:x", "... <urn:y>"]),
        ("CONSTRUCT { ?x a dm:Chair } { ?x a <http://x.org/y> }", ["... <http://x.org/y>"]),
        ("SELECT * { ?x a dm:Chair , dm:Table }", []),  # all of these are known, and none is both
        ("SELECT * { ?x a owl:Nothing FILTER(?x = 'dm:noTerm' && xsd:float(1) > 2) }", []),
        ("SELECT * { ?x a dm:Chair OPTIONAL { ?x dm:nosuch ?y } }", []),  # there are rows
    ],
)
def test_unknown_terms_are_noted_if_there_is_no_result(query, notes):
    said = ":a a dm:Chair . :b a dm:Chair ; dm:mass 4.50 . :c a dm:Table ."
    declared = " dm:Chair a owl:Class . dm:mass a owl:DatatypeProperty ."
    found = ask(Dataset(7, turtle(said + declared)), query).notes
    assert list(found) == [note.replace("...", "unknown term") for note in notes]
