"""The scene in a browser with software rendering: selection and dragging."""

from __future__ import annotations

import contextlib
import math
import time
import uuid

import numpy as np
import pytest

from semmap.commands import Add, Remove
from semmap.nodes import bus
from semmap.nodes.extern.web.scene.camera import FOV_RAD, View, extent, first_view
from semmap.nodes.extern.web.scene.gizmo import arm_m
from semmap.nodes.extern.web.scene.sensor_overlay import wxyz_of
from semmap.schemas import keys
from semmap.schemas.scenes import Scene, SceneQuery
from tests.page.conftest import START_MS
from tests.page.waiting import settle

_WIDTH, _HEIGHT = 480, 360
_RING, _ARROW = 0.65, 0.7
"""Positions of the ring and of an arrow along an arm of the gizmo, as fractions of its length."""
_DRAWN_S = 90.0


@pytest.fixture
def tab(open_tab, web):
    """The page in a tab so narrow that it shows the scene only."""
    return open_narrow(open_tab, web)


def open_narrow(open_tab, web):
    return open_tab(web, width=_WIDTH, height=_HEIGHT, scene=True)


@pytest.fixture
def chair(system):
    """A new chair in the middle of the living room."""
    with standing(system, (3.0, 2.2, 0.0)) as name:
        yield name


@contextlib.contextmanager
def standing(system, at, yaw=0.0):
    """Add a chair with a body, yield its name, and remove it."""
    name = f"chair_{uuid.uuid4().hex[:8]}"
    with system.client() as client:
        client.send(Add(class_="Chair", name=name, at=at, yaw=yaw))
        until(lambda: client.get(name).body.status == "present", "the chair has a body")
        yield name
        client.send(Remove(names=(name,)))


def looking(tab, client) -> View:
    """Return the initial view of the scene."""
    frame = tab.locator("iframe").bounding_box()
    eye, target = first_view(extent(client.list()), frame["width"] / frame["height"])
    ahead = np.subtract(target, eye) / np.linalg.norm(np.subtract(target, eye))
    right = np.array((1.0, 0.0, 0.0))
    rotation = np.column_stack([right, np.cross(ahead, right), ahead])
    return View(eye, wxyz_of(rotation), FOV_RAD, frame["width"], frame["height"])


def pixel(tab, view, point):
    """Return the pixel on the page of a point [m]."""
    frame = tab.locator("iframe").bounding_box()
    x, y, _ = view.project(np.array([point], dtype=float))[0]
    return frame["x"] + x, frame["y"] + y


def until(condition, what: str) -> None:
    """Wait long enough for software rendering on a busy machine."""
    assert becomes_true(condition, _DRAWN_S), f"not true within {_DRAWN_S:g} s: {what}"


def becomes_true(condition, within_s: float = 2.0) -> bool:
    """Return whether a condition becomes true soon; otherwise the caller repeats its input."""
    deadline_s = time.monotonic() + within_s
    while not (result := condition()) and time.monotonic() < deadline_s:
        time.sleep(0.02)
    return bool(result)


def draw(tab, frames: int = 2) -> None:
    """Wait for a number of frames, in which the scene handles mouse input."""
    scene = tab.frames[-1]
    for _ in range(frames):
        scene.evaluate("new Promise((drawn) => requestAnimationFrame(drawn))")


def selected(tab) -> str:
    return tab.get_by_role("status", name="Selected").inner_text()


def select(tab, view, entity) -> None:
    """Click on an entity until it is selected, which needs the scene to be drawn."""
    x, y, z = entity.pose.position_m
    at = pixel(tab, view, (x, y, z + 0.45 * entity.size_m[2]))

    def click() -> bool:
        tab.mouse.click(*at)
        return becomes_true(lambda: selected(tab) == entity.name)

    until(click, f"{entity.name} is selected")


def test_panels_of_viser_are_hidden(tab):
    tab.locator("iframe.is-drawn").wait_for()  # the notice that it loads goes with it
    panel = tab.frame_locator("iframe").get_by_text("Scene tree")
    for width in (480, 900):  # it has one for phones, and one for all others
        tab.set_viewport_size({"width": width, "height": 320})
        panel.wait_for(state="attached", timeout=START_MS)
        assert not panel.is_visible()


def test_a_click_selects_and_a_click_on_the_background_deselects(tab, system, chair):
    with system.client() as client:
        view, entity = looking(tab, client), client.get(chair)
        select(tab, view, entity)
        frame = tab.locator("iframe").bounding_box()

        def click_beside() -> bool:
            tab.mouse.click(frame["x"] + frame["width"] - 60, frame["y"] + 0.5 * frame["height"])
            return becomes_true(lambda: selected(tab) == "")

        until(click_beside, "nothing is selected")


def test_a_double_click_shows_the_selection(tab, system, chair):
    frame = tab.locator("iframe").bounding_box()
    middle = frame["x"] + frame["width"] / 2, frame["y"] + frame["height"] / 2

    def clear() -> bool:
        """Press Esc, which cancels a drag first if a click has hit the handles."""
        tab.keyboard.press("Escape")
        return becomes_true(lambda: selected(tab) == "")

    def is_in_the_middle() -> bool:
        until(clear, "nothing is selected")
        tab.mouse.click(*middle)
        return becomes_true(lambda: selected(tab) == chair)

    with system.client() as client:
        view, entity = looking(tab, client), client.get(chair)
        x, y, z = entity.pose.position_m
        assert math.dist(pixel(tab, view, (x, y, z + 0.45 * entity.size_m[2])), middle) > 40.0
        select(tab, view, entity)
    twice = "new MouseEvent('dblclick', { bubbles: true })"
    tab.frames[-1].evaluate(f"document.querySelector('canvas').dispatchEvent({twice})")  # which presses f
    until(is_in_the_middle, "the chair is in the middle")


