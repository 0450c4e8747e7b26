"""Differences between two commits, and the times of a spatial relation."""

import re
from datetime import datetime

import pytest

from semmap.nodes.kb_node.answers.past.commit_selection import list_commits
from semmap.nodes.kb_node.answers.past.differences import compute_difference, find_spells
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Diff, History, WasWhen
from semmap.schemas.commits import Edit, NewEntity, Transaction
from semmap.schemas.entities import Pose
from tests.kb_node import home

LAST = 18
THIN = (0.2, 0.2, 0.05)


def new(name, class_name, at, size=None, **fields):
    iri = v.bare(v.dm(class_name))
    return NewEntity(name=name, class_iri=iri, pose=Pose(position_m=at), size=size, **fields)


def edit(name, **fields):
    return {"edit": (Edit(name=name, **fields),)}


BOOKS = (new("book1", "Book", (0.8, 0.8, 0.7), THIN), new("book2", "Book", (0.8, 0.8, 0.75), THIN))


class Past:
    """A map with its history, and the queries about it."""

    def __init__(self, folder):
        self.journal = home.new_household_journal(folder)
        self.map = SemanticMap(self.journal)
        self.reader = HistoryReader(self.journal)
        changes = [
            {"add": (new("kitchen1", "Kitchen", (0, 0, 0), (6, 6, 3)),)},  # 1
            {"add": (new("table1", "Table", (1, 1, 0), (1, 1, 0.7)),)},  # 2
            {"add": (new("table2", "Table", (-1, -1, 0), (1, 1, 0.7)),)},  # 3
            {"add": (new("cup1", "Cup", (1, 1, 0.7), ref="my cup"),)},  # 4
            edit("cup1", at=(-1, -1, 0.7)),  # 5
            edit("cup1", at=(1.1, 1, 0.7), ref="your cup"),  # 6
            {"remove": ("table2",)},  # 7
            {"add": (new("corner1", "Corner", (1, 1, 0), (1, 1, 2)),)},  # 8
            {"add": (new("flat1", "Location", (0, 0, 0), (9, 9, 3)),)},  # 9
            {"add": (new("bowl1", "Bowl", (1.3, 1, 0.7), (0.2, 0.2, 0.1)),)},  # 10
            {"add": BOOKS},  # 11
            edit("bowl1", rename="dish1"),  # 12
            {"add": (new("bowl1", "Bowl", (-2, -2, 0), (0.2, 0.2, 0.1)),)},  # 13
            {"add": (new("kitchen2", "Kitchen", (20, 0, 0), (6, 6, 3)),)},  # 14
            edit("cup1", at=(20, 1, 0)),  # 15
            edit("cup1", at=(1.1, 1, 0.7)),  # 16
            {"add": (new("box1", "Box", (-2, 2, 0), (0.6, 0.6, 0.4)),)},  # 17
            {"add": (new("fork1", "Fork", (-2, 2, 0.1), (0.05, 0.05, 0.05)),)},  # 18
        ]  # fmt: skip
        for number, change in enumerate(changes, start=1):
            self.map.commit(Transaction(id=str(number), source="operator", **change))

    def diff(self, since, until=None, **where):
        query = Diff(since=since, until=until, **where)
        return compute_difference(self.journal, self.reader, query, Thresholds())

    def when(self, *words):
        return find_spells(self.journal, self.reader, WasWhen(*words), Thresholds())

    def spans(self, *words):
        return [(spell.since, spell.until) for spell in self.when(*words).spells]

    def history(self, **fields):
        found = list_commits(self.journal, self.reader, History(**fields), Thresholds())
        return [commit.seq for commit in found]

    def names(self, seq):
        return {entity.name for entity in self.reader.entities(seq)}


@pytest.fixture(scope="module")
def past(tmp_path_factory):
    made = Past(tmp_path_factory.mktemp("map"))
    yield made
    made.journal.close()


def changes_of(found):
    return [(change.name, change.kind) for change in found.changes]


