"""Handlers of queries, without the wire."""

import pytest

from semmap.nodes.kb_node.handlers.queries import QueryHandlers
from semmap.schemas.commands import Find, Rules
from tests.kb_node import home
from tests.kb_node.home import chair, transaction, turtle

SWRL = "http://www.w3.org/2003/11/swrl#"
RULES = f"""
<urn:x> a <{SWRL}Variable> . :seats a <{SWRL}Imp> ; rdfs:label "seats" ;
    <{SWRL}body> ( [ a <{SWRL}ClassAtom> ; <{SWRL}classPredicate> dm:Chair ; <{SWRL}argument1> <urn:x> ] ) ;
    <{SWRL}head> ( [ a <{SWRL}ClassAtom> ; <{SWRL}classPredicate> dm:Seat ; <{SWRL}argument1> <urn:x> ] ) .
:off a <{SWRL}Imp> ; <{SWRL}body> () ; <{SWRL}head> () .
"""


@pytest.fixture
def chairs(tmp_path):
    made = home.new_map(tmp_path, [*home.TBOX, *turtle(RULES)])
    made.commit(transaction(1, [*chair(), *chair("chair2", at=(3.0, 3.0, 0.0))]))
    yield made
    home.close(made)


def test_rules_are_listed_with_their_matches_in_the_map(chairs):
    queries = QueryHandlers(chairs, chairs._journal, sparql=None, location_queries=None)
    found = {rule.name: rule for rule in queries.on_rules(Rules())}
    assert (found["seats"].text, found["seats"].holds) == ("if x is a chair, then x is a Seat", 2)
    assert (found["off"].text, found["off"].unsupported) == ("", "empty")


def test_find_searches_the_map_now_or_after_a_commit(chairs):
    chairs.commit(transaction(2, chair("chair3", at=(5.0, 5.0, 0.0))))
    queries = QueryHandlers(chairs, chairs._journal, sparql=None, location_queries=None)
    found = queries.on_find(Find(text="the chairs"))
    before = queries.on_find(Find(text="the chairs", as_of=found.seq - 1)).result(timeout=30)
    assert [len(found.candidates), len(before.candidates)] == [3, 2]
    assert before.seq == found.seq - 1
