"""The gizmo: its pose, and what it reports of a drag."""

from __future__ import annotations

import asyncio
import math
from types import SimpleNamespace

import pytest

from semmap.nodes.extern.web.scene.gizmo import Gizmo, arm_m
from tests.extern.web.scene.sample_scenes import pose


class Handle:
    """A stub of a handle of viser, with its pose and its listener."""

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


def test_the_gizmo_is_upright_at_the_pose(made):
    gizmo, handles, _, _ = made
    gizmo.put(pose(1.0, 2.0, 0.5, 0.3), (0.5, 0.5, 1.0))
    assert [handle.position for handle in handles] == [(1.0, 2.0, 0.5)] * 2
    gizmo.put(pose(3.0), (0.5, 0.5, 1.0))
    assert len(handles) == 2
    assert handles[0].position == (3.0, 0.0, 0.0)
    gizmo.remove()
    assert not any(handle.is_there for handle in handles)
    assert not gizmo.is_shown


def test_handles_have_unique_names(made):
    gizmo, handles, _, _ = made
    gizmo.put(pose(yaw_rad=math.pi), (0.5, 0.5, 1.0))
    gizmo.remove()
    gizmo.put(pose(), (0.5, 0.5, 1.0))
    names = [handle.name for handle in handles]
    assert len(set(names)) == len(names) == 4


def test_a_drag_is_reported_from_start_to_end_and_moves_both_handles(made):
    gizmo, _, told, _ = made
    gizmo.put(pose(), (0.5, 0.5, 1.0))
    level, lift = made[1]
    level.drag("start")
    level.drag("update", (1.0, 0.0, 0.0))
    assert lift.position == (1.0, 0.0, 0.0)
    level.drag("end")
    assert told == [("start", (0, 0, 0)), ("update", (1, 0, 0)), ("end", (1, 0, 0))]


def test_the_gizmo_returns_to_an_entity_that_did_not_move(made):
    gizmo, _, _, _ = made
    gizmo.put(pose(), (0.5, 0.5, 1.0))
    level, _ = made[1]
    level.drag("update", (1.0, 0.0, 0.0))
    gizmo.put(pose(), (0.5, 0.5, 1.0))
    assert level.position == (0.0, 0.0, 0.0)


def test_closing_a_tab_during_a_drag_does_not_report_an_end(made):
    gizmo, _, told, frame = made
    gizmo.put(pose(), (0.5, 0.5, 1.0))
    level, _ = made[1]
    level.drag("start")
    level.drag("update", (1.0, 0.0, 0.0))
    frame.is_open = False
    level.drag("end")  # viser reports an end when the frame is closed
    assert [phase for phase, _ in told] == ["start", "update"]


def test_the_length_of_arrows_is_bounded():
    assert arm_m((0.02, 0.02, 0.02)) >= 0.4
    assert arm_m((9.0, 1.0, 1.0)) <= 1.5