def relations_of(found):
    return [f"{relation.subject} {relation.text}" for relation in found.relations]


@pytest.mark.parametrize(
    ("since", "until", "changes", "relations"),
    [
        (4, 5, [("cup1", "pose")], ["cup1 is no longer on table1", "cup1 is on table2"]),
        (
            4,
            7,  # moved there and back
            [("cup1", "pose"), ("cup1", "reference"), ("table2", "removed")],
            ["table2 is no longer in kitchen1"],
        ),
        (9, 10, [("bowl1", "added")], ["bowl1 is in corner1", "bowl1 is on table1"]),
        (11, 12, [("dish1", "name")], []),
        (12, 13, [("bowl1", "added")], ["bowl1 is in kitchen1"]),
        (11, 13, [("bowl1", "added"), ("dish1", "name")], ["bowl1 is in kitchen1"]),  # with dish1's old name
        (14, 16, [], []),
        (LAST, None, [], []),
    ],
)
def test_a_diff_lists_what_changed_by_entity(past, since, until, changes, relations):
    found = past.diff(since, until)
    assert (found.first, found.last) == (since, until or LAST)
    assert (found.first_ns, found.last_ns) == tuple(map(past.journal.stamps.of, (found.first, found.last)))
    assert changes_of(found) == changes
    assert relations_of(found) == relations


def test_a_diff_since_a_day_begins_before_it_and_one_since_a_moment_at_it(past):
    stamps = past.journal.stamps
    first, last = (datetime.fromtimestamp(stamps.of(seq) / 1e9).date() for seq in (1, LAST))
    assert past.diff(first.isoformat()).first == 1
    assert past.diff(first.isoformat(), last.isoformat()).last == LAST
    assert past.diff(stamps.of(5)).first == past.reader.commit_at(stamps.of(5))


def test_a_diff_since_a_second_has_the_commits_of_that_second(past):
    second = past.journal.stamps.of(LAST) // 10**9
    before = sum(past.journal.stamps.of(seq) < second * 10**9 for seq in range(1, LAST + 1))
    assert past.diff(second).first == max(before, 1)


@pytest.mark.parametrize(
    ("where", "since", "until", "changed", "relations"),
    [
        ({"on": "table1"}, 4, 5, ["cup1"], ["is no longer on table1"]),
        ({"on": "table2"}, 4, 5, ["cup1"], ["is on table2"]),
        ({"in_": "kitchen1"}, 4, 7, ["table2"], ["is no longer in kitchen1"]),
        ({"in_": "box1"}, 16, 18, ["fork1"], ["is inside box1"]),
        ({"on": "table1", "in_": "kitchen2"}, 14, 15, ["cup1"], ["is in kitchen2", "is no longer on table1"]),
        ({"on": "kitchen1"}, 4, 5, [], []),
    ],
)
def test_a_diff_of_a_place_has_only_what_came_or_left(past, where, since, until, changed, relations):
    found = past.diff(since, until, **where)
    assert [change.name for change in found.changes] == changed
    assert sorted(relation.text for relation in found.relations) == relations
    assert [relation.came for relation in found.relations] == [
        "no longer" not in relation.text for relation in found.relations
    ]


def test_every_diff_leads_from_one_map_to_the_other(past):
    for first in range(1, LAST, 3):
        for last in range(first, LAST + 1):
            names = past.names(first)
            changes = past.diff(first, last).changes
            gone = [change.name for change in changes if change.kind == "removed"]
            renamed = {change.was: change.name for change in changes if change.kind == "name"}
            for name in (*gone, *renamed):
                names.remove(name)
            for name in (*renamed.values(), *(change.name for change in changes if change.kind == "added")):
                assert name not in names
                names.add(name)
            assert names == past.names(last)


