"""Standing location queries report arriving and leaving entities."""

import random
import time

import pytest

from semmap.nodes.kb_node.answers.location_queries import LocationQueries
from semmap.nodes.kb_node.relations.selection import select_entities
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Renew, Watch
from semmap.schemas.commits import Edit
from semmap.schemas.relations import Where
from tests.kb_node import home
from tests.kb_node.test_places import TBOX, TOP, commit, move, new, take_back


@pytest.fixture
def room(tmp_path):
    semantic_map = home.new_map(tmp_path, TBOX)
    commit(
        semantic_map,
        add=(
            new("kitchen1", "Kitchen", (0.0, 0.0, 0.0), size=(12.0, 12.0, 2.5)),
            new("table1", "Table", (0.0, 0.0, 0.0), size=(1.5, 0.9, TOP)),
            new("table2", "Table", (3.0, 0.0, 0.0), size=(1.5, 0.9, TOP)),
            new("tray1", "Tray", (0.0, 0.0, TOP), size=(0.5, 0.4, 0.02)),
            new("cup1", "Cup", (-0.15, 0.0, TOP + 0.02)),
        ),
    )
    yield semantic_map
    home.close(semantic_map)


class Watched:
    """A standing query and its updates."""

    def __init__(self, semantic_map, **wanted):
        self.map = semantic_map
        self.news = []
        self.standing = LocationQueries(semantic_map, self.news.append)
        self.first = self.standing.watch(Watch(watch="w1", **wanted))
        self.now = names(self.first.rows)

    def after(self, made):
        """Return the rows that a commit added and removed."""
        self.standing.follow(made.seq, made.names)
        return self.told()

    def told(self):
        """Return the rows added and removed since the last call."""
        news, self.news[:] = list(self.news), []
        came, left = set(), set()
        for one in news:
            came |= names(one.rows.appeared)
            left |= names(one.rows.disappeared)
            assert one.rows.since < one.rows.seq
        self.now = self.now - left | came
        return came, left


def names(rows):
    return {v.entity_name(term) for (term,) in rows}


def test_arrivals_and_departures_are_published(room):
    on = Watched(room, on="table1")
    assert (on.now, on.first.variables) == ({"tray1", "cup1"}, ("entity",))
    assert on.after(move(room, "cup1", (3.0, 0.0, TOP))) == (set(), {"cup1"})
    assert on.after(move(room, "cup1", (0.5, 0.0, TOP))) == ({"cup1"}, set())
    assert on.after(move(room, "cup1", (0.5, 0.1, TOP))) == (set(), set())
    assert on.after(commit(room, add=(new("cup2", "Cup", (0.0, 0.3, TOP)),))) == ({"cup2"}, set())
    assert on.after(commit(room, remove=("cup2",))) == (set(), {"cup2"})
    assert on.after(take_back(room)) == ({"cup2"}, set())


def test_moving_the_support_is_published(room):
    on = Watched(room, on="table1")
    assert on.after(move(room, "table1", (0.0, 4.0, 0.0))) == (set(), {"tray1", "cup1"})
    assert on.after(move(room, "table1", (0.0, 0.1, 0.0))) == ({"tray1", "cup1"}, set())
    assert on.after(commit(room, remove=("tray1",))) == (set(), {"tray1"})


def test_by_class_and_by_label(room):
    on = Watched(room, on="Table", class_="Cup")
    assert on.now == {"cup1"}
    assert on.after(move(room, "cup1", (3.0, 0.0, TOP))) == (set(), set())
    assert on.after(commit(room, edit=(Edit(name="table2", ref="Cup"),))) == (set(), set())
    called = Watched(room, in_="kitchen")
    assert called.now == set(room.names) - {"kitchen1"}


def test_in_a_place_and_near(room):
    inside = Watched(room, in_="kitchen1")
    assert inside.after(move(room, "cup1", (20.0, 0.0, 0.0))) == (set(), {"cup1"})
    grown = commit(room, edit=(Edit(name="kitchen1", size=(60.0, 12.0, 2.5)),))
    assert inside.after(grown) == ({"cup1"}, set())
    near = Watched(room, near="table1", within=0.5)
    assert near.now == {"tray1"}
    assert near.after(move(room, "table1", (19.0, 0.0, 0.0))) == ({"cup1"}, {"tray1"})


def test_a_word_may_mean_another_entity_later(room):
    on = Watched(room, on="Table")
    assert on.after(commit(room, remove=("table1",))) == (set(), {"tray1", "cup1"})
    assert on.after(commit(room, remove=("table2",))) == (set(), set())
    there = commit(room, add=(new("table3", "Table", (0.0, 0.0, 0.0), size=(1.5, 0.9, TOP)),))
    assert on.after(there) == ({"tray1", "cup1"}, set())


