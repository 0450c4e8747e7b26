"""A running system, its page, and Chromium, shared by all tests of a process for speed.

Tests therefore use unique names, and do not depend on the number of commits or entities.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import re
import select
import shutil
import subprocess
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from tests.conftest import _BIN, PATIENCE_S, System, _await_end, running

_ARGUMENTS = (
    *("--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync"),
    *("--disable-background-networking", "--disable-component-update", "--disable-default-apps"),
    *("--enable-unsafe-swiftshader", "--webgl-antialiasing-mode=none"),  # the scene is rendered in software
)
_NAMES = ("chromium", "chromium-browser", "google-chrome")
_HARMLESS = re.compile("net::ERR_CONNECTION")
START_MS = 60_000


def chromium_path() -> str | None:
    """Return the path of Chromium; None if it is not installed."""
    return os.environ.get("SEMMAP_CHROMIUM") or next(filter(None, map(shutil.which, _NAMES)), None)


class Web:
    """A running `semmap web`."""

    def __init__(self, url: str, process: subprocess.Popen[str]) -> None:
        self.url = url
        """The address with its token, as it was printed."""
        self.process = process

    @property
    def origin(self) -> str:
        """`http://host:port`."""
        parts = urlsplit(self.url)
        return f"{parts.scheme}://{parts.netloc}"

    @property
    def port(self) -> int:
        return int(urlsplit(self.url).port or 0)


@contextlib.contextmanager
def serving(endpoint: str, *words: str) -> Iterator[Web]:
    """Run `semmap web` for the system at `endpoint` on a free port, and end it with Ctrl-C."""
    command: list[str | Path] = [_BIN / "semmap", "web", "--port", "0", *words]
    environment = {**os.environ, "SEMMAP_CONNECT": endpoint}
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            assert select.select([process.stdout], [], [], START_MS / 1000)[0], "the page is not ready"
            line = process.stdout.readline()
            assert line.startswith("http"), line
            threading.Thread(target=process.stdout.read, daemon=True).start()
            yield Web(line.strip(), process)
        finally:
            process.send_signal(2)
            _await_end(process)


_TABS = pytest.StashKey[list[Any]]()
"""The tabs that a test has opened."""
_LOOP: list[Any] = [None]
"""Playwright's event loop.

It counts as running in this thread for as long as Playwright lives. Tests of other folders in the same
process need their own event loops.
"""


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Set Playwright's loop as running during tests of this folder, including their fixtures."""
    if Path(__file__).parent not in item.path.parents:  # xdist calls this of all tests
        return (yield)
    with _in_its_loop():
        return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Iterator[None]:
    """Add what each open tab shows to the report of a test that fails."""
    report = yield
    if report.when == "call" and report.failed:
        for number, tab in enumerate(item.stash.get(_TABS, ())):
            with contextlib.suppress(Exception):  # the tab, or its browser, may be what failed
                report.sections.append((f"tab {number}", tab.locator("body").aria_snapshot(timeout=START_MS)))
    return report


@contextlib.contextmanager
def _in_its_loop() -> Iterator[None]:
    if _LOOP[0] is not None:  # otherwise Playwright has just started, or not yet
        asyncio._set_running_loop(_LOOP[0])
    try:
        yield
    finally:
        _LOOP[0] = asyncio._get_running_loop()
        asyncio._set_running_loop(None)


@pytest.fixture(scope="package")
def chromium():
    """Debian's Chromium, headless."""
    playwright = pytest.importorskip("playwright.sync_api", reason="Playwright for Python is not installed")
    if (path := chromium_path()) is None:
        pytest.skip("there is no Chromium: sudo apt-get install chromium")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=[*_ARGUMENTS])
        yield browser
        asyncio._set_running_loop(_LOOP[0])
        browser.close()


@pytest.fixture(scope="package")
def system(tmp_path_factory) -> Iterator[System]:
    """The demo flat with its simulator, without a recorder."""
    with running(Path(tmp_path_factory.mktemp("page")), "--no-record") as system:
        yield system


@pytest.fixture(scope="package")
def web(system) -> Iterator[Web]:
    """The page of `system`."""
    with serving(system.endpoint) as web:
        yield web


class Tabs:
    """The tabs of a browser context, which tests use one after the other.

    A test loads the page again. In a tab that has loaded it before, the scripts are already compiled. This
    takes 0.7 s of processor time instead of 1.9 s.
    """

    def __init__(self, context: Any) -> None:
        self._context = context
        self._idle: list[Any] = []

    def take(self) -> Any:
        """Return a tab that no test uses."""
        return self._idle.pop() if self._idle else self._context.new_page()

    def give_back(self, tab: Any) -> None:
        """Empty a tab for another test; one that the test has closed is dropped."""
        if not tab.is_closed():
            tab.goto("about:blank")
            self._idle.append(tab)


@pytest.fixture(scope="package")
def tabs(chromium):
    """A function that returns the tabs with or without the scene."""
    found: dict[bool, Tabs] = {}

    def of(scene: bool) -> Tabs:
        if scene not in found:
            context = chromium.new_context()
            context.set_default_timeout(PATIENCE_S * 1000)
            if not scene:  # a route would also do, but it turns the cache off
                context.add_init_script("if (location.pathname.startsWith('/scene/')) window.stop()")
            found[scene] = Tabs(context)
        return found[scene]

    return of


@pytest.fixture
def open_tab(tabs, request):
    """A function that opens the page in a tab: `open_tab(web)`, `open_tab(web, width=390)`.

    It draws the scene only with `scene=True`, because software rendering blocks the thread of the page. At
    the end it is checked that no tab has sent a request to another machine or reported an error.
    """
    asked, complained = [], []
    taken = contextlib.ExitStack()
    used = request.node.stash[_TABS] = []
    listeners = {
        "request": lambda sent: asked.append(sent.url),
        "websocket": lambda socket: asked.append(socket.url),
        "pageerror": lambda error: complained.append(str(error)),
        "console": lambda said: said.type == "error" and complained.append(said.text),
    }

    def open_(web: Web, *, width: int = 1280, height: int = 800, dark: bool = False, scene: bool = False):
        tab = tabs(scene).take()
        tab.bring_to_front()  # the browser draws another tab once a second only
        used.append(tab)
        taken.callback(tabs(scene).give_back, tab)
        for event, listener in listeners.items():
            tab.on(event, listener)
            taken.callback(tab.remove_listener, event, listener)
        tab.set_viewport_size({"width": width, "height": height})
        tab.emulate_media(color_scheme="dark" if dark else "light")
        tab.goto(web.url, timeout=START_MS)
        tab.wait_for_selector("body.semmap-ready", timeout=START_MS)
        return tab

    with taken:
        yield open_
    elsewhere = [url for url in asked if urlsplit(url).hostname not in ("127.0.0.1", None)]
    assert not elsewhere, elsewhere
    amiss = [text for text in complained if not _HARMLESS.search(text)]
    assert not amiss, amiss


@pytest.fixture
def tab(open_tab, web):
    """The page in a tab of the size of a laptop screen."""
    return open_tab(web)
