from types import SimpleNamespace

import pytest

from semmap.nodes.extern.mcp import permissions
from semmap.nodes.extern.mcp.limits import Limits
from semmap.nodes.extern.mcp.permissions import Permissions, find_outside
from semmap.schemas import errors
from semmap.schemas.entities import Pose
from semmap.schemas.plans import Plan, PlannedPlace, PlannedThing


def place(name, x, y, width, depth):
    corners = ((x, y), (x + width, y), (x + width, y + depth), (x, y + depth))
    return PlannedPlace(name=name, label=name, class_="Kitchen", rings=(corners,), floor=0.0, height=2.5)


KITCHEN, HALL = place("kitchen1", 0.0, 0.0, 4.0, 3.0), place("hall1", 4.1, 0.0, 2.0, 3.0)
BATH = place("bath1", 6.5, 0.0, 2.0, 3.0)
DOOR = PlannedThing(
    name="door1",
    label="door1",
    class_="Door",
    parts=(),
    footprint=((6.05, 1.0), (6.55, 1.0), (6.55, 2.0), (6.05, 2.0)),
    door=True,
    connects=("hall1", "bath1"),
)
PLAN = Plan(places=(KITCHEN, HALL, BATH), things=(DOOR,))


@pytest.mark.parametrize(
    ("path", "permitted", "is_outside"),
    [
        (((1.0, 1.0), (3.0, 2.0)), {"kitchen1"}, False),
        (((1.0, 1.0), (5.0, 2.0)), {"kitchen1"}, True),
        (((1.0, 1.0), (5.0, 2.0)), {"kitchen1", "hall1"}, False),
        (((1.0, 1.0), (3.0, 4.0), (1.0, 2.0)), {"kitchen1"}, True),
        (((3.9, 2.9), (3.9, 3.5)), {"kitchen1"}, True),
        (((3.5, 1.0),), {"hall1"}, True),
        (((1.0, 1.0),), set(), True),
        (((5.0, 1.5), (7.0, 1.5)), {"hall1", "bath1"}, False),
        (((5.0, 1.5), (7.0, 1.5)), {"hall1"}, True),
        (((5.0, 1.5), (6.4, 1.5)), {"hall1"}, True),
        (((5.0, 2.5), (7.0, 2.5)), {"hall1", "bath1"}, True),
    ],
)
def test_a_path_within_places(path, permitted, is_outside):
    """Rooms are 0.1 m and 0.4 m apart; only a door leads through the thick wall."""
    assert (find_outside(path, PLAN, permitted) is not None) == is_outside


def test_each_path_through_the_gap_between_two_rooms_is_permitted():
    for step in range(100):
        assert find_outside(((1.0 + step / 97, 1.0), (5.0, 2.0)), PLAN, {"kitchen1", "hall1"}) is None


def test_the_first_point_outside_is_returned():
    x, y = find_outside(((3.0, 1.0), (5.0, 1.0)), PLAN, {"kitchen1"})
    assert 4.1 <= x <= 4.3
    assert y == pytest.approx(1.0)


def a_client(list=tuple, displaced=()):
    """A client of a map with the three rooms; `displaced` are the reports on bodies that move."""
    return SimpleNamespace(
        list=list,
        classes=tuple,
        floorplan=lambda: PLAN,
        send=lambda command: SimpleNamespace(displaced=displaced),
    )


def test_the_rooms_of_a_permitted_storey_are_permitted(monkeypatch):
    where = {"kitchen1": {"in": ["storey1"]}, "hall1": {"in": ["storey1"]}, "bath1": {"in": ["storey2"]}}
    monkeypatch.setattr(
        permissions.queries, "placed", lambda client, entities: where | {"r1": where["hall1"]}
    )
    storeys = [SimpleNamespace(name=name, place=True) for name in ("storey1", "storey2", *where)]
    client = a_client(list=lambda: storeys)
    robot = SimpleNamespace(name="r1", types=("Robot",), pose=Pose(position_m=(5.0, 1.0, 0.0)), live=None)
    own = Permissions(Limits(places=frozenset({"storey1"})))
    own.require_action(client, robot, ((1.0, 1.0),))
    with pytest.raises(errors.Refused, match=r"leads through .*: storey1"):
        own.require_action(client, robot, ((7.0, 1.5),))


def test_the_path_of_a_driving_robot_begins_at_its_live_pose(monkeypatch):
    monkeypatch.setattr(permissions.queries, "placed", lambda client, entities: {"r1": {"in": ["kitchen1"]}})
    client = a_client()
    committed, live = Pose(position_m=(1.0, 1.0, 0.0)), Pose(position_m=(5.0, 2.0, 0.0))
    robot = SimpleNamespace(name="r1", types=("Robot",), pose=committed, live=SimpleNamespace(pose=live))
    own = Permissions(Limits(places=frozenset({"kitchen1"})))
    monkeypatch.setattr(own, "resolve", lambda client: Limits(places=frozenset({"kitchen1"})))
    with pytest.raises(errors.Refused, match=r"leads through \(5.00, 2.00\)"):
        own.require_action(client, robot, ((2.0, 2.0),))


def test_a_path_of_a_robot_that_moves_without_a_live_pose_is_not_checked_yet(monkeypatch):
    monkeypatch.setattr(permissions.queries, "placed", lambda client, entities: {"r1": {"in": ["kitchen1"]}})
    robot = SimpleNamespace(name="r1", types=("Robot",), pose=Pose(position_m=(1.0, 1.0, 0.0)), live=None)
    own = Permissions(Limits(places=frozenset({"kitchen1"})))
    monkeypatch.setattr(own, "resolve", lambda client: Limits(places=frozenset({"kitchen1"})))
    own.require_action(a_client(), robot, ((2.0, 2.0),))
    with pytest.raises(errors.Busy, match="r1 is moving"):
        own.require_action(a_client(displaced=("r1 is moving: 1.2 m away",)), robot, ((2.0, 2.0),))
