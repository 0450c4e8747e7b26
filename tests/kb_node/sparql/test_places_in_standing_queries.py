"""Standing queries over computed facts have the right rows after each of 300 commits."""

import queue
import random

import pytest

from semmap.nodes.kb_node.sparql.service import SparqlService
from semmap.ontology import vocabulary as v
from semmap.schemas.commands import Sparql, Watch
from semmap.schemas.commits import Edit, Transaction

WAIT_S = 60.0
COMMITS = 300
ON, IN, KITCHEN = v.dm("isOn"), v.dm("isLocatedIn"), v.entity_iri("kitchen1")


def on(reasoner):
    return {(s, o) for source in (reasoner.given, reasoner.inferred) for s, _, o in source(None, ON, None)}


def in_kitchen(reasoner):
    return {(i,) for i in reasoner.instances(v.dm("Graspable_Thing")) if reasoner.holds((i, IN, KITCHEN))}


def laden(reasoner):
    return {(i,) for i in reasoner.instances(v.dm("Laden_Thing"))}


QUERIES = {
    "SELECT DISTINCT ?x ?y { ?x dm:isOn ?y }": on,
    "SELECT DISTINCT ?x { ?x dm:isLocatedIn :kitchen1 . ?x a dm:Graspable_Thing }": in_kitchen,
    "SELECT DISTINCT ?x { ?x a dm:Laden_Thing }": laden,
}
"""Each with the same question to the map's own reasoner."""


@pytest.mark.long
def test_standing_queries_have_the_correct_rows(flat):
    dice, news = random.Random(15), queue.SimpleQueue()
    service = SparqlService(lambda: flat.reasoner.asserted(), news.put, derived_changes=flat.all_derived)
    rows, truth = {}, {}
    for query, evaluate in QUERIES.items():
        begun = service.ask(Watch(query=query, inferred=True, lease=600.0), flat.seq).result(WAIT_S)
        rows[begun.watch] = (evaluate, set(begun.rows))
        assert set(begun.rows) == evaluate(flat.reasoner)
    movable = [e for e in flat.entities() if e.pose is not None and not e.place and not e.fixed]
    spots = [e.pose.position_m for e in movable] + [(2.0, 2.0, 0.0), (20.0, 20.0, 0.0)]
    for number in range(COMMITS):
        name, (x, y, z) = dice.choice(movable).name, dice.choice(spots)
        at = (x + dice.choice([0.0, 0.0, 0.02]), y, z)
        commit = flat.commit(Transaction(id=f"c{number}", source="operator", edit=(Edit(name=name, at=at),)))
        if commit is not None:
            service.follow(commit, flat.take_derived_changes(commit))
        truth[flat.seq] = {evaluate: evaluate(flat.reasoner) for evaluate in QUERIES.values()}
    for query, evaluate in QUERIES.items():
        asked = service.ask(Sparql(query=query, inferred=True), flat.seq).result(WAIT_S)
        assert set(asked.rows) == truth[flat.seq][evaluate]
    service.ask(Watch(query="SELECT ?x { ?x a dm:Cup }"), flat.seq).result(WAIT_S)  # all evaluations are done
    told = 0
    while not news.empty():
        change = news.get().rows
        if change is None or change.watch not in rows:
            continue
        evaluate, before = rows[change.watch]
        assert before == truth.get(change.since, {}).get(evaluate, before)
        now = before.difference(change.disappeared).union(change.appeared)
        assert now == truth[change.seq][evaluate]
        rows[change.watch] = evaluate, now
        told += 1
    assert told > 100
    for evaluate, now in rows.values():
        assert now == truth[flat.seq][evaluate]
    service.close()
