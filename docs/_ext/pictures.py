"""Renders the screenshots of the page, the plan and the movie of the manual (`make pictures`).

The script starts a system in a temporary folder, changes the map step by step, and takes screenshots with
Chromium; then it renders the movie. Needs Debian's chromium and the extras; arguments select some of
`page.png page-time.png page-why.png plan.svg tour.mp4`.
"""

from __future__ import annotations

import contextlib
import io
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from PIL import Image, ImageStat
from playwright.sync_api import Page, sync_playwright

from semmap.nodes.extern.client import Client, connect
from semmap.nodes.extern.plan.floor import floor_of
from semmap.nodes.extern.plan.svg import drawing
from semmap.nodes.supervisor.ports import free_endpoint
from semmap.schemas import commands
from semmap.schemas.commands import Command
from semmap.schemas.entities import orientation_from_yaw

DOCS = Path(__file__).parents[1]
SEMMAP = Path(sys.executable).parent / "semmap"
ARGUMENTS = (
    *("--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync"),
    *("--disable-background-networking", "--disable-component-update"),
)
SIZE = {"width": 1440, "height": 900}
START_S = 90.0
_BLANK = 12.0
"""An empty scene has less contrast."""
BETWEEN_S = 0.5
"""The time between two steps of the story, in which bodies come to rest [s]."""


def _put(name: str, x: float, y: float, z: float, reason: str, yaw: float | None = None) -> Command[Any]:
    turned = None if yaw is None else orientation_from_yaw(yaw)
    return commands.Update(name=name, at=(x, y, z), orientation=turned, reason=reason)


STORY: tuple[tuple[str, Command[Any]], ...] = (
    ("robot", _put("chair2", 9.35, 2.5, 0.0, "pull out a chair", 3.1416)),
    ("robot", _put("milk1", 8.35, 2.2, 0.75, "milk on the table")),
    ("robot", _put("bread1", 7.95, 2.15, 0.75, "bread on the table")),
    ("anna", commands.Add(class_="Cup", name="mug1", at=(8.5, 2.2, 0.75), ref="mug", reason="a mug, too")),
    ("anna", _put("person1", 9.3, 1.9, 0.0, "Anna comes to breakfast", 1.9)),
    ("robot", commands.Remove(names=("keys1",), reason="the keys are not where they were")),
    ("anna", commands.Undo(reason="they are, below the newspaper")),
    ("robot", _put("armchair1", 1.3, 1.5, 0.0, "make room in the corner", 0.3)),
    ("robot", _put("plant1", 0.5, 0.5, 0.0, "the plant gets more light")),
    ("robot", _put("chair1", 3.6, 2.2, 0.0, "a chair for the living room", 1.57)),
    ("anna", _put("book1", 3.95, 0.62, 0.43, "something to read")),
    ("anna", _put("remote_control1", 2.35, 3.3, 0.5, "beside the television")),
    ("robot", commands.Add(class_="Book", name="book4", at=(8.1, 6.0, 0.0), reason="found on the floor")),
    ("robot", _put("book4", 6.6, 6.75, 1.25, "back on the shelf")),
    ("robot", _put("chair5", 8.6, 6.6, 0.0, "from the desk", 2.0)),
    ("robot", _put("laptop1", 8.2, 2.75, 0.75, "the laptop to the kitchen", 0.0)),
    ("anna", _put("smartphone1", 3.9, 0.4, 0.43, "it rings")),
    ("robot", commands.Remove(names=("apple1",), reason="eaten")),
    ("robot", _put("plate1", 9.35, 0.3, 0.9, "a plate to the sink")),
    ("robot", _put("plate2", 9.35, 0.35, 0.95, "and the other")),
    ("robot", _put("chair2", 9.05, 2.5, 0.0, "the chair back to the table", 3.1416)),
    ("anna", _put("person1", 7.6, 6.0, 0.0, "Anna goes to work", 0.8)),
)
"""The agents and their commands, in the shipped flat."""


