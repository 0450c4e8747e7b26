"""Differences between two commits, and the times of a spatial relation."""

import re

import pytest

from semmap.schemas import errors


@pytest.fixture(scope="module")
def system(empty_map):
    return empty_map


@pytest.fixture(scope="module")
def told(system):
    """A client of a map in which a cup was moved from one table to another and back."""
    with system.client() as client:
        client.add("Kitchen", "kitchen1", at=(0, 0, 0), size=(6, 6, 3))  # 2, after the ontology
        client.add("Table", "table1", at=(1, 1, 0), size=(1, 1, 0.7))
        client.add("Table", "table2", at=(-1, -1, 0), size=(1, 1, 0.7))
        client.add("Cup", "cup1", at=(1, 1, 0.7), ref="my cup")  # 5
        client.update("cup1", at=(-1, -1, 0.7))  # 6
        client.update("cup1", at=(1.1, 1, 0.7), ref="your cup")  # 7
        client.remove("table2")  # 8
        yield client


def test_changes_are_listed_by_entity(told):
    found = told.diff("5", "6")
    assert [(change.name, change.kind) for change in found.changes] == [("cup1", "pose")]
    assert [(r.subject, r.text) for r in found.relations] == [
        ("cup1", "is no longer on table1"),
        ("cup1", "is on table2"),
    ]
    assert (found.first, found.last) == (5, 6)


@pytest.mark.parametrize(
    ("where", "changed", "relations"),
    [
        ({"on": "table1"}, ["cup1"], ["is no longer on table1"]),
        ({"on": "table2"}, ["cup1"], ["is on table2"]),
        ({"in_": "kitchen1"}, ["table2"], ["is no longer in kitchen1"]),
        ({"on": "kitchen1"}, [], []),
    ],
)
def test_a_diff_of_a_place_has_only_what_came_or_left(told, where, changed, relations):
    found = told.diff("5", "8" if "in_" in where else "6", **where)
    assert [change.name for change in found.changes] == changed
    assert [relation.text for relation in found.relations] == relations


def test_a_move_there_and_back_leaves_no_change_of_the_pose(told):
    found = told.diff("5")
    kinds = [(change.name, change.kind) for change in found.changes]
    assert kinds == [("cup1", "pose"), ("cup1", "reference"), ("table2", "removed")]
    assert [r.text for r in found.relations] == ["is no longer in kitchen1"]
    assert found.relations[0].subject == "table2"
    assert told.diff("8").changes == told.diff("8").relations == ()


def test_every_diff_leads_from_one_map_to_the_other(told):
    for first in range(1, 8):
        for last in range(first, 9):
            names = {e.name for e in told.list(as_of=str(first))}
            for change in told.diff(str(first), str(last)).changes:
                if change.kind == "added":
                    assert change.name not in names
                    names.add(change.name)
                if change.kind == "removed":
                    names.remove(change.name)
            assert names == {e.name for e in told.list(as_of=str(last))}


@pytest.mark.parametrize("word", ["your cup", "Cup", "the cup"])
def test_the_past_of_an_entity_is_found_by_its_label_or_class(told, word):
    assert told.when(word, "isOn", "Table").spells == told.when("cup1", "isOn", "table1").spells
    assert told.last_seen(word).name == "cup1"
    assert told.history(word) == told.history("cup1")
    assert told.last_seen("table2").removed is not None


def test_times_of_a_relation_are_reported(told):
    found = told.when("cup1", "isOn", "table1")
    assert [(spell.since, spell.until) for spell in found.spells] == [(5, 6), (7, None)]
    assert re.fullmatch(
        r"cup1 has been on table1 since commit 7 \(for \d+ s\); before that from commit 5 until commit 6"
        r" \(for \d+ s, until \d+ s ago\); 2 times, \d+ s in all",
        found.text,
    )
    assert found.total_s >= 0
    gone = told.when("cup1", "isOn", "table2")
    assert [(spell.since, spell.until) for spell in gone.spells] == [(6, 7)]
    assert re.fullmatch(
        r"cup1 is no longer on table2; it was from commit 6 until commit 7 \(for \d+ s, until \d+ s ago\)",
        gone.text,
    )
    assert told.when("your cup", "isLocatedIn", "kitchen").spells[0].since == 5
    assert told.when("table1", "isOn", "cup1").text == "table1 was never on cup1"


def test_an_object_in_a_corner_is_also_in_the_room(told):
    told.add("Corner", "corner1", at=(1, 1, 0), size=(1, 1, 2))  # 9
    assert [(spell.since, spell.until) for spell in told.when("cup1", "isLocatedIn", "kitchen1").spells] == [
        (5, None)
    ]
    assert [(spell.since, spell.until) for spell in told.when("cup1", "isLocatedIn", "corner1").spells] == [
        (9, None)
    ]
    told.undo(9)


def test_invalid_queries_are_reported(told):
    with pytest.raises(errors.BadRequest, match="commit 6 comes after commit 5; give the earlier one first"):
        told.diff("6", "5")
    with pytest.raises(errors.Refused, match="there is no commit 99 yet; the last one is 10"):
        told.diff("99")
    with pytest.raises(errors.UnknownName):
        told.when("nothing1", "isOn", "table1")


def test_a_place_is_in_a_place_and_an_object_on_its_support(told):
    told.add("Location", "flat1", at=(0, 0, 0), size=(9, 9, 3))
    found = told.when("kitchen1", "isLocatedIn", "flat1")
    assert [spell.until for spell in found.spells] == [None]
    told.add("Bowl", "bowl1", at=(1.3, 1, 0.7), size=(0.2, 0.2, 0.1))
    told.add("Book", "book1", at=(0.8, 0.8, 0.7), size=(0.2, 0.2, 0.05))
    told.add("Book", "book2", at=(0.8, 0.8, 0.75), size=(0.2, 0.2, 0.05))
    found = told.when("book2", "isOn", "the table1")
    assert found.spells == ()
    assert re.fullmatch(
        r"book2 was never itself on table1; it has been on book1 since commit \d+ \(for \d+ s\),"
        r" and book1 is on table1",
        found.text,
    )
    assert told.when("bowl1", "isOn", "book1").text == "bowl1 was never on book1"


def test_commits_that_changed_something_in_a_place(told):
    def listed(**fields):
        return [commit.seq for commit in told.history(**fields)]

    assert listed(in_="kitchen1", until=8) == [3, 4, 5, 6, 7, 8]
    assert listed(in_="the kitchen", name="cup1", since=6, until=8) == [6, 7]
    told.add("Kitchen", "kitchen2", at=(20, 0, 0), size=(6, 6, 3))
    told.update("cup1", at=(20, 1, 0))
    told.update("cup1", at=(1.1, 1, 0.7))
    last = told.history()[-1].seq
    assert listed(in_="kitchen2") == [last - 1, last], "what enters and what leaves a place"
