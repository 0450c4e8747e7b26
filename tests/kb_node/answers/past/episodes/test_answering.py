"""Answers to questions about the past, from a short history."""

import re
from pathlib import Path

import pytest

from semmap.nodes.kb_node.answers.entity_search import EntitySearch
from semmap.nodes.kb_node.answers.past.episodes.replying import answer_questions
from semmap.nodes.kb_node.answers.past.episodes.resolving import PastQuestionReader
from semmap.nodes.kb_node.answers.past.episodes.timeline import Timeline
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.trail_file import TrailLine
from semmap.ontology import vocabulary as v
from semmap.schemas.commits import Edit, NewEntity, Statement, Transaction
from semmap.schemas.entities import Pose
from tests.kb_node import home

S = 1_000_000_000


def new(name, class_name, at, size, **fields):
    iri = v.bare(v.dm(class_name))
    return NewEntity(name=name, class_iri=iri, pose=Pose(position_m=at), size=size, **fields)


def is_open(value):
    return Edit(name="fridge1", set=(Statement(property="isOpen", values=(value,)),))


ROOMS = (
    new("kitchen1", "Kitchen", (0, 0, 0), (8, 8, 3)),
    new("bathroom1", "Bathroom", (20, 0, 0), (8, 8, 3)),
    new("studio1", "Studio", (10, 0, 0), (8, 8, 3)),
    new("table1", "Table", (1, 1, 0), (1, 1, 0.7)),
    new("desk1", "Desk", (10, 1, 0), (1, 1, 0.7)),
    new("fridge1", "Fridge", (-3, -3, 0), (0.7, 0.7, 1.8)),
    new("r2", "Robot", (0, 0, 0), (0.4, 0.4, 1.0)),
)
ON_TABLE, ON_DESK = (1, 1, 0.7), (10, 1, 0.7)


@pytest.fixture(scope="module")
def ask(tmp_path_factory):
    """Commits: 1 rooms, 2 cup on the table, 3 the desk, 4 the table, 5 and 6 fridge, 7 plate removed."""
    semantic_map = SemanticMap(home.new_household_journal(tmp_path_factory.mktemp("map")))
    journal, past = semantic_map._journal, HistoryReader(semantic_map._journal)

    def commit(number, agent="", **fields):
        semantic_map.commit(Transaction(id=f"{number}", source="operator", agent=agent, **fields))

    cup = new("cup1", "Cup", ON_TABLE, (0.08, 0.08, 0.1), ref="red cup")
    commit(1, add=(*ROOMS, new("plate1", "Plate", (1.3, 1.3, 0.7), (0.2, 0.2, 0.02))))
    commit(2, add=(cup,))
    commit(3, "anna", edit=(Edit(name="cup1", at=ON_DESK),))
    commit(4, "bruno", edit=(Edit(name="cup1", at=ON_TABLE),))
    commit(5, "anna", edit=(is_open("true"),))
    commit(6, "bruno", edit=(is_open("false"),))
    commit(7, "anna", remove=("plate1",))
    ns = journal.stamps.of(2)
    lines = [
        TrailLine(ns, "start"),
        TrailLine(ns, "at", "r2", (10.0, 0.0, 0.0), ("studio1",)),
        TrailLine(ns + 1000, "at", "r2", (0.0, 0.0, 0.0), ("kitchen1",)),
        TrailLine(ns + 2000, "at", "r2", (10.0, 0.0, 0.0), ("studio1",)),
    ]
    reader = PastQuestionReader(semantic_map, EntitySearch(semantic_map), journal, past)

    def answered(text, longest_s=60.0):
        language, asked = reader.read(text, None)
        now_ns, limits = journal.stamps.of(7) + S, semantic_map.classes.limits
        timeline = Timeline(journal, past, limits, lambda: lines, now_ns, longest_s)
        return answer_questions(timeline, text, language, asked)

    yield answered
    journal.close()


