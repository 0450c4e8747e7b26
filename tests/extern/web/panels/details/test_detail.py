"""The details of a selected entity that changes."""

import asyncio
from types import SimpleNamespace

import pytest
from nicegui import ElementFilter, ui

from semmap.nodes.extern.web.map_state import NOW
from semmap.nodes.extern.web.panels.details import detail as detail_module
from semmap.nodes.extern.web.panels.details import detail_requests, fact_list
from semmap.nodes.extern.web.panels.details import states as states_module
from semmap.nodes.extern.web.panels.details.detail import detail
from semmap.nodes.extern.web.views.entities.facts import Fact, Facts
from tests.conftest import PATIENCE_S
from tests.extern.web.panels.tabs import in_a_tab
from tests.extern.web.views.sample_maps import thing


class MapView:
    """A stub of the state that panels share; `touch` reports changed entities."""

    knowledge = SimpleNamespace(properties={}, words=None)

    def on_entities_changed(self, function):
        self.touch = function


class Asking:
    """Requests whose replies a test controls."""

    def __init__(self):
        self.begun = []

    async def ask(self, page, knowledge, entity):
        answer = asyncio.get_running_loop().create_future()
        self.begun.append(answer)
        return await answer

    def answer(self, text):
        found = Facts((Fact(text),), (), ())
        self.begun[-1].set_result(detail_requests.Details("", found, (), "", (), ()))

    async def asked(self, times):
        async with asyncio.timeout(PATIENCE_S):
            while len(self.begun) < times:
                await asyncio.sleep(0.01)


@pytest.fixture
def view(monkeypatch):
    view = MapView()
    for module in (detail_module, states_module, fact_list):
        monkeypatch.setattr(module, "MapView", SimpleNamespace(of=lambda page: view))
    return view


@pytest.fixture
def slow(monkeypatch):
    slow = Asking()
    monkeypatch.setattr(detail_requests, "fetch_details", slow.ask)
    return slow


@pytest.fixture
def tick(monkeypatch):
    """A function that runs the shortest timer: without a browser no timer fires."""
    timers = {}
    monkeypatch.setattr(ui, "timer", lambda period_s, function: timers.update({period_s: function}))
    return lambda: timers[min(timers)]()


@pytest.fixture
def page():
    tasks = []
    state = SimpleNamespace(entities={"cup1": thing("cup1", preferred_reference="cup")})
    return SimpleNamespace(
        moment=NOW,
        selected=("cup1",),
        state=state,
        live=SimpleNamespace(classes=(), scene=None),
        is_allowed=lambda verb: False,
        on_select=lambda function: None,
        on_moment=lambda function: None,
        start_task=lambda coroutine: tasks.append(asyncio.ensure_future(coroutine)),
    )


def texts():
    return [label.text for label in ElementFilter(kind=ui.label) if label.visible]


def test_slow_replies_are_shown_and_requested_again(page, view, slow, tick):
    async def test(client):
        detail(page)
        await slow.asked(1)
        page.state.entities["cup1"] = thing("cup1", preferred_reference="green cup")
        view.touch(frozenset(["cup1"]))
        tick()
        assert "green cup" in texts()
        slow.answer("was so when it was asked")
        await slow.asked(2)
        assert "was so when it was asked" in texts()
        slow.answer("is so now")
        async with asyncio.timeout(PATIENCE_S):
            while "is so now" not in texts():
                await asyncio.sleep(0.01)
        assert len(slow.begun) == 2

    in_a_tab(test)