@pytest.mark.parametrize(
    ("words", "spans"),
    [
        (("cup1", "isOn", "table1"), [(4, 5), (6, 15), (16, None)]),
        (("cup1", "isOn", "table2"), [(5, 6)]),
        (("your cup", "isLocatedIn", "kitchen1"), [(4, 15), (16, None)]),
        (("cup1", "isLocatedIn", "corner1"), [(8, 15), (16, None)]),  # it is in the kitchen as well
        (("kitchen1", "isLocatedIn", "flat1"), [(9, None)]),
        (("kitchen1", "isLocatedIn", "kitchen1"), []),
        (("flat1", "isLocatedIn", "kitchen1"), []),
        (("cup1", "isLocatedIn", "table1"), []),
        (("fork1", "isInside", "box1"), [(18, None)]),
        (("dish1", "isOn", "table1"), [(10, None)]),
        (("table1", "isOn", "cup1"), []),
        (("cup1", "isNear", "dish1"), [(10, 15), (16, None)]),
        (("dish1", "isNear", "cup1"), [(10, 15), (16, None)]),
        (("cup1", "isNear", "kitchen1"), []),
    ],
)
def test_times_of_a_relation(past, words, spans):
    assert past.spans(*words) == spans


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (
            ("cup1", "isOn", "table2"),
            r"cup1 is no longer on table2; it was from commit 5 until commit 6 \(for D, until D ago\)",
        ),
        (
            ("cup1", "isLocatedIn", "kitchen1"),
            r"cup1 has been in kitchen1 since commit 16 \(for D\); before that from commit 4 until commit 15"
            r" \(for D, until D ago\); 2 times, D in all",
        ),
        (("table1", "isOn", "cup1"), "table1 was never on cup1"),
        (
            ("book2", "isOn", "the table1"),
            r"book2 was never itself on table1; it has been on book1 since commit 11 \(for D\),"
            r" and book1 is on table1",
        ),
        (("fork1", "isOn", "box1"), "fork1 was never on box1"),  # it is inside
        (("dish1", "isOn", "book1"), "dish1 was never on book1"),
        (("book2", "isNear", "kitchen1"), "book2 was never near kitchen1"),
    ],
)
def test_times_of_a_relation_are_described(past, words, text):
    found = past.when(*words)
    assert re.fullmatch(text.replace("D", r"[\d.]+ \w+"), found.text), found.text
    assert found.total_s >= 0
    assert (found.total_s > 0) == bool(found.spells)


@pytest.mark.parametrize(
    ("fields", "commits"),
    [
        ({"in_": "kitchen1", "until": 7}, [2, 3, 4, 5, 6, 7]),
        ({"in_": "kitchen1", "name": "cup1", "since": 5, "until": 7}, [5, 6]),
        ({"in_": "kitchen2"}, [15, 16]),  # what enters and what leaves a place
        ({"in_": "box1"}, [18]),
        ({"on": "table1"}, [4, 5, 6, 10, 11, 12, 15, 16]),
        ({"on": "table1", "in_": "kitchen2"}, [15, 16]),
        ({"on": "table1", "by": "operator", "limit": 2}, [15, 16]),
    ],
)
def test_commits_that_changed_something_in_a_place(past, fields, commits):
    assert past.history(**fields) == commits


@pytest.mark.parametrize(
    ("query", "error", "text"),
    [
        (lambda past: past.diff(6, 5), errors.BadRequest, "commit 6 comes after commit 5; give the earlier"),
        (lambda past: past.diff(99), errors.Refused, f"there is no commit 99 yet; the last one is {LAST}"),
        (lambda past: past.diff(4, on="nothing1"), errors.UnknownName, "nothing1"),
        (lambda past: past.when("nothing1", "isOn", "table1"), errors.UnknownName, "nothing1"),
        (lambda past: past.when("cup1", "isOn"), errors.BadRequest, "isOn requires the other entity"),
        (lambda past: past.history(on="kitchen1"), errors.Refused, "kitchen1"),
        (lambda past: past.history(by="nobody1"), errors.UnknownName, "no commit is by 'nobody1'"),
    ],
)
def test_invalid_queries_are_reported(past, query, error, text):
    with pytest.raises(error, match=text):
        query(past)
