"""The layout of the page in a browser: keys, theme, phone, several tabs, and a lost system."""

from __future__ import annotations

import signal
import time
import uuid
from statistics import median

import pytest

from semmap.commands import Add, Remove
from semmap.nodes.extern.web.scene.switches import SWITCHES
from tests.conftest import running, until
from tests.page.conftest import serving
from tests.page.waiting import commit_of, has_commit, settle

# A click beside all controls focuses the layout, and not the body.
_PRESS_TWO_ARROWS = """
for (const init of [{key: "ArrowRight"}, {key: "ArrowUp", shiftKey: true}])
  document.querySelector(".q-layout").dispatchEvent(new KeyboardEvent("keydown", {...init, bubbles: true}));
"""


def fresh(stem: str) -> str:
    return f"{stem}_{uuid.uuid4().hex[:8]}"


def test_the_page_opens_with_the_map_and_without_the_token(tab, web, system):
    assert tab.url == f"{web.origin}/"
    with system.client() as client:
        until(lambda: commit_of(tab) == client.status().commit, "the page is at the newest commit")
    assert "scene" in tab.locator("iframe").get_attribute("title").lower()
    toolbar = tab.get_by_role("toolbar", name="Scene")
    for label in (*SWITCHES.values(), "Show all"):
        toolbar.get_by_role("button", name=label, exact=True).wait_for()


def test_two_tabs_show_a_change_by_another_client(open_tab, web, system):
    one, two = open_tab(web), open_tab(web)
    with system.client() as client:
        done = client.send(Add(class_="Cup", name=fresh("cup"), at=(2.0, 3.0, 1.0)))
    for tab in (one, two):
        has_commit(tab, done.commit)
    shown = [tab.locator(".semmap-state") for tab in (one, two)]
    until(  # not at once: the cup falls, which is one more commit
        lambda: len({state.inner_text() for state in shown}) == 1, "both tabs show the same state"
    )


def test_keys_undo_and_show_the_shortcuts(tab, system):
    name = fresh("cup")
    with system.client() as client:
        done = client.send(
            Add(class_="Cup", name=name, at=(22.0, 3.0, 0.0), wait=True)
        )  # where no other test puts one
        has_commit(tab, done.commit)
        tab.get_by_label("Filter entities by text").fill(name)
        tab.locator(f'.entity-table .ag-center-cols-container [row-id="{name}"]').click()
        tab.wait_for_selector(f".semmap-marks[data-selected='{name}']", state="attached")
        tab.evaluate("document.activeElement.blur()")  # the table has its own arrow keys
        tab.evaluate(_PRESS_TWO_ARROWS)  # in one go, however busy the machine is
        settle(tab)
        assert client.get(name).pose.position_m == pytest.approx((22.1, 3.01, 0.0), abs=1e-3)
        tab.keyboard.press("u")
        until(lambda: client.get(name).pose.position_m[0] < 22.05, "both steps are undone at once")
        tab.keyboard.press("u")
        until(lambda: name not in {e.name for e in client.list()}, "it is undone")
    tab.keyboard.press("?")
    tab.get_by_role("dialog", name="Keyboard shortcuts").get_by_text("undo the last change").wait_for()
    tab.keyboard.press("Escape")
    tab.get_by_role("dialog", name="Keyboard shortcuts").wait_for(state="detached")


def test_a_pressed_element_that_moves_is_clicked(tab):
    box = tab.get_by_role("tab", name="History").bounding_box()
    tab.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    tab.mouse.down()
    tab.evaluate("document.querySelector('.semmap-centre').style.paddingTop = '200px'")
    tab.mouse.up()
    tab.get_by_role("tabpanel", name="History").wait_for()


def test_the_page_fits_a_phone(open_tab, web):
    tab = open_tab(web, width=390, height=800)
    assert tab.evaluate("document.documentElement.scrollWidth") <= 390
    tab.get_by_role("tab", name="Scene").wait_for()
    tab.get_by_role("tab", name="Entities").wait_for(state="hidden")  # the browser has reported its width
    tab.get_by_label("Speed", exact=True).wait_for(state="hidden")
    tab.get_by_role("button", name="Speed and comparison").click()
    tab.get_by_label("Speed", exact=True).wait_for()
    assert tab.evaluate("document.documentElement.scrollWidth") <= 390
    tab.get_by_role("button", name="Show or hide the lists").click()
    tab.get_by_role("tab", name="Entities").wait_for()


