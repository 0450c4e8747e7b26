"""Handlers of queries, without the wire."""

import re
import threading

import pytest

from semmap.nodes.kb_node.handlers.queries import QueryHandlers
from semmap.nodes.kb_node.shacl.validation_process import Validation
from semmap.nodes.kb_node.storage import trail_file
from semmap.schemas.commands import Check, Export, Find, LastSeen, Rules
from semmap.schemas.commits import Edit
from semmap.schemas.entities import Live, Pose, orientation_from_yaw
from semmap.schemas.live import LivePoses
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


@pytest.fixture
def queries(chairs):
    chairs.commit(transaction(2, edit=(Edit(name="chair1", tracked="stream"),)))
    made = QueryHandlers(chairs, chairs._journal, sparql=None, location_queries=None)
    yield made
    made.close()


LIVE = Live(
    pose=Pose(position_m=(7.0, 2.0, 0.0), orientation_wxyz=orientation_from_yaw(1.0)),
    stamp_ns=1,
    age_s=0.0,
    source="stream",
)


def test_last_seen_returns_the_live_pose_without_reading_the_trail(queries, monkeypatch):
    queries.on_live_poses(LivePoses(stamp_ns=1, entities={"chair1": LIVE}))
    monkeypatch.delattr(trail_file, "read_lines")
    found = queries.past.on_last_seen(LastSeen(name="chair1"))
    assert (found.pose, found.text) == (LIVE.pose, "live now at (7.00, 2.00, 0.00) m")


def test_last_seen_returns_the_last_stored_position_after_the_live_poses(queries):
    queries.on_live_poses(LivePoses(stamp_ns=1, entities={"chair1": LIVE}))
    queries.on_live_poses(LivePoses(stamp_ns=2, entities={}))
    found = queries.past.on_last_seen(LastSeen(name="chair1")).result(timeout=60)
    assert found.pose == Pose(position_m=(7.0, 2.0, 0.0))
    assert re.fullmatch(r"live \d+ s ago at \(7.00, 2.00, 0.00\) m", found.text)


def test_closing_writes_the_end_of_live_poses(queries, chairs):
    queries.on_live_poses(LivePoses(stamp_ns=1, entities={"chair1": LIVE}))
    queries.close()
    kinds = [line.kind for line in trail_file.read_lines(chairs._journal.path.parent)]
    assert kinds == ["start", "at", "end"]


def test_slow_checks_with_shapes_delay_no_other_query(chairs):
    queries = QueryHandlers(chairs, chairs._journal, sparql=None, location_queries=None)
    goes_on = threading.Event()

    class Slow:
        def validate(self, *_):
            assert goes_on.wait(60.0)
            return Validation(shapes=1)

        def close(self):
            goes_on.set()

    queries._validator = Slow()
    try:
        checks = [queries.on_check(Check(shapes=b"shapes")) for _ in range(3)]
        assert queries.on_export(Export()).result(60.0).content
        assert queries.on_check(Check()).result(60.0).consistent
        assert not any(check.done() for check in checks)
        goes_on.set()
        assert [check.result(60.0).shapes for check in checks] == [1, 1, 1]
    finally:
        queries.close()


def test_find_searches_the_map_now_or_after_a_commit(chairs):
    chairs.commit(transaction(2, chair("chair3", at=(5.0, 5.0, 0.0))))
    queries = QueryHandlers(chairs, chairs._journal, sparql=None, location_queries=None)
    found = queries.on_find(Find(text="the chairs"))
    before = queries.on_find(Find(text="the chairs", as_of=found.seq - 1)).result(timeout=30)
    assert [len(found.candidates), len(before.candidates)] == [3, 2]
    assert before.seq == found.seq - 1