def drag_along_x(tab, view, client, name, done=None) -> None:
    """Drag by the arrow along x until the map has changed, or until `done()`.

    Before the arrow is drawn, the mouse turns the view instead.
    """
    entity = client.get(name)
    x, y, z = entity.pose.position_m
    grip = 0.6 * arm_m(entity.size_m)
    done = done or (lambda: client.get(name).pose.position_m[0] > x + 0.5)

    def drag() -> bool:
        tab.get_by_role("button", name="Show all").click()
        settle(tab)
        draw(tab)
        drag_along(tab, view, *((x + grip + 0.2 * step, y, z) for step in range(6)))
        tab.mouse.up()
        return becomes_true(done)

    until(drag, "the chair was dragged")


def test_a_dragged_entity_is_moved_in_the_map(tab, system, chair):
    with system.client() as client:
        view, entity = looking(tab, client), client.get(chair)
        select(tab, view, entity)
        drag_along_x(tab, view, client, chair)
        x, y, _ = entity.pose.position_m
        moved = client.get(chair).pose
        assert moved.position_m[0] == pytest.approx(x + 1.0, abs=0.35)
        assert moved.position_m[1] == pytest.approx(y, abs=0.05)
        assert math.isclose(moved.yaw_rad, entity.pose.yaw_rad, abs_tol=0.05)


def test_an_entity_dragged_into_another_one_returns(tab, system, chair):
    with standing(system, (4.0, 2.2, 0.0)) as other, system.client() as client:
        view, entity = looking(tab, client), client.get(chair)
        select(tab, view, entity)
        said = tab.get_by_text(f"{chair}: no free space, the position overlaps {other}")
        drag_along_x(tab, view, client, chair, lambda: said.count() > 0)
        until(lambda: client.get(chair).body.status == "present", "the chair stands")
        assert client.get(chair).pose.position_m == pytest.approx(entity.pose.position_m, abs=0.05)


@pytest.mark.long
def test_a_dragged_entity_keeps_its_yaw(tab, system, chair):
    with standing(system, (1.6, 2.2, 0.0), yaw=math.radians(180.0)) as turned, system.client() as client:
        view = looking(tab, client)
        select(tab, view, client.get(turned))
        settle(tab)
        draw(tab, 10)  # its handles, turned as it is
        select(tab, view, client.get(chair))
        drag_along_x(tab, view, client, chair)
        assert math.isclose(client.get(chair).pose.yaw_rad, 0.0, abs_tol=0.05)


def drag_along(tab, view, *points) -> None:
    """Press the mouse at the first of these points [m], and move it to the others without a release."""
    tab.mouse.move(*pixel(tab, view, points[0]))
    draw(tab)
    tab.mouse.down()
    for point in points[1:]:
        tab.mouse.move(*pixel(tab, view, point))
        draw(tab)


def height(client, name) -> float:
    """Return the current height of a body [m]."""
    scene = bus.ask(client.session, keys.SIM, "snapshot", SceneQuery(), Scene)
    return next(body.pose.position_m[2] for body in scene.bodies if body.name == name)


@pytest.mark.long
def test_the_ring_turns_an_entity(tab, system, chair):
    with system.client() as client:
        view, entity = looking(tab, client), client.get(chair)
        select(tab, view, entity)
        x, y, z = entity.pose.position_m
        radius = _RING * arm_m(entity.size_m)
        angles = [math.pi / 4.0 + 0.2 * step for step in range(6)]

        def turn() -> bool:
            drag_along(tab, view, *((x + radius * math.cos(a), y + radius * math.sin(a), z) for a in angles))
            tab.mouse.up()
            return becomes_true(lambda: abs(client.get(chair).pose.yaw_rad) > 0.5)

        until(turn, "the map says that the chair was turned")
        turned = client.get(chair).pose
        assert turned.yaw_rad == pytest.approx(1.0, abs=0.35)
        assert turned.position_m == pytest.approx(entity.pose.position_m, abs=0.06)


@pytest.mark.long
def test_the_vertical_arrow_lifts_an_entity(tab, system, chair):
    with system.client() as client:
        view, entity = looking(tab, client), client.get(chair)
        select(tab, view, entity)
        x, y, z = entity.pose.position_m
        grip = z + _ARROW * arm_m(entity.size_m)

        def lift() -> bool:
            """Return whether the chair was high after the release, when it starts to fall."""
            drag_along(tab, view, *((x, y, grip + 0.15 * step) for step in range(6)))
            tab.mouse.up()
            return becomes_true(lambda: height(client, chair) - z > 0.3)

        until(lift, "the chair was up in the air")
        until(lambda: height(client, chair) < 0.05, "it has come down again")


@pytest.mark.long
def test_closing_a_tab_during_a_drag_moves_nothing(open_tab, tab, web, system, chair):
    with system.client() as client:
        view, entity = looking(tab, client), client.get(chair)
        select(tab, view, entity)
        x, y, z = entity.pose.position_m
        grip = _RING * arm_m(entity.size_m)
        drag_along(tab, view, *((x + grip + 0.2 * step, y, z) for step in range(6)))
        before = client.status().commit
        tab.close()
        open_narrow(open_tab, web)
        assert client.get(chair).pose == entity.pose
        assert height(client, chair) == pytest.approx(z, abs=0.02)
        assert client.status().commit == before
