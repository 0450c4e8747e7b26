import pytest
from msgspec import structs

from semmap.nodes.extern.web.views.entities.robot_state import (
    LiveAge,
    Speed,
    can_drive,
    describe_drive,
    describe_end,
    ended_goals,
    is_shown,
)
from semmap.schemas.entities import Live, Pose
from semmap.schemas.scenes import Body
from tests.extern.web.views.sample_maps import thing

HERE = Pose(position_m=(1.0, 1.0, 0.0))
LIVE = Live(pose=HERE, stamp_ns=1, age_s=0.2, source="stream")
CUP = thing("cup1", at=(1.0, 2.0, 0.75))
BODY = Body(
    name="robot1", class_="Robot", model="", pose=HERE, size_m=(0.5, 0.5, 1.0), fixed=False, entity=True,
    ghost=False, resting=True, commit=1, shape_commit=1,
)  # fmt: skip


@pytest.mark.parametrize(
    ("tracked", "body", "shown"),
    [
        ("", None, False),
        ("", BODY, False),
        ("stream", None, True),
        ("", structs.replace(BODY, robot=True), True),
        ("", structs.replace(BODY, robot=True, part_of="robot1"), False),
    ],
)
def test_tracked_entities_and_robots_have_a_panel(tracked, body, shown):
    assert is_shown(structs.replace(CUP, tracked=tracked), body) is shown
    assert can_drive(body) is (shown and body is not None)


def test_the_speed_is_the_mean_over_a_second_and_ends_with_the_poses():
    speed = Speed()
    assert speed.mean_m_s(5.0) == 0.0
    for step in range(21):
        speed.add(0.1 * step, (0.04 * step, 0.0, 0.0))
    assert speed.mean_m_s(2.05) == pytest.approx(0.4)
    assert speed.mean_m_s(3.5) == 0.0
    speed.add(10.0, (0.0, 0.0, 0.0))
    assert speed.mean_m_s(10.1) == 0.0
    speed.add(9.0, (0.0, 0.0, 0.0))  # the clock was set back
    speed.add(9.5, (1.0, 0.0, 0.0))
    assert speed.mean_m_s(9.5) == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("path", "text"),
    [
        (((1.0, 4.0),), "Drives to (1.00, 4.00): 3.0 m left"),
        (((1.0, 3.0), (3.0, 3.0)), "Drives to (3.00, 3.00) through 1 point: 4.0 m left"),
    ],
)
def test_a_drive_has_its_goal_and_the_rest_of_its_way(path, text):
    assert describe_drive(path, HERE) == text


@pytest.mark.parametrize(
    ("goal", "pose", "text"),
    [
        ((1.0, 1.05), HERE, "Arrived at (1.00, 1.05)"),
        ((1.0, 3.5), HERE, "Stopped 2.5 m before its goal (1.00, 3.50)"),
        ((1.0, 3.5), None, "No longer drives to (1.00, 3.50)"),
    ],
)
def test_a_drive_ends_at_its_goal_or_before(goal, pose, text):
    assert describe_end(goal, pose) == text


@pytest.mark.parametrize(
    ("tracked", "heard", "now_s", "text"),
    [
        ("", [], 0.0, "Not tracked: the committed pose is shown"),
        ("sim", [], 0.0, "No live pose received from the simulator"),
        ("sim", [(LIVE, 1.0)], 1.3, "Live pose from the simulator, 0.5 s ago"),
        (
            "stream",
            [(LIVE, 1.0), (None, 3.0)],
            12.8,
            "Stale: last live pose from a stream 12 s ago; the committed pose is used",
        ),
        (
            "stream",
            [(structs.replace(LIVE, stale=True, age_s=300.0), 1.0)],
            1.5,
            "Stale: last live pose from a stream 5 min ago; the committed pose is used",
        ),
        (
            "stream",
            [(LIVE, 1.0)],
            10.8,
            "Stale: last live pose from a stream 10 s ago; the committed pose is used",
        ),
    ],
)
def test_a_live_pose_has_an_age_or_is_stale(tracked, heard, now_s, text):
    age = LiveAge()
    for live, at_s in heard:
        age.add(live, at_s)
    assert age.describe(structs.replace(CUP, tracked=tracked), now_s) == text


def test_a_drive_that_is_gone_has_ended():
    path = ((1.0, 0.0), (2.0, 0.0))
    assert ended_goals({"robot1": path, "robot2": path}, {"robot2": path[1:]}) == {"robot1": (2.0, 0.0)}
    assert ended_goals({}, {"robot1": path}) == {}
