"""Where an entity was last seen by its live poses."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.answers.past import live_sightings
from semmap.nodes.kb_node.answers.past.trails import Trails
from semmap.nodes.kb_node.storage.trail_file import TrailLine
from semmap.schemas.entities import Pose, Provenance, orientation_from_yaw
from semmap.schemas.replies import Sighting
from tests.kb_node.answers.past.recording import BEGIN, S

FACING = orientation_from_yaw(1.0)
PLACED = Sighting(
    name="r1",
    pose=Pose(position_m=(0.0, 0.0, 0.0), orientation_wxyz=FACING),
    provenance=Provenance(commit=3, stamp_ns=BEGIN - S, source="operator", agent="", reason="add r1"),
    removed=None,
    text="placed",
)
AT = TrailLine(BEGIN, "at", "r1", (3.0, 0.0, 0.0), ("kitchen1",))


@pytest.mark.parametrize(
    ("lines", "when", "seen_s"),
    [
        ([AT, TrailLine(BEGIN + 10 * S, "end", "r1")], "60 s ago", 10),
        ([AT, TrailLine(BEGIN + 5 * S, "on")], "65 s ago", 5),
        ([AT, TrailLine(BEGIN + 69 * S, "on")], "now", 70),
    ],
    ids=["ended", "killed", "continues"],
)
def test_the_last_stored_pose_replaces_an_older_commit(lines, when, seen_s):
    now_ns = BEGIN + 70 * S
    found = live_sightings.set_last_pose(PLACED, Trails(lines, now_ns), now_ns)
    assert found.text == f"live {when} at (3.00, 0.00, 0.00) m in kitchen1"
    assert found.seen_ns == BEGIN + seen_s * S
    assert found.pose == Pose(position_m=(3.0, 0.0, 0.0), orientation_wxyz=FACING)


@pytest.mark.parametrize("lines", [[], [TrailLine(BEGIN - 9 * S, "at", "r1", (3.0, 0.0, 0.0))]])
def test_a_newer_commit_remains(lines):
    assert live_sightings.set_last_pose(PLACED, Trails(lines, BEGIN + 70 * S), BEGIN + 70 * S) == PLACED
