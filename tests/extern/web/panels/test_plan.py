"""When the plan is requested."""

import asyncio

import pytest

from semmap.nodes.extern.web.panels import plan as panel
from semmap.nodes.extern.web.panels.plan import PlanRequests
from semmap.schemas import errors
from semmap.schemas.plans import Plan

PLAN = Plan(places=(), things=())


class Coordinator:
    """A stub that answers when `reply` is called, or immediately if there is a `result`."""

    def __init__(self, result=None):
        self.asked = []
        self._result = result
        self._future = None

    async def ask(self, commit):
        self.asked.append(commit)
        if self._result is None:
            self._future = asyncio.get_running_loop().create_future()
            return await self._future
        return self._result

    async def reply(self, result):
        if isinstance(result, Exception):
            self._future.set_exception(result)
        else:
            self._future.set_result(result)
        for _ in range(5):
            await asyncio.sleep(0)


@pytest.fixture(autouse=True)
def no_patience(monkeypatch):
    monkeypatch.setattr(panel, "_PATIENCE_S", 0.01)


def requests_to(coordinator, late):
    return PlanRequests(coordinator.ask, asyncio.ensure_future, lambda: late.append(len(coordinator.asked)))


@pytest.mark.parametrize(
    ("zoom", "steps", "next_"), [(1.0, 1, 1.5), (1.0, -1, 1.0), (8.0, 1, 8.0), (3.0, -1, 2.0)]
)
def test_the_plan_zooms_in_steps(zoom, steps, next_):
    assert panel.next_zoom(zoom, steps) == next_


def test_a_plan_is_requested_once_for_the_same_content(monkeypatch):
    monkeypatch.setattr(panel, "_PATIENCE_S", 10.0)
    coordinator, late = Coordinator(PLAN), []

    async def draw():
        requests = requests_to(coordinator, late)
        return [await requests.at(None, content) for content in (1, 1, 1, 2)]

    assert asyncio.run(draw()) == [PLAN] * 4
    assert coordinator.asked == [None, None]
    assert not late


def test_a_drawing_does_not_wait_for_a_late_plan_and_is_repeated_with_it():
    coordinator, late = Coordinator(), []

    async def draw():
        requests = requests_to(coordinator, late)
        assert await requests.at(3, "a") is None
        assert await requests.at(3, "a") is None
        assert not late
        await coordinator.reply(PLAN)
        assert late == [1]
        assert await requests.at(3, "a") == PLAN

    asyncio.run(draw())
    assert coordinator.asked == [3]


def test_without_a_reply_there_is_one_open_request_and_none_again_until_the_content_changes():
    coordinator, late = Coordinator(), []

    async def draw():
        requests = requests_to(coordinator, late)
        for content in ("a", "b", "c"):
            assert await requests.at(None, content) is None
        assert len(coordinator.asked) == 1
        await coordinator.reply(errors.NoAnswer("no response"))
        assert late == [1], "the content has changed since the request"
        assert await requests.at(None, "c") is None
        await coordinator.reply(errors.NoAnswer("no response"))
        assert late == [1], "it would be repeated without end"
        assert len(coordinator.asked) == 2

    asyncio.run(draw())
