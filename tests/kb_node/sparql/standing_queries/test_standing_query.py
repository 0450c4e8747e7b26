"""The rows of a standing query."""

import math

import pytest

from semmap.nodes.kb_node.sparql.standing_queries.standing_query import StandingQuery
from semmap.nodes.kb_node.sparql.triples.dataset import Delta
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Watch

A, B = ("<urn:a>",), ("<urn:b>",)
CHAIRS = "SELECT ?c { ?c a dm:Chair }"


def standing(**fields):
    return StandingQuery.of(Watch(query=CHAIRS, watch="w", lease=9.0, **fields), "w1", demand=3)


def test_a_query_begins_without_rows_and_with_an_unlimited_lease():
    found = standing()
    assert (found.watch, found.query, found.lease_s, found.ends) == ("w1", CHAIRS, 9.0, math.inf)
    assert not found.rows


def test_only_a_query_of_inferred_facts_needs_measurements():
    assert standing(inferred=True).demand == 3
    assert standing(inferred=False).demand == 0


def test_a_standing_query_needs_a_text():
    with pytest.raises(errors.InternalError, match="has no text"):
        StandingQuery.of(Watch(watch="w"), "w", demand=0)


def test_rows_appear_and_disappear_with_their_number():
    found = standing()
    changed = found.update_rows([A, A, B], since=1, seq=2)
    assert (changed.watch, changed.since, changed.seq) == ("w1", 1, 2)
    assert sorted(changed.appeared) == [A, A, B]
    assert changed.disappeared == ()
    changed = found.update_rows([A, B, B], since=2, seq=5)
    assert (changed.appeared, changed.disappeared) == ((B,), (A,))
    assert found.update_rows([B, A, B], since=5, seq=6) is None
    assert sorted(found.update_rows([], since=6, seq=7).disappeared) == [A, B, B]


def test_a_commit_touches_a_query_if_it_changes_what_the_query_reads():
    typed = (v.entity_iri("chair1"), v.RDF_TYPE, v.dm("Chair"))
    other = (v.entity_iri("chair1"), v.RDF_TYPE, v.dm("Table"))
    for inferred in (True, False):
        query = standing(inferred=inferred)
        assert query.is_touched(Delta(seq=1, inserted=(typed,)))
        assert not query.is_touched(Delta(seq=1, retracted=(other,)))
    inferred_only = Delta(seq=1, newly_inferred=(typed,))
    assert standing(inferred=True).is_touched(inferred_only)
    assert not standing(inferred=False).is_touched(inferred_only)