def test_the_lists_and_the_details_leave_room_for_the_scene_and_can_be_resized(open_tab, web):
    tab = open_tab(web, width=1024, height=768)

    def is_wide(least: int, most: int) -> bool:
        return least <= tab.locator(".semmap-centre").bounding_box()["width"] <= most

    until(lambda: is_wide(450, 600), "the views have half of the window")
    grip = tab.get_by_role("separator", name="Width of the lists")
    box = grip.bounding_box()
    tab.mouse.move(box["x"] + 3, 400)
    tab.mouse.down()
    tab.mouse.move(box["x"] + 103, 400)
    tab.mouse.up()
    until(lambda: is_wide(350, 449), "the lists are wider")
    tab.get_by_role("separator", name="Width of the details").press("ArrowLeft")
    until(lambda: is_wide(350, 425), "the details are wider")
    grip.dblclick()
    until(lambda: is_wide(450, 600), "the lists are as wide as before")


def test_the_first_press_of_tab_offers_a_way_past_the_lists(tab):
    tab.evaluate("document.activeElement.blur()")
    tab.keyboard.press("Tab")
    tab.wait_for_function("document.activeElement.textContent === 'Skip to the views'")
    tab.keyboard.press("Enter")
    tab.wait_for_function("document.activeElement.id === 'views'")


def test_on_a_phone_check_boxes_keep_the_list_open_and_rows_close_it(open_tab, web):
    tab = open_tab(web, width=390, height=800)
    tab.get_by_role("button", name="Show or hide the lists").click()
    rows = tab.locator(".entity-table .ag-center-cols-container .ag-row")
    for index in (0, 1):
        tab.locator(f".entity-table [row-index='{index}'] input[type=checkbox]").click()
        tab.locator(f".entity-table [row-index='{index}'].ag-row-selected").first.wait_for()
    settle(tab)
    assert tab.get_by_role("button", name="Show or hide the lists", expanded=True).count() == 1
    assert tab.get_by_role("button", name="Show or hide the details", expanded=False).count() == 1
    rows.nth(2).click()
    tab.get_by_role("tab", name="Details").wait_for()


@pytest.mark.parametrize("dark", [False, True])
def test_the_theme_follows_the_browser_until_toggled(open_tab, web, dark):
    tab = open_tab(web, dark=dark)
    assert ("body--dark" in tab.locator("body").get_attribute("class")) is dark
    tab.get_by_role("button", name="Toggle dark mode").click()
    tab.wait_for_selector("body:not(.body--dark)" if dark else "body.body--dark")


@pytest.mark.long
def test_a_lost_system_is_reported_and_a_new_map_resets_the_page(chromium, open_tab, tmp_path):
    words = ("--no-record", "--no-sim")
    with running(tmp_path / "one", *words) as first:
        endpoint = first.endpoint
        with serving(endpoint) as web:
            tab = open_tab(web)
            until(lambda: "78 entities" in tab.locator(".semmap-state").inner_text(), "the flat shows")
            first.stop()
            tab.get_by_text("No response from the knowledge base").wait_for()
            with running(tmp_path / "two", "--abox", "none", *words, endpoint=endpoint):
                tab.get_by_text("the system now serves another map").wait_for()
                until(lambda: "78" not in tab.locator(".semmap-entities").inner_text(), "it is empty")
                assert not tab.locator(".semmap-away").is_visible()


def test_a_stopped_page_does_not_block_nodes(web, tab, system):
    """After SIGSTOP the page reads nothing; the system is not affected."""
    name = fresh("cup")
    web.process.send_signal(signal.SIGSTOP)
    try:
        with system.client() as client:
            took_s = []
            for i in range(60):
                began_s = time.monotonic()
                client.send(Add(class_="Cup", name=f"{name}_{i}", at=(2.0, 3.0, 1.0 + i / 10)))
                took_s.append(time.monotonic() - began_s)
            client.send(Remove(names=tuple(f"{name}_{i}" for i in range(60))))
    finally:
        web.process.send_signal(signal.SIGCONT)
    assert median(took_s) < 2.0  # a node that waits for the page takes as long for each
    with system.client() as client:
        until(lambda: commit_of(tab) == client.status().commit, "the page catches up")
