"""Entities that were not observed lately are distinguished from missing ones."""

import re
import time

import pytest

from semmap.nodes.kb_node.answers.sightings import Sightings, describe_closed, find_closed_container
from semmap.nodes.kb_node.handlers.queries import QueryHandlers
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import LastSeen
from semmap.schemas.commits import Edit, NewEntity, Statement, Transaction
from semmap.schemas.entities import Live, Pose
from semmap.schemas.live import LivePoses
from semmap.schemas.perception import MISSING, Observation, Observations
from tests.kb_node import home
from tests.kb_node.home import chair, transaction


@pytest.fixture
def semantic_map(tmp_path):
    """Commits: 1 two chairs by ann, 2 chair1 is missing, 3 another change of chair1, 4 and 5 removals."""
    made = home.new_map(tmp_path)
    eyes = {"source": "perception", "agent": "camera"}
    for step in (
        transaction(1, [*chair(), *chair("chair2"), *chair("chair3"), *chair("chair4")], agent="ann"),
        transaction(2, edit=(Edit(name="chair1", conflict=MISSING),), **eyes),
        transaction(3, edit=(Edit(name="chair1", ref="throne"),), agent="ann"),
        transaction(4, (), chair("chair2"), reason="chair2 is gone: its place was empty in 10 looks", **eyes),
        transaction(5, (), chair("chair3"), reason="tidy", agent="ann"),
    ):
        made.commit(step)
    yield made
    home.close(made)


@pytest.fixture
def sightings(semantic_map):
    return Sightings(HistoryReader(semantic_map._journal))


def look(name, stamp_ns):
    one = Observation(
        class_="Chair",
        probability=0.9,
        pose=Pose(position_m=(1, 2, 0)),
        size_m=(1, 1, 1),
        points=9,
        entity=name,
    )
    return Observations(stamp_ns=stamp_ns, views=(), observations=(one,))


def test_an_entity_marked_as_missing_is_reported_with_the_time_of_the_mark(sightings, semantic_map):
    entity = semantic_map.entity("chair1")
    assert sightings.is_missing(entity)
    told = sightings.describe_removed("chair1", entity)
    assert (told.gone.commit, told.removed, told.provenance.commit) == (2, None, 1)
    assert re.fullmatch(r"reported missing at commit 2, \d+ s ago: not seen where it should stand", told.text)


def test_a_removal_by_perception_is_reported_as_missing_and_one_by_a_client_is_not(sightings):
    seen, tidied = sightings.describe_removed("chair2", None), sightings.describe_removed("chair3", None)
    assert seen.gone == seen.removed
    assert seen.text.endswith("ago: chair2 is gone: its place was empty in 10 looks")
    assert (tidied.gone, tidied.removed.commit) == (None, 5)
    assert re.fullmatch(r"removed at commit 5, \d+ s ago by operator/ann", tidied.text)
    with pytest.raises(errors.UnknownName):
        sightings.describe_removed("chair9", None)


def test_a_present_entity_is_in_view_or_was_not_seen_since(sightings, semantic_map):
    entity = semantic_map.entity("chair4")
    assert not sightings.is_missing(entity)
    assert re.fullmatch(
        r"placed by operator/ann at commit 1, \d+ s ago; not seen since, not reported missing",
        sightings.describe_present(entity).text,
    )
    sightings.record(look("chair4", entity.pose_provenance.stamp_ns - 1))
    assert sightings.describe_present(entity).seen_ns is None  # before it was moved there
    now_ns = time.time_ns()
    sightings.record(look("chair4", now_ns))
    told = sightings.describe_present(entity)
    assert (told.seen_ns, told.text) == (now_ns, "in view of a camera now")


def test_an_old_observation_is_not_reported_as_current(sightings, semantic_map, monkeypatch):
    entity = semantic_map.entity("chair4")
    sightings.record(look("chair4", time.time_ns()))
    later_ns = time.time_ns() + 180 * 10**9
    monkeypatch.setattr("time.time_ns", lambda: later_ns)
    assert (
        sightings.describe_present(entity).text
        == "last in view 3 min ago; not seen since, not reported missing"
    )


@pytest.fixture
def kitchen(tmp_path):
    """Milk in a fridge, and a cup on the floor next to it."""
    made = SemanticMap(home.new_household_journal(tmp_path))
    at = {"fridge1": (0.0, 0.0, 0.0), "carton1": (-0.1, 0.0, 0.645), "cup1": (2.0, 0.0, 0.0)}
    classes = {"fridge1": "Fridge", "carton1": "Milk", "cup1": "Cup"}
    new = tuple(
        NewEntity(name=name, class_iri=v.bare(v.dm(classes[name])), pose=Pose(position_m=at[name]))
        for name in at
    )
    made.commit(Transaction(id="1", source="operator", add=new))
    yield made
    home.close(made)


def say(kitchen, number, value, property_="isOpen", name="fridge1"):
    edit = Edit(name=name, set=(Statement(property=property_, values=(value,)),))
    kitchen.commit(Transaction(id=str(number), source="operator", edit=(edit,)))


def test_a_fridge_without_a_stated_door_state_is_not_reported_as_closed(kitchen):
    assert find_closed_container(kitchen, kitchen.entity("carton1")) is None