def test_words_that_mean_nothing_any_more_select_nothing(room):
    on = Watched(room, on="Table", in_="kitchen1", near="Table", within=5.0)
    assert on.now == {"tray1", "cup1"}
    on.after(commit(room, remove=("table1",)))
    assert on.after(commit(room, remove=("table2",))) == (set(), set())
    assert on.now == set()


def test_several_commits_are_published_with_the_last_one(room):
    on = Watched(room, on="table1")
    first = move(room, "cup1", (3.0, 0.0, TOP))
    second = move(room, "tray1", (3.0, 0.3, TOP))
    assert on.after(first) == (set(), set())
    assert on.after(second) == (set(), {"cup1", "tray1"})


def test_leases_expire(room, monkeypatch):
    on = Watched(room, on="table1", lease=10.0)
    assert on.standing.renew(Renew(watch="w1")).text == "w1 is renewed for 10 s"
    assert on.standing.renew(Renew(watch="another")) is None
    later = time.monotonic() + 11.0
    monkeypatch.setattr("semmap.nodes.kb_node.answers.location_queries.time.monotonic", lambda: later)
    on.standing.drop_expired()
    assert on.standing.renew(Renew(watch="w1")) is None
    assert [(news.rows, news.ended) for news in on.news] == [(None, True)]


def test_a_query_can_be_ended(room):
    on = Watched(room, on="table1")
    assert on.standing.renew(Renew(watch="w1", end=True)).text == "w1 has ended"
    on.news.clear()
    assert on.after(move(room, "cup1", (3.0, 0.0, TOP))) == (set(), set())


@pytest.mark.parametrize(
    ("wanted", "error", "text"),
    [
        ({"on": "tabel1"}, errors.UnknownName, "did you mean table1"),
        ({"on": "table1", "class_": "Cupp"}, errors.UnknownClass, "unknown class 'Cupp'"),
        ({"within": 1.0}, errors.BadRequest, "near NAME"),
    ],
)
def test_invalid_queries_are_rejected(room, wanted, error, text):
    with pytest.raises(error, match=text):
        Watched(room, **wanted)


def test_the_number_of_queries_is_limited(room):
    on = Watched(room, on="table1")
    with pytest.raises(errors.NameTaken):
        on.standing.watch(Watch(watch="w1", on="table1"))
    for i in range(2, 65):
        on.standing.watch(Watch(watch=f"w{i}", on="table1"))
    with pytest.raises(errors.Refused, match="64 standing queries"):
        on.standing.watch(Watch(watch="w65", on="table1"))


@pytest.mark.parametrize(
    "wanted",
    [
        {"on": "table1"},
        {"on": "Table"},
        {"in_": "kitchen1"},
        {"in_": "bowl1"},
        {"near": "tray1"},
        {"near": "Table", "within": 0.4},
        {"on": "tray1", "near": "table1"},
    ],
)
def test_published_rows_equal_those_of_a_new_query(room, wanted):
    dice = random.Random(str(wanted))
    commit(room, add=(new("bowl1", "Bowl", (0.1, 0.0, TOP + 0.02)), new("apple1", "Apple", (0.1, 0.0, 0.8))))
    watched = Watched(room, **wanted)
    where = Where(**wanted)
    things = ["table1", "table2", "tray1", "cup1", "bowl1", "apple1", "cup2", "cup3"]
    for _ in range(150):
        made = random_commit(room, dice, things)
        if made is not None:
            watched.after(made)
        asked = select_entities(room.places.space(), tuple(room.entities()), where, tuple(room.entities()))
        assert watched.now == {entity.name for entity in asked}


def random_commit(room, dice, things):
    name = dice.choice(things)
    beside = room.find(dice.choice(things))
    x, y, z = beside.pose.position_m if beside is not None else (0.0, 0.0, 0.0)
    above = dice.choice([z, z + 0.02, z + TOP, z + 0.1]) if beside is not None else 0.0
    at = (x + dice.choice([0.0, 0.1, -0.3]), y + dice.choice([0.0, 0.2]), min(above, 2.0))
    if abs(at[0]) > 20.0 or abs(at[1]) > 20.0:
        at = (0.0, 0.0, 0.0)
    if room.find(name) is None:
        return commit(room, add=(new(name, "Cup", at),))
    if name.startswith("cup") and name != "cup1" and dice.random() < 0.2:
        return commit(room, remove=(name,))
    return move(room, name, at, carry=dice.random() < 0.2)
