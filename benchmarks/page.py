"""Latency and cost of the web page in a headless Chromium.

    python -m benchmarks.page [--entities 5000] [--changes 50] [--moves 10] [--minutes 0.25] [--json]

How long until the page can be used after its start, until it shows a command's effect and, after a drag, that
the body rests elsewhere, until a table of many entities is there and filtered; and its memory and processor
time while it is open. The scene is out of view while effects are measured, and left out where there are many
entities, for Chromium draws it in software; what it costs while many bodies move is measured by
`python -m benchmarks.page_scene`, and memory over an hour by `python -m benchmarks.page_memory`.
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
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import psutil
from playwright.sync_api import Browser, Page, sync_playwright

from benchmarks.table import Row, as_json, lines
from semmap.nodes import bus
from semmap.nodes.extern.client import Client
from semmap.nodes.extern.testing import own_system
from semmap.nodes.supervisor.ports import free_endpoint
from semmap.schemas import keys
from semmap.schemas.commits import Commit
from semmap.schemas.scenes import Poses

_SEMMAP = str(Path(sys.executable).with_name("semmap"))
FLAGS = ("--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking")
_WATCH = """() => {
  const shown = window.semmapShown = {}, state = document.querySelector(".semmap-state");
  const look = () => {
    const said = /commit ([0-9,]+)/.exec(state.querySelector(".semmap-commit").textContent);
    if (said) requestAnimationFrame(() => { shown[Number(said[1].replaceAll(",", ""))] ??= Date.now(); });
  };
  new MutationObserver(look).observe(state, { subtree: true, childList: true, characterData: true });
  look();
}"""
_IS_SHOWN = "n => Object.keys(semmapShown).some(key => Number(key) >= n)"
_SHOWN_AT = """n => Math.min(...Object.entries(semmapShown)
  .filter(([key]) => Number(key) >= n).map(([, when]) => when))"""
_WATCH_START = """new MutationObserver((_, observer) => {
  if (!document.querySelector(".semmap-ready .entity-table .ag-row")) return;
  observer.disconnect();
  requestAnimationFrame(() => setTimeout(() => { window.semmapUsableAt = Date.now(); }));
}).observe(document, { subtree: true, childList: true, attributeFilter: ["class"] });"""
_COUNTED = "n => [...document.querySelectorAll('[role=status]')].some(e => e.innerText.includes(n))"
_WAIT_MS = 60_000


@contextlib.contextmanager
def page_of(endpoint: str) -> Iterator[tuple[str, psutil.Process, float]]:
    """Start a page; yield its address, process and start-up time [s]."""
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
    """Open a tab; return it with the time until it was usable (by its clock) and the browser's CPU time [s].

    It is usable when the browser has painted the first rows of its table. A query from outside returns
    later, because it waits until the scene is prepared. Without `scene` its frame is empty, as a browser
    without a graphics processor would draw it permanently.
    """
    context = browser.new_context(viewport={"width": 1400, "height": 900})
    if not scene:
        context.route("**/scene/**", lambda route: route.fulfill(body="<title>Scene</title>"))
    tab = context.new_page()
    tab.add_init_script(_WATCH_START)
    began_s, used_s = time.time(), _used_by_children_s()
    tab.goto(address, timeout=_WAIT_MS, wait_until="commit")
    tab.wait_for_function("window.semmapUsableAt", polling=50, timeout=_WAIT_MS)
    usable_s = float(tab.evaluate("semmapUsableAt")) / 1e3 - began_s
    return tab, usable_s, _used_by_children_s() - used_s


def _used_by_children_s() -> float:
    """Return the CPU time of all processes of Chromium [s]."""
    used_s = 0.0
    for process in psutil.Process().children(recursive=True):
        with contextlib.suppress(psutil.Error):
            if "chrom" in process.name():
                times = process.cpu_times()
                used_s += times.user + times.system
    return used_s


class Shown:
    """The times at which a tab showed each commit, reported by the tab, by this machine's clock."""

    def __init__(self, tab: Page) -> None:
        self._tab = tab
        tab.evaluate(_WATCH)

    def since(self, commit: int, began_s: float) -> float:
        """Return the time from `began_s` until this or a later commit was visible [s]."""
        self._tab.wait_for_function(_IS_SHOWN, arg=commit, polling=50, timeout=_WAIT_MS)
        return float(self._tab.evaluate(_SHOWN_AT, commit)) / 1e3 - began_s


def effects(client: Client, shown: Shown, changes: int) -> list[float]:
    """Measure single changes from sending until the tab shows the commit [s]."""
    taken = []
    for i in range(changes):
        began_s = time.time()
        commit = client.add("Cup", at=(2.0 + i % 10 / 10, 3.0, 1.0)).commit
        taken.append(shown.since(commit or 0, began_s))
        time.sleep(0.13)  # not in step with the page, which tells ten times a second
    return taken


