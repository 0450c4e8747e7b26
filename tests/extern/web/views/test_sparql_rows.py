from semmap.nodes.extern.web.views.sparql_rows import StandingRows, format_summary, rows_of
from semmap.ontology import vocabulary as v
from semmap.schemas.sparql import RowsChanged, SparqlResult

CUP, TABLE = v.entity_iri("cup1"), v.entity_iri("table1")


def test_rows_have_the_names_of_their_entities():
    result = SparqlResult(
        kind="select",
        variables=("thing", "height", "class", "none"),
        rows=((CUP, '"0.74"^^<http://www.w3.org/2001/XMLSchema#float>', v.dm("Cup"), None),),
        seq=3,
    )
    found = rows_of(result, {"cup1", "Cup_of_another_map"})
    assert found.columns == ("thing", "height", "class", "none")
    assert found.rows == [{"id": 0, "c0": ":cup1", "c1": "0.74", "c2": "dm:Cup", "c3": "", "names": ["cup1"]}]


def test_removed_entities_are_not_in_the_names():
    result = SparqlResult(kind="select", variables=("thing",), rows=((CUP,),), seq=3)
    assert rows_of(result, ()).rows[0]["names"] == []


def test_ask_and_construct_results_are_tables():
    assert rows_of(SparqlResult(kind="ask", verdict=True, seq=1), ()).rows[0]["c0"] == "yes"
    graph = rows_of(SparqlResult(kind="graph", rows=((CUP, v.dm("isOn"), TABLE),), seq=1), {"cup1", "table1"})
    assert graph.columns == ("subject", "predicate", "object")
    assert graph.rows[0]["names"] == ["cup1", "table1"]


def test_markup_in_results_stays_text():
    result = SparqlResult(kind="select", variables=("text",), rows=(('"<b>x</b>"',),), seq=1)
    assert rows_of(result, ()).rows[0]["c0"] == '"<b>x</b>"'


def test_the_summary_has_rows_commit_and_time():
    result = SparqlResult(kind="select", variables=("t",), rows=((CUP,),), seq=12)
    assert format_summary(result, 0.0123) == "1 row, commit 12, 12 ms"
    assert format_summary(SparqlResult(kind="ask", seq=2), 2.0) == "commit 2, 2.0 s"


def states(standing):
    return {row["c0"]: row["state"] for row in standing.table({"cup1"})}


def test_added_and_removed_rows_are_marked_until_the_next_change():
    standing = StandingRows([(CUP,)])
    standing.apply(RowsChanged(watch="q", seq=2, since=1, appeared=((TABLE,),), disappeared=((CUP,),)))
    assert states(standing) == {":table1": "added", ":cup1": "removed"}
    assert len(standing) == 1
    standing.clear_marks()
    assert states(standing) == {":table1": ""}


def test_rows_keep_their_numbers_and_duplicates_are_removed_singly():
    standing = StandingRows([(CUP,), (CUP,), (TABLE,)])
    standing.apply(RowsChanged(watch="q", seq=2, since=1, disappeared=((CUP,),)))
    standing.clear_marks()
    assert [(row["id"], row["c0"]) for row in standing.table(())] == [(1, ":cup1"), (2, ":table1")]
    standing.apply(RowsChanged(watch="q", seq=3, since=2, appeared=((CUP,),)))
    assert [row["id"] for row in standing.table(())] == [1, 2, 3]
