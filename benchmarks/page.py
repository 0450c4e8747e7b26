"""What a person at the page waits for, and what the page costs, in a headless Chromium.

    python -m benchmarks.page [--entities 5000] [--changes 50] [--minutes 0.5] [--json]

How long until the page can be used after its start, until it shows a command's effect, until a table of many
entities is there and filtered; and its memory and processor time while it is open. The scene is hidden while
effects are measured, and left out where there are many entities, for Chromium draws it in software; what it
costs while many bodies move is measured by `python -m benchmarks.page_scene`.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import psutil  # type: ignore[import-untyped]
from playwright.sync_api import Browser, Page, sync_playwright

from nodes.extern.client import Client
from nodes.extern.testing import free_endpoint, own_system

_SEMMAP = str(Path(sys.executable).with_name("semmap"))
FLAGS = ("--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking")
_SHOWN = """n => {
  const said = /commit ([0-9,]+)/.exec(document.querySelector(".semmap-state").innerText);
  return said && Number(said[1].replaceAll(",", "")) >= n;
}"""
_ROWS = ".entity-table .ag-row"
_COUNTED = "n => [...document.querySelectorAll('[role=status]')].some(e => e.innerText.includes(n))"
_WAIT_MS = 60_000


@contextlib.contextmanager
def page_of(endpoint: str) -> Iterator[tuple[str, psutil.Process, float]]:
    """The address of a page, its process, and how long that took to serve [s]."""
    environment = {**os.environ, "SEMMAP_CONNECT": endpoint}
    began = time.monotonic()
    command = [_SEMMAP, "web", "--port", "0"]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            address = process.stdout.readline().strip()
            yield address, psutil.Process(process.pid), time.monotonic() - began
        finally:
            process.send_signal(signal.SIGINT)
            process.wait(30)


def opened(browser: Browser, address: str, *, scene: bool = True) -> tuple[Page, float, float]:
    """A tab, and how long it took until it could be used: by the clock, and the browser's processor time [s].

    Without the scene its frame is empty: a browser without a graphics processor draws it for ever.
    """
    began, used_s = time.monotonic(), _used_by_children_s()
    context = browser.new_context(viewport={"width": 1400, "height": 900})
    if not scene:
        context.route("**/scene/**", lambda route: route.fulfill(body="<title>Scene</title>"))
    tab = context.new_page()
    tab.goto(address, timeout=_WAIT_MS, wait_until="commit")
    tab.wait_for_selector("body.semmap-ready", timeout=_WAIT_MS)
    tab.wait_for_selector(_ROWS, timeout=_WAIT_MS)
    return tab, time.monotonic() - began, _used_by_children_s() - used_s


def _used_by_children_s() -> float:
    """The processor time of Chromium, all its processes together [s]."""
    used_s = 0.0
    for process in psutil.Process().children(recursive=True):
        with contextlib.suppress(psutil.Error):
            if "chrom" in process.name():
                times = process.cpu_times()
                used_s += times.user + times.system
    return used_s


def effects(client: Client, tab: Page, changes: int) -> list[float]:
    """Of changes one by one: from when it was sent until the tab shows its commit [s]."""
    taken = []
    for i in range(changes):
        began = time.monotonic()
        commit = client.add("Cup", at=(2.0 + i % 10 / 10, 3.0, 1.0)).commit
        tab.wait_for_function(_SHOWN, arg=commit, polling="raf", timeout=_WAIT_MS)
        taken.append(time.monotonic() - began)
        time.sleep(0.13)  # not in step with the page, which tells ten times a second
    return taken


def cost(process: psutil.Process, seconds: float) -> tuple[float, float]:
    """The share of a core that the page's process takes, and how much its memory grows [MB]."""
    before, memory = process.cpu_times(), process.memory_info().rss
    time.sleep(seconds)
    after = process.cpu_times()
    used = after.user + after.system - before.user - before.system
    return used / seconds, (process.memory_info().rss - memory) / 1e6


def of_the_flat(browser: Browser, changes: int, minutes: float) -> dict[str, float]:
    """The demo flat with its simulator, and one tab."""
    endpoint = free_endpoint()
    with (
        tempfile.TemporaryDirectory() as data,
        own_system(Path(data), "--no-record", endpoint=endpoint) as client,
        page_of(endpoint) as (address, process, served_s),
    ):
        times = process.cpu_times()
        tab, ready_s, browser_s = opened(browser, address)
        tab.get_by_role("tab", name="Check").click()  # drawn in software, the scene takes all there is
        time.sleep(2.0)
        taken = sorted(effects(client, tab, changes))
        share, grown_mb = cost(process, minutes * 60)
        return {
            "served after start [s]": served_s,
            "processor time until served [s]": times.user + times.system,
            "tab usable after it was opened [s]": ready_s,
            "the browser's processor time for that [s]": browser_s,
            "usable after start [s]": served_s + ready_s,
            "effect of a command, p50 [ms]": 1e3 * taken[len(taken) // 2],
            "effect of a command, p95 [ms]": 1e3 * taken[math.ceil(0.95 * len(taken)) - 1],
            "share of a core with one tab": share,
            "memory [MB]": process.memory_info().rss / 1e6,
            f"memory grown in {minutes:g} min [MB]": grown_mb,
        }


def of_many(browser: Browser, entities: int) -> dict[str, float]:
    """A map of many entities, without a simulator."""
    side = math.ceil(math.sqrt(entities))
    things = [
        {"class": "Cup", "name": f"cup{i}", "at": [i % side * 0.5, i // side * 0.5, 0.0]}
        for i in range(entities)
    ]
    endpoint = free_endpoint()
    with (
        tempfile.TemporaryDirectory() as data,
        own_system(Path(data), "--no-record", "--no-sim", "--abox", "none", endpoint=endpoint) as client,
    ):
        file = Path(data, "many.json")
        file.write_text(json.dumps({"entities": things}))
        client.load(file)
        with page_of(endpoint) as (address, _, _served_s):
            began = time.monotonic()
            tab, _ready_s, browser_s = opened(browser, address, scene=False)
            tab.wait_for_function(_COUNTED, arg=f"{entities:,}", polling=50, timeout=_WAIT_MS)
            shown_s = time.monotonic() - began
            began = time.monotonic()
            tab.get_by_label("Filter entities by text").fill("cup77")
            few = "() => document.querySelectorAll('.ag-center-cols-container .ag-row').length < 20"
            tab.wait_for_function(few, polling=50, timeout=_WAIT_MS)
            return {
                f"table of {entities:,} entities there [s]": shown_s,
                f"{entities:,} entities: the browser's processor time [s]": browser_s,
                f"{entities:,} entities filtered [s]": time.monotonic() - began,
            }


def main() -> None:
    """Measure, and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--entities", type=int, default=5000, help="of the map of many; 0 leaves it out")
    parser.add_argument("--changes", type=int, default=50)
    parser.add_argument("--minutes", type=float, default=0.5, help="how long memory is watched")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    if path is None:
        sys.exit("there is no Chromium: sudo apt-get install chromium")
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=[*FLAGS])
        found: dict[str, Any] = of_the_flat(browser, options.changes, options.minutes)
        if options.entities:
            found |= of_many(browser, options.entities)
        browser.close()
    if options.json:
        print(json.dumps(found, indent=2))
        return
    for what, value in found.items():
        print(f"{what:<42} {value:10.2f}")


if __name__ == "__main__":
    main()