def test_milk_in_a_closed_fridge_is_not_observable_since_it_was_closed(kitchen):
    say(kitchen, 2, "false")
    closed = find_closed_container(kitchen, kitchen.entity("carton1"))
    assert closed is not None
    said = r"not observable: fridge1 has been closed since commit 2, \d+ s ago"
    assert re.fullmatch(said, describe_closed(closed))
    assert find_closed_container(kitchen, kitchen.entity("cup1")) is None
    assert find_closed_container(kitchen, kitchen.entity("fridge1")) is None


@pytest.mark.parametrize(("x", "is_inside"), [(-0.1, True), (-0.09, True), (3.0, False)])
def test_a_tracked_carton_is_not_observable_while_it_is_live_in_a_closed_fridge(kitchen, x, is_inside):
    say(kitchen, 2, "false")
    kitchen.commit(transaction(3, edit=(Edit(name="carton1", tracked="sim"),)))
    queries = QueryHandlers(kitchen, kitchen._journal, sparql=None, location_queries=None)
    live = Live(pose=Pose(position_m=(x, 0.0, 0.645)), stamp_ns=1, age_s=0.0, source="sim")
    queries.on_live_poses(LivePoses(stamp_ns=1, entities={"carton1": live}))
    text = queries.past.on_last_seen(LastSeen(name="carton1")).text
    assert text.startswith(f"live now at ({x:.2f}, 0.00, 0.65) m" if is_inside else "live now at (3.00")
    assert ("not observable: fridge1 has been closed" in text) == is_inside
    queries.close()


def test_it_is_observable_once_the_fridge_is_open(kitchen):
    say(kitchen, 2, "false")
    say(kitchen, 3, "true")
    assert find_closed_container(kitchen, kitchen.entity("carton1")) is None


def test_an_open_door_shows_only_what_is_behind_it(kitchen):
    milk = kitchen.entity("carton1")
    edit = Edit(
        name="fridge1",
        set=(
            Statement(property="isOpen", values=("true",)),
            Statement(property="jointPositions", values=("door=0 freezer=1.5",)),
        ),
    )
    kitchen.commit(Transaction(id="2", source="scene", edit=(edit,)))
    assert find_closed_container(kitchen, milk) == (kitchen.entity("fridge1"), ("door",))
    edit = Edit(name="fridge1", set=(Statement(property="jointPositions", values=("door=1 freezer=0",)),))
    kitchen.commit(Transaction(id="3", source="scene", edit=(edit,)))
    assert find_closed_container(kitchen, milk) is None


def test_only_the_contents_of_an_open_drawer_of_a_chest_are_observable(tmp_path):
    made = SemanticMap(home.new_household_journal(tmp_path))
    at = {"chest1": (0.0, 0.0, 0.0), "apple1": (0.05, 0.0, 0.72), "apple2": (0.05, 0.0, 0.51)}
    classes = {"chest1": "Drawer", "apple1": "Apple", "apple2": "Apple"}
    new = tuple(
        NewEntity(name=name, class_iri=v.bare(v.dm(classes[name])), pose=Pose(position_m=at[name]))
        for name in at
    )
    made.commit(Transaction(id="1", source="operator", add=new))
    edits = (
        Edit(
            name="chest1",
            set=(
                Statement(property="isOpen", values=("true",)),
                Statement(property="jointPositions", values=("drawer_1=0.24 drawer_2=0",)),
            ),
        ),
        Edit(name="apple1", at=(0.29, 0.0, 0.72)),
    )
    made.commit(Transaction(id="2", source="scene", edit=edits))
    try:
        assert find_closed_container(made, made.entity("apple1")) is None
        closed = find_closed_container(made, made.entity("apple2"))
        assert closed == (made.entity("chest1"), ("drawer_2",))
        assert "not observable: drawer_2 of chest1 is closed (last stated in commit 2" in describe_closed(
            closed
        )
        say(made, 3, "false", name="chest1")
        made.commit(Transaction(id="4", source="scene", edit=(Edit(name="apple1", at=(0.05, 0.0, 0.72)),)))
        assert find_closed_container(made, made.entity("apple1")) == (made.entity("chest1"), ())
    finally:
        home.close(made)


def test_a_sink_in_the_top_of_a_closed_counter_and_its_contents_are_observable(tmp_path):
    made = SemanticMap(home.new_household_journal(tmp_path))
    at = {"counter1": (0.0, 0.0, 0.0), "sink1": (0.0, 0.0, 0.47), "potato1": (0.0, 0.0, 0.82)}
    classes = {"counter1": "Counter", "sink1": "Sink", "potato1": "Potato"}
    new = tuple(
        NewEntity(
            name=name,
            class_iri=v.bare(v.dm(classes[name])),
            pose=Pose(position_m=at[name]),
            size=(0.45, 0.5, 0.5) if name == "sink1" else None,
        )
        for name in at
    )
    made.commit(Transaction(id="1", source="operator", add=new))
    try:
        say(made, 2, "false", name="counter1")
        inside = {
            (v.entity_name(s), v.entity_name(o))
            for s, _, o in made.reasoner.given(None, v.dm("isInside"), None)
        }
        assert inside == {("sink1", "counter1"), ("potato1", "sink1")}
        assert find_closed_container(made, made.entity("sink1")) is None
        assert find_closed_container(made, made.entity("potato1")) is None
    finally:
        home.close(made)
