"""A commit outside of a query's footprint does not change its rows."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from semmap.nodes.kb_node.sparql.queries.evaluation import evaluate
from semmap.nodes.kb_node.sparql.queries.footprint import Footprint, footprint
from semmap.nodes.kb_node.sparql.triples.dataset import Dataset, Delta
from semmap.ontology import vocabulary as v

QUERIES = [
    "SELECT ?x { ?x a dm:Chair }",
    "SELECT ?x ?c { ?x a ?c }",
    "SELECT ?x { ?x a dm:Chair . FILTER NOT EXISTS { ?x dm:q ?y } }",
    "SELECT ?x { ?x dm:p/dm:q ?y }",
    "SELECT ?x ?y { ?x ^dm:p|dm:q+ ?y }",
    "SELECT ?x { { ?x dm:p :a } UNION { ?x a dm:Seat } MINUS { ?x dm:q :b } }",
    "SELECT ?x (COUNT(?y) AS ?n) { ?x dm:p ?y } GROUP BY ?x HAVING (COUNT(?y) > 1)",
    "SELECT ?x { ?x a dm:Chair OPTIONAL { ?x dm:q ?y } FILTER(!BOUND(?y)) }",
    "SELECT ?x { ?x dm:p* :a }",
    "SELECT ?x { ?x dm:p? ?y }",
    "SELECT ?x { ?x !dm:p ?y }",
    "SELECT ?p { ?x ?p ?y }",
    "SELECT ?x { BIND(EXISTS { :a dm:q ?z } AS ?x) }",
    "SELECT ?n { { SELECT (COUNT(*) AS ?n) { ?x a/dm:p dm:Chair } } }",
    "SELECT (EXISTS { :a dm:p ?z } AS ?x) {}",
    "SELECT ?x { VALUES ?x { :a :b } FILTER(EXISTS { ?x dm:q ?x } || NOT EXISTS { ?x a dm:Seat }) }",
    "SELECT ?x { ?x dm:p [ a dm:Chair ; dm:q ( :a :b ) ] }",
]
NAMES = [v.entity_iri(name) for name in "abc"]
TRIPLES = st.one_of(
    st.tuples(st.sampled_from(NAMES), st.just(v.RDF_TYPE), st.sampled_from([v.dm("Chair"), v.dm("Seat")])),
    st.tuples(st.sampled_from(NAMES), st.sampled_from([v.dm("p"), v.dm("q")]), st.sampled_from(NAMES)),
)


@settings(max_examples=80, deadline=None, derandomize=True)
@given(st.lists(st.tuples(st.booleans(), TRIPLES), min_size=1, max_size=8))
def test_rows_change_only_when_the_footprint_is_touched(changes):
    dataset, said = Dataset(0, ()), set()
    for seq, (comes, triple) in enumerate(changes):
        if comes == (triple in said):
            continue
        said ^= {triple}
        before = [_rows(dataset, query) for query in QUERIES]
        delta = Delta(seq=seq, **{"inserted" if comes else "retracted": (triple,)})
        dataset.apply(delta)
        for query, rows in zip(QUERIES, before, strict=True):
            assert _rows(dataset, query) == rows or FOOTPRINTS[query].is_touched(delta.asserted), query


def _rows(dataset, query):
    return sorted(map(str, evaluate(query, dataset, inferred=False, limit=100).rows))


FOOTPRINTS = {query: footprint(query) for query in QUERIES}


def test_classes_are_distinguished():
    looks_at = footprint("SELECT ?x { ?x a dm:Chair ; dm:isOn/rdfs:label ?y }")
    chair = v.entity_iri("a")
    assert looks_at.is_touched([(chair, v.RDF_TYPE, v.dm("Chair"))])
    assert looks_at.is_touched([(chair, v.dm("isOn"), chair)])
    assert not looks_at.is_touched([(chair, v.RDF_TYPE, v.dm("Table")), (chair, v.dm("isIn"), chair)])


@pytest.mark.parametrize("query", ["SELECT ?x { ?x ?p ?o }", "SELECT ?x { ?x dm:p* ?o }", "no SPARQL"])
def test_unknown_patterns_cover_everything(query):
    assert footprint(query) == Footprint()
    assert footprint(query).is_touched([(v.entity_iri("a"), v.dm("p"), v.entity_iri("b"))])
