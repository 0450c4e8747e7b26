"""Commits of the history that changed something in a place, also under its earlier names."""

import pytest

from semmap.nodes.kb_node.answers.past.commit_selection import Authorship, find_commits_by, list_commits
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import History
from semmap.schemas.commits import Edit, NewEntity, Transaction
from semmap.schemas.entities import Pose
from tests.kb_node import home
from tests.kb_node.home import chair, transaction

ELSEWHERE = (9.0, 9.0, 0.0)


@pytest.fixture
def listed(tmp_path):
    """Return a function that lists the commits in a place, of a map in which two kitchens are renamed."""
    semantic_map = home.new_map(tmp_path)

    def rename(number, name, new):
        edit = (Edit(name=name, rename=new),)
        semantic_map.commit(Transaction(id=str(number), source="operator", verb="rename", edit=edit))

    def add_kitchen(number, at):
        new = NewEntity(
            name="kitchen1", class_iri=v.bare(v.dm("Kitchen")), pose=Pose(position_m=at), size=(6.0, 6.0, 3.0)
        )
        semantic_map.commit(Transaction(id=str(number), source="operator", add=(new,)))

    add_kitchen(1, (0.0, 0.0, 0.0))
    semantic_map.commit(transaction(2, chair()))
    semantic_map.commit(transaction(3, chair("chair2", at=ELSEWHERE)))
    rename(4, "kitchen1", "kitchen2")
    semantic_map.commit(transaction(5, (), chair()))
    add_kitchen(6, ELSEWHERE)
    semantic_map.commit(transaction(7, chair("chair3", at=ELSEWHERE)))
    rename(8, "kitchen2", "kitchen3")
    rename(9, "kitchen1", "kitchen2")
    semantic_map.commit(transaction(10, chair("chair4")))
    past = HistoryReader(semantic_map._journal)

    def list_in(place):
        found = list_commits(semantic_map._journal, past, History(in_=place), Thresholds())
        return [commit.seq for commit in found]

    yield list_in
    home.close(semantic_map)


def test_commits_in_a_renamed_place_include_those_under_its_earlier_names(listed):
    assert listed("kitchen3") == [2, 5, 10]


def test_commits_in_the_place_that_had_the_new_name_before_are_not_included(listed):
    assert listed("kitchen2") == [2, 7], (
        "2 is in the first place that was named kitchen1, as in `history NAME`"
    )


AUTHORS = [
    Authorship(1, "operator"),
    Authorship(2, "operator", "anna"),
    Authorship(3, "perception", "camera1"),
    Authorship(4, "file", "Anna"),
]


@pytest.mark.parametrize(
    ("author", "commits"),
    [
        ("anna", {2, 4}),
        ("ANNA", {2, 4}),
        ("operator", {1, 2}),
        ("operator/anna", {2}),
        ("file/anna", {4}),
        ("camera1", {3}),
        ("perception", {3}),
    ],
)
def test_commits_of_an_author_are_found_by_source_agent_or_both(author, commits):
    assert find_commits_by(AUTHORS, author) == commits


@pytest.mark.parametrize(
    ("commits", "author", "text"),
    [
        (AUTHORS, "camera", "no commit is by 'camera'; did you mean camera1"),
        (AUTHORS, "xyz", "no commit is by 'xyz'; the authors are Anna, anna, camera1, file and 2 more"),
        ([], "xyz", "no commit is by 'xyz'$"),
    ],
)
def test_an_unknown_author_is_reported_with_the_known_ones(commits, author, text):
    with pytest.raises(errors.UnknownName, match=text):
        find_commits_by(commits, author)
