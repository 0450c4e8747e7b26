"""Measures the memory of an open page, in its process and in the browser, while the map changes.

    python -m benchmarks.page_memory [--minutes 60] [--every 60] [--view Check] [--rows FILE.csv]

The demo flat changes about once a second, and ends each round as it began: a cup comes, is called
something, is moved and goes. One tab of 1400 x 900 is open, with its scene out of view. Growth is the slope
of a line through what was measured after the first tenth of the time, when everything has been used once.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import itertools
import shutil
import statistics
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from playwright.sync_api import sync_playwright

from benchmarks.page import FLAGS, opened, page_of
from semmap.nodes.extern.client import Client
from semmap.nodes.extern.testing import own_system
from semmap.nodes.supervisor.ports import free_endpoint
from semmap.schemas import errors

_COLUMNS = ("minute", "commits", "process_mb", "heap_mb", "elements", "listeners")
_PERIOD_S = 1.0


def change(client: Client, ended: threading.Event) -> None:
    """Make a change about every second, in rounds that restore the map, until `ended`."""
    for number in itertools.count():
        name = f"passing{number}"
        steps: tuple[Callable[[], object], ...] = (
            partial(client.add, "Cup", name, at=(2.0, 3.0, 1.0)),
            partial(client.update, name, ref="the cup that comes and goes"),
            partial(client.update, name, at=(2.5, 3.2, 1.0)),
            partial(client.remove, name),
        )
        for step in steps:
            with contextlib.suppress(errors.SemmapError):  # a busy machine may not answer in time
                step()
            if ended.wait(_PERIOD_S):
                return


def slope(rows: list[tuple[float, ...]], column: int) -> float:
    """Return the growth per hour."""
    later = [row for row in rows if row[0] >= rows[-1][0] / 10]
    if len(later) < 2:
        return 0.0
    fitted = statistics.linear_regression([row[0] for row in later], [row[column] for row in later])
    return 60.0 * fitted.slope


def measure(minutes: float, every_s: float, view: str, file: Path | None) -> list[tuple[float, ...]]:
    """Yield rows of `_COLUMNS` at the given interval; each is printed and written to `file`."""
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    if path is None:
        sys.exit("there is no Chromium: sudo apt-get install chromium")
    endpoint, rows, ended = free_endpoint(), list[tuple[float, ...]](), threading.Event()
    with contextlib.ExitStack() as stack:
        data = stack.enter_context(tempfile.TemporaryDirectory())
        client = stack.enter_context(own_system(Path(data), "--no-record", endpoint=endpoint))
        address, process, _ = stack.enter_context(page_of(endpoint))
        driver = stack.enter_context(sync_playwright())
        browser = driver.chromium.launch(executable_path=path, args=[*FLAGS])
        stack.callback(browser.close)
        tab = opened(browser, address)[0]
        for each in ("System", "History", view):  # what has been looked at once goes on being told
            tab.get_by_role("tab", name=each).click()
            tab.wait_for_timeout(2000)
        devtools = tab.context.new_cdp_session(tab)
        devtools.send("Performance.enable")
        written = csv.writer(stack.enter_context(file.open("w", buffering=1))) if file else None
        if written:
            written.writerow(_COLUMNS)
        changing = threading.Thread(target=change, args=(client, ended))
        changing.start()
        stack.callback(changing.join)
        stack.callback(ended.set)
        began = time.monotonic()
        while (minute := (time.monotonic() - began) / 60) <= minutes:
            devtools.send("HeapProfiler.collectGarbage")
            told = {m["name"]: m["value"] for m in devtools.send("Performance.getMetrics")["metrics"]}
            row = (
                round(minute, 2),
                client.status().commit,
                round(process.memory_info().rss / 1e6, 2),
                round(told["JSHeapUsedSize"] / 1e6, 2),
                told["Nodes"],
                told["JSEventListeners"],
            )
            rows.append(row)
            print(*row, sep="\t", flush=True)
            if written:
                written.writerow(row)
            tab.wait_for_timeout(every_s * 1000)
    return rows


def main() -> None:
    """Measure and print the figures."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--every", type=float, default=60.0, help="seconds between two measurements")
    parser.add_argument("--view", default="Check", help="the tab that is shown instead of the scene")
    parser.add_argument("--rows", type=Path, help="a CSV file for the measurements")
    options = parser.parse_args()
    print(*_COLUMNS, sep="\t")
    rows = measure(options.minutes, options.every, options.view, options.rows)
    for column, what in enumerate(_COLUMNS[2:], 2):
        print(f"{what:<12} grows {slope(rows, column):8.2f} an hour")


if __name__ == "__main__":
    main()