def read_table(name):
    """Return the pairs of a question and its answer in a file."""
    lines = (Path(__file__).parent / name).read_text().splitlines()
    return [(question, answer.strip()) for question, answer in zip(lines[::2], lines[1::2], strict=True)]


def untimed(text):
    """Return a text without clock times and durations."""
    text = re.sub(r"\d\d:\d\d:\d\d", "T", text)
    return re.sub(r"\d+ s\b", "N s", text)


@pytest.mark.parametrize(("text", "answer"), read_table("known.txt"))
def test_an_answer_is_a_sentence_with_its_evidence(ask, text, answer):
    found = ask(text)
    assert untimed(found.answer) == answer
    assert (found.past[0].is_known, found.doubts, found.mood) == (True, (), "question")


@pytest.mark.parametrize(("text", "answer"), read_table("unknown.txt"))
def test_what_cannot_be_known_is_stated(ask, text, answer):
    found = ask(text)
    assert untimed(found.answer).startswith(answer)
    assert not found.past[0].is_known


def test_the_reply_has_names_times_and_commits_as_data(ask):
    (who,) = ask("who moved cup1").past
    assert (who.names, [e.since for e in who.evidence]) == (("bruno",), [3, 4])
    (when,) = ask("when was cup1 last moved").past
    assert when.times_ns == (who.evidence[-1].since_ns,)
    (ever,) = ask("has cup1 ever been on desk1").past
    assert (ever.verdict, ever.evidence[0].until) == (True, 4)


def test_it_refers_to_the_subject_of_the_question_before(ask):
    found = ask("where was cup1 at commit 3? who moved it last?")
    assert [one.names for one in found.past] == [("desk1", "studio1"), ("bruno",)]


@pytest.mark.parametrize("text", ["where was cup1", "was anything moved in the kitchen", "who moved cup1"])
def test_reading_the_history_has_a_time_limit(ask, text):
    (found,) = ask(text, longest_s=0.0).past
    assert not found.is_known
    assert found.text.startswith("the history is too long to answer this within 0 s; ask about one thing")


def test_a_text_that_is_too_long_for_a_command_is_no_question(ask):
    assert ask("where was the red " + "red " * 200 + "cup").past == ()


@pytest.mark.parametrize(
    ("text", "count", "verdict", "names", "commits"),
    [
        ("how often was cup1 moved", 2, None, (), [3, 4]),
        ("how often was cup1 near table1", 0, None, (), []),
        ("how many cups were on table1", 1, None, ("cup1",), [2, 4]),
        ("how long was cup1 in the kitchen", 2, None, (), [2, 4]),
        ("when was cup1 put on table1", 2, None, (), [2, 4]),
        ("when was cup1 on desk1 in the kitchen", 0, None, (), []),
        ("since when is plate1 missing", None, None, (), [7]),
        ("who put cup1 on table1", 2, None, ("bruno",), [2, 4]),
        ("who entered the kitchen", 0, None, (), []),
        ("what was taken from table1", 2, None, ("cup1", "plate1"), [3, 7]),
        ("what was near table1 at commit 4", 0, None, (), []),
        ("was plate1 removed by anna", 1, True, ("anna",), [7]),
        ("was it anna who left the fridge open", 1, False, ("anna",), [5]),
        ("was cup1 on desk1 in the studio", 1, True, (), [3]),
        ("was r2 ever in the bathroom", 0, False, (), []),
        ("was plate1 ever missing", 1, True, (), [7]),
        ("where has cup1 been", None, None, ("table1", "kitchen1", "desk1", "studio1"), [2, 3, 4]),
        ("where was plate1 last", None, None, ("table1", "kitchen1"), [1]),
    ],
)
def test_an_answer_as_data(ask, text, count, verdict, names, commits):
    (found,) = ask(text).past
    assert (found.count, found.verdict, found.names) == (count, verdict, names)
    assert [episode.since for episode in found.evidence] == commits
    assert bool(found.times_ns) == (bool(commits) and text.startswith(("when", "since", "how often")))
    assert (found.seconds is not None) == text.startswith("how long")
