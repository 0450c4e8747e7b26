"""Entities that were not observed lately are distinguished from missing ones."""

import re
import time

import pytest

from semmap.nodes.kb_node.answers.sightings import Sightings
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.schemas import errors
from semmap.schemas.commits import Edit
from semmap.schemas.entities import Pose
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
