import json

import pyoxigraph as ox
import pytest

from semmap.nodes.extern.cli.output import sparql_formats as formats
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.sparql import RowsChanged, SparqlResult

CHAIR = v.entity_iri("chair1")
ROWS = SparqlResult(
    kind="select",
    variables=("a", "b"),
    rows=(
        (CHAIR, '"1.5"^^<http://www.w3.org/2001/XMLSchema#float>'),
        ("_:x", '"a \\"cold\\" beer,\\n"@en'),
        (None, '"plain"'),
    ),
    seq=3,
)
GRAPH = SparqlResult(
    kind="graph",
    variables=("subject", "predicate", "object"),
    rows=((CHAIR, v.RDF_TYPE, v.dm("Chair")),),
    seq=3,
)
ASK = SparqlResult(kind="ask", verdict=True, seq=3)


def test_json_is_what_other_readers_of_sparql_results_read():
    found = ox.parse_query_results(formats.text(ROWS, "json"), ox.QueryResultsFormat.JSON)
    assert [variable.value for variable in found.variables] == ["a", "b"]
    rows = [tuple(solution) for solution in found]
    assert rows[0] == (
        ox.NamedNode(v.bare(CHAIR)),
        ox.Literal("1.5", datatype=ox.NamedNode(v.XSD + "float")),
    )
    assert rows[1][1] == ox.Literal('a "cold" beer,\n', language="en")
    assert rows[2] == (None, ox.Literal("plain"))
    assert json.loads(formats.text(ASK, "json")) == {"head": {}, "boolean": True}


def test_csv_has_bare_values_in_quotes_where_needed():
    assert formats.text(ROWS, "csv") == (
        f'a,b\r\n{v.bare(CHAIR)},1.5\r\n_:x,"a ""cold"" beer,\n"\r\n,plain\r\n'
    )


def test_turtle_is_for_graphs():
    document = formats.text(GRAPH, "turtle")
    (triple,) = ox.parse(document, ox.RdfFormat.TURTLE)
    assert tuple(map(str, triple.triple)) == GRAPH.rows[0]
    for result in (ROWS, ASK):
        with pytest.raises(errors.BadRequest, match="requires a CONSTRUCT or DESCRIBE query"):
            formats.text(result, "turtle")


@pytest.mark.parametrize(
    ("term", "said"),
    [
        (CHAIR, ":chair1"),
        (v.dm("Chair"), "dm:Chair"),
        (v.RDF_TYPE, "rdf:type"),
        ("<http://x.org/a>", "<http://x.org/a>"),
        ("_:b", "_:b"),
        ('"1.5"^^<http://www.w3.org/2001/XMLSchema#float>', "1.5"),
        ('"beer"@en', '"beer"@en'),
        ('"beer"', '"beer"'),
        (None, ""),
    ],
)
def test_terms_as_in_turtle(term, said):
    assert formats.format_term(term) == said


def test_news_tell_the_commit():
    changed = RowsChanged(
        watch="w", seq=7, since=6, appeared=((CHAIR,),), disappeared=((v.entity_iri("b"),),)
    )
    assert list(formats.news(("c",), changed)) == ["- ?c :b  (commit 7)", "+ ?c :chair1  (commit 7)"]
    late = RowsChanged(watch="w", seq=7, since=3, appeared=((CHAIR,),))
    assert list(formats.news(("c",), late)) == ["+ ?c :chair1  (commits 4 to 7)"]