@contextlib.contextmanager
def system() -> Iterator[tuple[str, Path]]:
    """Start a system, and yield its endpoint and its data folder."""
    folder, endpoint = Path(tempfile.mkdtemp(prefix="semmap-pictures-")), free_endpoint()
    command = [SEMMAP, "up", "--data", str(folder), "--listen", endpoint, "--no-record"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    try:
        if not any(line.startswith("stop ") for line in process.stdout):
            raise SystemExit("the system did not start")
        yield endpoint, folder
    finally:
        process.send_signal(2)
        process.communicate(timeout=START_S)
        shutil.rmtree(folder, ignore_errors=True)


@contextlib.contextmanager
def browser(endpoint: str) -> Iterator[Page]:
    """Yield the page of a system in Chromium when it is completely drawn."""
    command = [SEMMAP, "web", "--port", "0", "--connect", endpoint]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process, sync_playwright() as driver:
        assert process.stdout is not None
        try:
            url = process.stdout.readline().strip()
            path = os.environ.get("SEMMAP_CHROMIUM") or shutil.which("chromium")
            chromium = driver.chromium.launch(executable_path=path, args=[*ARGUMENTS])
            tab = chromium.new_page(viewport=SIZE, color_scheme="light")
            tab.set_default_timeout(START_S * 1000)
            tab.goto(url)
            tab.wait_for_selector("body.semmap-ready")
            wait_until_drawn(tab, 8.0)
            yield tab
            chromium.close()
        finally:
            process.send_signal(2)


def wait_until_drawn(tab: Page, seconds: float) -> None:
    """Wait until the scene is drawn, which is slow without a graphics card, and the page is connected."""
    tab.mouse.move(SIZE["width"] / 2, SIZE["height"] - 2)
    tab.wait_for_timeout(seconds * 1000)
    deadline_s = time.monotonic() + START_S
    while time.monotonic() < deadline_s:
        frame = Image.open(io.BytesIO(tab.locator("iframe").screenshot())).convert("L")
        if ImageStat.Stat(frame).stddev[0] > _BLANK:
            break
        tab.wait_for_timeout(1000)
    tab.get_by_text("Connection lost").wait_for(state="hidden")


def run_story(client: Client) -> None:
    """Send the commands of the story."""
    for agent, command in STORY:
        Client(client.session, agent=agent).send(command)
        time.sleep(BETWEEN_S)


def select(tab: Page, name: str) -> None:
    """Select an entity in the table."""
    tab.get_by_label("Filter entities by text").fill(name)
    tab.locator(f'.entity-table [row-id="{name}"] [col-id="name"]').first.click()
    tab.locator(".q-drawer--right").get_by_text(f"{name} ·").first.wait_for()
    wait_until_drawn(tab, 4.0)


def page_png(tab: Page, client: Client) -> None:
    """Take a screenshot of the page with a selected entity."""
    select(tab, "mug1")
    tab.screenshot(path=DOCS / "page.png")


def page_why_png(tab: Page, client: Client) -> None:
    """Take a screenshot of an explanation with its steps."""
    select(tab, "counter1")
    tab.get_by_label("Filter entities by text").fill("")
    why = tab.get_by_role("button", name="Why: is a laden thing")
    why.click()
    why.evaluate("button => button.scrollIntoView()")
    wait_until_drawn(tab, 3.0)
    tab.screenshot(path=DOCS / "page-why.png")


def page_time_png(tab: Page, client: Client) -> None:
    """Take a screenshot of the past, with the differences from the current map."""
    tab.get_by_label("Filter entities by text").fill("")
    tab.get_by_label("Compare with").click()
    tab.get_by_role("option", name="now", exact=True).click()
    (seq,) = [commit.seq for commit in client.history() if commit.reason == "a mug, too"]
    field = tab.get_by_label("Go to commit or time")
    field.fill(str(seq))
    field.press("Enter")
    tab.get_by_text(f"Past: commit {seq} of ").wait_for()
    wait_until_drawn(tab, 8.0)
    tab.screenshot(path=DOCS / "page-time.png")
    tab.keyboard.press("Home")


def plan_svg(tab: Page, client: Client) -> None:
    """Render the plan of the flat."""
    status, entities = client.status(), client.list()
    now = client.history(limit=1)[0]
    floor = floor_of(entities, plan=client.send(commands.PlanFloor()))
    (DOCS / "plan.svg").write_text(
        drawing(floor, title="The flat", commit=status.commit, stamp_ns=now.stamp_ns)
    )


DRAWN: dict[str, Callable[[Page, Client], None]] = {
    "page.png": page_png,
    "page-why.png": page_why_png,
    "page-time.png": page_time_png,
    "plan.svg": plan_svg,
}
MOVIE = "tour.mp4"


def main(wanted: list[str]) -> None:
    """Render the selected files; all without arguments."""
    if unknown := {*wanted} - {*DRAWN, MOVIE}:
        raise SystemExit(
            f"no such picture: {', '.join(sorted(unknown))}; there are {', '.join(DRAWN)}, {MOVIE}"
        )
    chosen = wanted or [*DRAWN, MOVIE]
    with system() as (endpoint, folder), connect(endpoint, agent="maker") as client:
        run_story(client)
        if {*chosen} & {*DRAWN}:
            with browser(endpoint) as tab:
                for name in chosen:
                    if name in DRAWN:
                        DRAWN[name](tab, client)
                        print(DOCS / name)
        if MOVIE in chosen:
            film = [SEMMAP, "movie", str(DOCS / MOVIE), "--data", str(folder), "--overwrite"]
            rhythm = ["--speed", "0.2", "--longest", "2.4", "--size", "960", "640", "--fps", "20"]
            subprocess.run([*film, *rhythm], check=True)


if __name__ == "__main__":
    main(sys.argv[1:])
