"""The scene in a browser that draws it, in software: a click selects, and what is dragged is moved."""

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
from tests.page.conftest import START_MS, chromium_path
from tests.page.waiting import settle

_GL = (
    "--no-sandbox",
    "--no-first-run",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
_WIDTH, _HEIGHT = 640, 480
_RING, _ARROW = 0.65, 0.7
"""Where along an arm the gizmo has its ring, and where it is well held by an arrow."""
_DRAWN_S = 90.0


@pytest.fixture(scope="module")
def seeing(chromium):
    """A Chromium with WebGL; the one for other tests goes without, which is quicker."""
    browser = chromium.browser_type.launch(executable_path=chromium_path(), args=[*_GL])
    yield browser
    browser.close()


@pytest.fixture(scope="module")
def narrow(seeing):
    """A profile for tabs that are so narrow that the scene is all of the page; only the first fetches all."""
    context = seeing.new_context(viewport={"width": _WIDTH, "height": _HEIGHT})
    yield context
    context.close()


@pytest.fixture
def tab(narrow, web):
    """The page, as narrow as that."""
    page = narrow.new_page()
    complained = []
    page.on("pageerror", lambda error: complained.append(str(error)))
    page.on("console", lambda said: said.type == "error" and complained.append(said.text))
    page.goto(web.url, timeout=2 * START_MS)
    page.wait_for_selector("body.semmap-ready", timeout=2 * START_MS)
    yield page
    page.close()
    assert not complained


@pytest.fixture
def chair(system):
    """A chair of the test's own, in the middle of the living room."""
    with standing(system, (3.0, 2.2, 0.0)) as name:
        yield name


@contextlib.contextmanager
def standing(system, at, yaw=0.0):
    """A chair with a body, removed afterwards; its name."""
    name = f"chair_{uuid.uuid4().hex[:8]}"
    with system.client() as client:
        client.send(Add(class_="Chair", name=name, at=at, yaw=yaw))
        until(lambda: client.get(name).body.status == "present", "the chair has a body")
        yield name
        client.send(Remove(names=(name,)))


def looking(tab, client) -> View:
    """How the scene is seen at first."""
    frame = tab.locator("iframe").bounding_box()
    eye, target = first_view(extent(client.list()), frame["width"] / frame["height"])
    ahead = np.subtract(target, eye) / np.linalg.norm(np.subtract(target, eye))
    right = np.array((1.0, 0.0, 0.0))
    rotation = np.column_stack([right, np.cross(ahead, right), ahead])
    return View(eye, wxyz_of(rotation), FOV_RAD, frame["width"], frame["height"])


def pixel(tab, view, point):
    """Where on the page a point [m] is seen."""
    frame = tab.locator("iframe").bounding_box()
    x, y, _ = view.project(np.array([point], dtype=float))[0]
    return frame["x"] + x, frame["y"] + y


def until(condition, what: str) -> None:
    """Software takes long to draw, on a machine that does much else."""
    assert comes(condition, _DRAWN_S), f"waited {_DRAWN_S:g} s in vain: {what}"


def comes(condition, within_s: float = 2.0) -> bool:
    """Whether it becomes so, soon: what was done before the scene was drawn is done again otherwise."""
    deadline_s = time.monotonic() + within_s
    while not (result := condition()) and time.monotonic() < deadline_s:
        time.sleep(0.02)
    return bool(result)


def draw(tab, frames: int = 2) -> None:
    """Wait until the scene has been drawn so many times more: what the mouse did is taken in then."""
    scene = tab.frames[-1]
    for _ in range(frames):
        scene.evaluate("new Promise((drawn) => requestAnimationFrame(drawn))")


def selected(tab) -> str:
    return tab.get_by_role("status", name="Selected").inner_text()


def select(tab, view, entity) -> None:
    """Click at a thing until it is selected: nothing is there to be clicked before it is drawn."""
    x, y, z = entity.pose.position_m
    at = pixel(tab, view, (x, y, z + 0.45 * entity.size_m[2]))

    def click() -> bool:
        tab.mouse.click(*at)
        return comes(lambda: selected(tab) == entity.name)

    until(click, f"{entity.name} is selected")


def test_nothing_of_viser_s_own_panels_is_shown(tab):
    panel = tab.frame_locator("iframe").get_by_text("Scene tree")
    for width in (480, 900):  # it has one for phones, and one for all others
        tab.set_viewport_size({"width": width, "height": 320})
        panel.wait_for(state="attached", timeout=2 * START_MS)
        assert not panel.is_visible()


def test_a_click_selects_and_one_beside_things_selects_nothing(tab, system, chair):
    with system.client() as client:
        view, entity = looking(tab, client), client.get(chair)
        select(tab, view, entity)
        frame = tab.locator("iframe").bounding_box()

        def click_beside() -> bool:
            tab.mouse.click(frame["x"] + frame["width"] - 60, frame["y"] + 0.5 * frame["height"])
            return comes(lambda: selected(tab) == "")

        until(click_beside, "nothing is selected")


def drag_along_x(tab, view, client, name, done=None) -> None:
    """By the arrow along x, until the map follows, or else until it is `done()`.

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
        dragged(tab, view, *((x + grip + 0.2 * step, y, z) for step in range(6)))
        tab.mouse.up()
        return comes(done)

    until(drag, "the chair was dragged")


def test_what_is_dragged_with_the_mouse_is_moved_and_the_map_follows(tab, system, chair):
    with system.client() as client:
        view, entity = looking(tab, client), client.get(chair)
        select(tab, view, entity)
        drag_along_x(tab, view, client, chair)
        x, y, _ = entity.pose.position_m
        moved = client.get(chair).pose
        assert moved.position_m[0] == pytest.approx(x + 1.0, abs=0.35)
        assert moved.position_m[1] == pytest.approx(y, abs=0.05)
        assert math.isclose(moved.yaw_rad, entity.pose.yaw_rad, abs_tol=0.05)


def test_what_is_dragged_into_another_thing_goes_back_and_that_is_named(tab, system, chair):
    with standing(system, (4.0, 2.2, 0.0)) as other, system.client() as client:
        view, entity = looking(tab, client), client.get(chair)
        select(tab, view, entity)
        said = tab.get_by_text(f"{chair}: no free space, the position overlaps {other}")
        drag_along_x(tab, view, client, chair, lambda: said.count() > 0)
        until(lambda: client.get(chair).body.status == "present", "the chair stands")
        assert client.get(chair).pose.position_m == pytest.approx(entity.pose.position_m, abs=0.05)


def test_what_is_dragged_keeps_its_yaw_whatever_was_selected_before(tab, system, chair):
    with standing(system, (1.6, 2.2, 0.0), yaw=math.radians(180.0)) as turned, system.client() as client:
        view = looking(tab, client)
        select(tab, view, client.get(turned))
        settle(tab)
        draw(tab, 10)  # its handles, turned as it is
        select(tab, view, client.get(chair))
        drag_along_x(tab, view, client, chair)
        assert math.isclose(client.get(chair).pose.yaw_rad, 0.0, abs_tol=0.05)


def dragged(tab, view, *points) -> None:
    """Press at the first of these points [m], and go on to the others; the button stays pressed."""
    tab.mouse.move(*pixel(tab, view, points[0]))
    draw(tab)
    tab.mouse.down()
    for point in points[1:]:
        tab.mouse.move(*pixel(tab, view, point))
        draw(tab)


def height(client, name) -> float:
    """How high the body stands just now [m]."""
    scene = bus.ask(client.session, keys.SIM, "snapshot", SceneQuery(), Scene)
    return next(body.pose.position_m[2] for body in scene.bodies if body.name == name)


def test_a_thing_is_turned_by_the_ring(tab, system, chair):
    with system.client() as client:
        view, entity = looking(tab, client), client.get(chair)
        select(tab, view, entity)
        x, y, z = entity.pose.position_m
        radius = _RING * arm_m(entity.size_m)
        angles = [math.pi / 4.0 + 0.2 * step for step in range(6)]

        def turn() -> bool:
            dragged(tab, view, *((x + radius * math.cos(a), y + radius * math.sin(a), z) for a in angles))
            tab.mouse.up()
            return comes(lambda: abs(client.get(chair).pose.yaw_rad) > 0.5)

        until(turn, "the map says that the chair was turned")
        turned = client.get(chair).pose
        assert turned.yaw_rad == pytest.approx(1.0, abs=0.35)
        assert turned.position_m == pytest.approx(entity.pose.position_m, abs=0.06)


def test_a_thing_is_lifted_by_the_upright_arrow(tab, system, chair):
    with system.client() as client:
        view, entity = looking(tab, client), client.get(chair)
        select(tab, view, entity)
        x, y, z = entity.pose.position_m
        grip = z + _ARROW * arm_m(entity.size_m)

        def lift() -> bool:
            """It falls at once, and has hardly begun to when it is looked at first."""
            dragged(tab, view, *((x, y, grip + 0.15 * step) for step in range(6)))
            tab.mouse.up()
            return comes(lambda: height(client, chair) - z > 0.3)

        until(lift, "the chair was up in the air")
        until(lambda: height(client, chair) < 0.05, "it has come down again")


def test_a_tab_that_is_closed_in_mid_drag_has_moved_nothing(narrow, tab, web, system, chair):
    with system.client() as client:
        view, entity = looking(tab, client), client.get(chair)
        select(tab, view, entity)
        x, y, z = entity.pose.position_m
        grip = _RING * arm_m(entity.size_m)
        dragged(tab, view, *((x + grip + 0.2 * step, y, z) for step in range(6)))
        before = client.status().commit
        tab.close()
        page = narrow.new_page()
        page.goto(web.url, timeout=2 * START_MS)
        page.wait_for_selector("body.semmap-ready", timeout=2 * START_MS)
        page.close()
        assert client.get(chair).pose == entity.pose
        assert height(client, chair) == pytest.approx(z, abs=0.02)
        assert client.status().commit == before