class Rest:
    """The time at which the simulator reported a body at rest, and the following commit of the scene."""

    def __init__(self, client: Client, name: str) -> None:
        self._name = name
        self._is_moving = False
        self._rested = threading.Event()
        self._followed = threading.Event()
        self._rested_s, self._commit = 0.0, 0
        self._following = (
            bus.follow(client.session, keys.POSES, self._on_poses),
            bus.follow(client.session, keys.COMMIT, self._on_commit),
        )

    def begin(self) -> None:
        """Start waiting until the body has moved and is at rest."""
        self._is_moving = False
        self._rested.clear()
        self._followed.clear()

    def wait(self) -> tuple[float, int]:
        """Return the time at which it was at rest [s], and the commit."""
        if not (self._rested.wait(_WAIT_MS / 1e3) and self._followed.wait(_WAIT_MS / 1e3)):
            raise RuntimeError(f"{self._name} has not come to rest, or the map has not followed")
        return self._rested_s, self._commit

    def _on_poses(self, _: str, poses: Poses) -> None:
        if self._name not in poses.names or self._rested.is_set():
            return
        rests = poses.resting[poses.names.index(self._name)]
        if self._is_moving and rests:
            self._rested_s = time.time()
            self._rested.set()
        self._is_moving = self._is_moving or not rests

    def _on_commit(self, _: str, commit: Commit) -> None:
        if commit.source == "scene" and any(entity.name == self._name for entity in commit.changed):
            self._commit = commit.seq
            self._followed.set()


def drags(client: Client, shown: Shown, moves: int) -> list[float]:
    """Measure moves like those of a drag, from the body at rest until the tab shows the commit [s]."""
    name, taken = "dragged", []
    client.add("Chair", name, at=(3.0, 2.2, 0.0), wait=True)
    rest = Rest(client, name)
    time.sleep(1.0)
    for i in range(moves):
        rest.begin()
        client.move(name, at=(3.0 + 0.4 * ((i + 1) % 2), 2.2, 0.3), carry=True, wait=False)
        rested_s, commit = rest.wait()
        taken.append(shown.since(commit, rested_s))
        time.sleep(0.37)
    return taken


def percentile(values: list[float], share: float) -> float:
    """Return the quantile of a share."""
    return sorted(values)[math.ceil(share * len(values)) - 1]


def _used_s(times: Any) -> float:
    return float(times.user + times.system)


def cost(process: psutil.Process, seconds: float) -> tuple[float, float]:
    """Measure the page's share of a core, and the growth of its memory [MB]."""
    before, memory = process.cpu_times(), process.memory_info().rss
    time.sleep(seconds)
    after = process.cpu_times()
    return (_used_s(after) - _used_s(before)) / seconds, (process.memory_info().rss - memory) / 1e6


def of_the_flat(browser: Browser, changes: int, moves: int, minutes: float) -> list[Row]:
    """Measure the demo flat with its simulator and one tab."""
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
        shown, before = Shown(tab), process.cpu_times()
        taken = effects(client, shown, changes)
        used_s = _used_s(process.cpu_times()) - _used_s(before)
        dragged = drags(client, shown, moves)
        share, grown_mb = cost(process, minutes * 60)
        return [
            Row("served after start", served_s, "s"),
            Row("processor time until served", _used_s(times), "s"),
            Row("tab usable after it was opened", ready_s, "s"),
            Row("the browser's processor time for that", browser_s, "s"),
            Row("usable after start", served_s + ready_s, "s", reach=3.0),
            Row("effect of a command, p50", 1e3 * percentile(taken, 0.5), "ms"),
            Row(f"effect of a command, p95 of {changes}", 1e3 * percentile(taken, 0.95), "ms", reach=200.0),
            Row("processor time of the page's process for a command", 1e3 * used_s / changes, "ms"),
            Row("commit of a drag after the body rests, p50", 1e3 * percentile(dragged, 0.5), "ms"),
            Row(f"commit of a drag, the latest of {moves}", 1e3 * max(dragged), "ms", reach=500.0),
            Row("share of a core with one tab", share, ""),
            Row("memory", process.memory_info().rss / 1e6, "MB"),
            Row(f"memory grown in {minutes:g} min", grown_mb, "MB"),
        ]


def of_many(browser: Browser, entities: int) -> list[Row]:
    """Measure a map of many entities without a simulator."""
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
            return [
                Row(f"table of {entities:,} entities there", shown_s, "s"),
                Row(f"{entities:,} entities: the browser's processor time", browser_s, "s"),
                Row(f"{entities:,} entities filtered", time.monotonic() - began, "s"),
            ]


def main() -> None:
    """Measure and print the figures."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--entities", type=int, default=5000, help="size of the large map; 0 skips it")
    parser.add_argument("--changes", type=int, default=50)
    parser.add_argument("--moves", type=int, default=10)
    parser.add_argument("--minutes", type=float, default=0.25, help="duration of the memory measurement")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    if path is None:
        sys.exit("there is no Chromium: sudo apt-get install chromium")
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=[*FLAGS])
        rows = of_the_flat(browser, options.changes, options.moves, options.minutes)
        if options.entities:
            rows += of_many(browser, options.entities)
        browser.close()
    print(json.dumps([as_json(row) for row in rows], indent=2) if options.json else lines(rows))


if __name__ == "__main__":
    main()
