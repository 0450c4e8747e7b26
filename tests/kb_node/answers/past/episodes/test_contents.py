"""What is missing and what has changed in a map, also of renamed entities."""

import pytest

from semmap.nodes.kb_node.answers.past.episodes import contents
from semmap.nodes.kb_node.answers.past.episodes.occurrences import Occurrences, Place
from semmap.nodes.kb_node.answers.past.episodes.timeline import Timeline
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.ontology import vocabulary as v
from semmap.schemas.commits import Edit, NewEntity
from semmap.schemas.entities import Pose
from tests.kb_node import home
from tests.kb_node.home import chair, transaction, turtle

HERE, FAR = (1.0, 2.0, 0.0), (9.0, 9.0, 0.0)


@pytest.fixture(scope="module")
def asked(tmp_path_factory):
    """Commits: 1 three chairs, 2 a kitchen, 3 and 4 rename the first, 5 removes it, 6 to 10 the others.

    Commit 8 moves the third one back, 9 renames it, and 10 adds another one with its earlier name.
    """
    made = home.new_map(tmp_path_factory.mktemp("map"))
    three = [*chair(), *chair("chair2"), *chair("chair3")]
    made.commit(transaction(1, three))
    made.commit(transaction(2, turtle(":kitchen1 a dm:Kitchen .")))
    made.commit(transaction(3, verb="rename", edit=(Edit(name="chair1", rename="seat1"),)))
    made.commit(transaction(4, verb="rename", edit=(Edit(name="seat1", rename="throne"),)))
    made.commit(transaction(5, remove=("throne",)))
    made.commit(transaction(6, verb="rename", edit=(Edit(name="chair2", rename="stool"),)))
    made.commit(transaction(7, edit=(Edit(name="chair3", at=FAR),)))
    made.commit(transaction(8, edit=(Edit(name="chair3", at=HERE),)))
    made.commit(transaction(9, verb="rename", edit=(Edit(name="chair3", rename="bench"),)))
    another = NewEntity(name="chair3", class_iri=v.bare(v.dm("Chair")), pose=Pose(position_m=FAR))
    made.commit(transaction(10, add=(another,)))
    journal = made._journal
    timeline = Timeline(journal, HistoryReader(journal), Thresholds(), list, journal.stamps.of(10) + 1, 60.0)
    occurrences = Occurrences(timeline, {}, ())

    def ask(function, place, first, last):
        found = function(timeline, occurrences, place, first, last, "here")
        return found.names, [(episode.what, episode.since) for episode in found.evidence]

    yield ask
    home.close(made)


@pytest.mark.parametrize(
    ("first", "last", "names", "evidence"),
    [
        (1, 2, (), []),
        (2, 4, (), []),  # it has another name
        (4, 5, ("throne",), [("removed", 5)]),
        (1, 7, ("throne",), [("removed", 5)]),
        (3, 6, ("throne",), [("removed", 5)]),
        (8, 10, (), []),  # another one has its name
    ],
)
def test_what_was_removed_is_missing_also_if_it_was_renamed_before(asked, first, last, names, evidence):
    assert asked(contents.missing, None, first, last) == (names, evidence)


@pytest.mark.parametrize(
    ("first", "last", "names", "commits"),
    [
        (1, 1, (), []),
        (1, 2, ("kitchen1",), [2]),
        (2, 3, ("seat1",), [3]),
        (2, 5, ("throne",), [5]),
        (5, 7, ("chair3", "stool"), [7, 6]),
        (8, 10, ("bench", "chair3"), [9, 10]),  # one was renamed, the other one is new
    ],
)
def test_what_differs_between_two_commits_has_changed(asked, first, last, names, commits):
    found, evidence = asked(lambda *args: contents.changed(*args[:2], (), *args[3:]), None, first, last)
    assert found == names
    assert [since for _, since in evidence] == commits


def test_what_was_moved_away_from_a_thing_is_missing_there(asked):
    near = Place("near", ("stool",), "stool")
    assert asked(contents.missing, near, 6, 7) == (("chair3",), [("moved", 7)])
    assert asked(contents.missing, near, 6, 6) == ((), [])


def test_what_has_another_name_is_not_missing_where_it_was(asked):
    near = Place("near", ("stool",), "stool")
    assert asked(contents.missing, near, 8, 10) == ((), [])
