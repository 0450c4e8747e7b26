"""What is told of a drag, and what is not."""

from __future__ import annotations

import asyncio
import math
from types import SimpleNamespace

import pytest

from semmap.nodes.extern.web.scene.gizmo import Gizmo, arm_m
from tests.extern.web.scene.sample_scenes import pose


class Handle:
    """Stands in for viser's: where it is, and who is told of what is done with it."""

    def __init__(self, name):
        self.name = name
        self.position, self.wxyz = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
        self.is_there = True

    def on_update(self, told):
        self.told = told

    def remove(self):
        self.is_there = False

    def drag(self, phase, position=None):
        self.position = position or self.position
        asyncio.run(self.told(SimpleNamespace(phase=phase, target=self)))


@pytest.fixture
def made():
    handles, told, frame = [], [], SimpleNamespace(is_open=True)

    def add(name, **_):
        handles.append(Handle(name))
        return handles[-1]

    scene = SimpleNamespace(add_transform_controls=add)
    gizmo = Gizmo(scene, lambda phase, at: told.append((phase, at.position_m)), lambda: frame.is_open)
    return gizmo, handles, told, frame


def test_it_is_where_the_thing_is_and_upright(made):
    gizmo, handles, _, _ = made
    gizmo.put(pose(1.0, 2.0, 0.5, 0.3), (0.5, 0.5, 1.0))
    assert [handle.position for handle in handles] == [(1.0, 2.0, 0.5)] * 2
    gizmo.put(pose(3.0), (0.5, 0.5, 1.0))
    assert len(handles) == 2
    assert handles[0].position == (3.0, 0.0, 0.0)
    gizmo.remove()
    assert not any(handle.is_there for handle in handles)
    assert not gizmo.is_shown


def test_handles_that_are_shown_again_are_new_ones_to_the_browser(made):
    gizmo, handles, _, _ = made
    gizmo.put(pose(yaw_rad=math.pi), (0.5, 0.5, 1.0))
    gizmo.remove()
    gizmo.put(pose(), (0.5, 0.5, 1.0))
    names = [handle.name for handle in handles]
    assert len(set(names)) == len(names) == 4


def test_a_drag_is_told_from_its_start_to_its_end_and_both_parts_go_along(made):
    gizmo, _, told, _ = made
    gizmo.put(pose(), (0.5, 0.5, 1.0))
    level, lift = made[1]
    level.drag("start")
    level.drag("update", (1.0, 0.0, 0.0))
    assert lift.position == (1.0, 0.0, 0.0)
    level.drag("end")
    assert told == [("start", (0, 0, 0)), ("update", (1, 0, 0)), ("end", (1, 0, 0))]


def test_what_stays_where_it_was_has_its_arrows_back(made):
    gizmo, _, _, _ = made
    gizmo.put(pose(), (0.5, 0.5, 1.0))
    level, _ = made[1]
    level.drag("update", (1.0, 0.0, 0.0))
    gizmo.put(pose(), (0.5, 0.5, 1.0))
    assert level.position == (0.0, 0.0, 0.0)


def test_a_tab_that_is_closed_in_mid_drag_has_let_go_of_nothing(made):
    gizmo, _, told, frame = made
    gizmo.put(pose(), (0.5, 0.5, 1.0))
    level, _ = made[1]
    level.drag("start")
    level.drag("update", (1.0, 0.0, 0.0))
    frame.is_open = False
    level.drag("end")  # viser says so for whoever waits for an end
    assert [phase for phase, _ in told] == ["start", "update"]


def test_the_arrows_of_small_things_can_be_grasped_and_those_of_large_ones_are_not_huge():
    assert arm_m((0.02, 0.02, 0.02)) >= 0.4
    assert arm_m((9.0, 1.0, 1.0)) <= 1.5
