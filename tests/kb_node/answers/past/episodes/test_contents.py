"""What is missing and what has changed in a map, also of renamed entities."""

import pytest

from semmap.nodes.kb_node.answers.past.episodes import contents
from semmap.nodes.kb_node.answers.past.episodes.occurrences import Occurrences, Place
from semmap.nodes.kb_node.answers.past.episodes.timeline import Timeline
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.schemas.commits import Edit
from tests.kb_node import home
from tests.kb_node.home import chair, transaction, turtle

FAR = (9.0, 9.0, 0.0)


@pytest.fixture(scope="module")
def asked(tmp_path_factory):
    """Commits: 1 three chairs, 2 a kitchen, 3 and 4 rename the first, 5 removes it, 6 and 7 the others."""
    made = home.new_map(tmp_path_factory.mktemp("map"))
    three = [*chair(), *chair("chair2"), *chair("chair3")]
    made.commit(transaction(1, three))
    made.commit(transaction(2, turtle(":kitchen1 a dm:Kitchen .")))
    made.commit(transaction(3, verb="rename", edit=(Edit(name="chair1", rename="seat1"),)))
    made.commit(transaction(4, verb="rename", edit=(Edit(name="seat1", rename="throne"),)))
    made.commit(transaction(5, remove=("throne",)))
    made.commit(transaction(6, verb="rename", edit=(Edit(name="chair2", rename="stool"),)))
    made.commit(transaction(7, edit=(Edit(name="chair3", at=FAR),)))
    journal = made._journal
    timeline = Timeline(journal, HistoryReader(journal), Thresholds(), list, journal.stamps.of(7) + 1, 60.0)
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
