"""The task that sends the steps of the arrow keys, with a stub of the tab."""

import asyncio
from types import SimpleNamespace

import pytest

from semmap.nodes.extern.web import keyboard_moves
from semmap.nodes.extern.web.keyboard_moves import KeyboardMoves
from semmap.nodes.extern.web.live import LiveEvent
from semmap.schemas.replies import Changed
from tests.extern.web.views.sample_maps import by_name, thing


class Tab:
    """A stub whose map has a change when `commit` is called, after the reply."""

    viewpoint = None

    def __init__(self):
        self.live = SimpleNamespace(map_id="m", commit=1, listen=self._listen)
        self.live.entities = by_name(thing("a"), thing("b"))
        self.client = SimpleNamespace(on_delete=lambda _: None)
        self.selected = ("a",)
        self.sent, self.notices, self.shown = [], [], {}
        self.rejects = False
        self.on_event = self.close = self.task = self.discard_pending = None
        self._keys = {}

    def _listen(self, listener):
        self.on_event = listener

    def on_key(self, key, function):
        self._keys[key] = function

    def on_select(self, function):
        self.close = function

    def is_allowed(self, _):
        return True

    def preview(self, poses):
        self.shown = {name: pose.position_m[0] for name, pose in poses.items()}

    def notify(self, text, _):
        self.notices.append(text)

    def start_task(self, coroutine):
        self.task = asyncio.ensure_future(coroutine)

    async def change(self, command):
        self.sent.append({update.name: update.at[0] for update in command.changes})
        await asyncio.sleep(0)
        return None if self.rejects else Changed(commit=1 + len(self.sent), text="moved")

    def press(self, key="ArrowRight"):
        self._keys[key]()

    def select(self, *names):
        self.selected = names
        self.close()

    def commit(self):
        for name, x in self.sent[-1].items():
            self.live.entities[name] = thing(name, at=(x, 0.0, 0.0))
        self.live.commit += 1


async def settled():
    for _ in range(20):
        await asyncio.sleep(0)


@pytest.fixture
def run(monkeypatch):
    for name in ("_QUIET_S", "_POSE_DELAY_S", "PERIOD_S"):
        monkeypatch.setattr(keyboard_moves, name, 0.0)

    def run(scenario):
        async def inside():
            tab = Tab()
            moves = KeyboardMoves(tab)
            await scenario(tab)
            await asyncio.wait_for(tab.task, 10.0)
            assert not moves._is_sending
            assert tab.shown == {}

        asyncio.run(inside())

    return run


def test_keys_pressed_while_a_change_is_sent_begin_where_it_ends(run):
    async def scenario(tab):
        tab.press()
        tab.press()
        await settled()
        tab.press()  # the map does not have the change yet
        await settled()
        assert tab.sent == [{"a": 0.2}]
        assert tab.shown == {"a": pytest.approx(0.3)}
        tab.commit()
        await settled()
        assert tab.sent == [{"a": 0.2}, {"a": 0.3}]
        tab.commit()

    run(scenario)


def test_another_selection_sends_the_steps_of_the_one_before(run):
    async def scenario(tab):
        tab.press()
        tab.select("b")
        tab.press("ArrowLeft")
        assert tab.shown == {"a": pytest.approx(0.1), "b": pytest.approx(-0.1)}
        await settled()
        tab.commit()
        await settled()
        assert tab.sent == [{"a": 0.1}, {"b": -0.1}]
        tab.commit()

    run(scenario)


def test_a_rejected_change_does_not_stop_the_next_one(run):
    async def scenario(tab):
        tab.rejects = True
        tab.press()
        await settled()
        assert tab.shown == {}
        tab.rejects = False
        tab.press()
        await settled()
        assert tab.sent == [{"a": 0.1}, {"a": 0.1}]
        tab.live.commit = 3

    run(scenario)


def test_entities_without_a_position_are_reported(run):
    async def scenario(tab):
        tab.live.entities["a"] = thing("a", at=None)
        tab.press()
        await settled()
        assert tab.sent == []
        assert tab.notices == ["none of the selected entities has a position"]

    run(scenario)


def test_steps_are_not_sent_to_another_map(run):
    async def scenario(tab):
        tab.press()
        await settled()
        tab.press()
        tab.live.map_id, tab.live.commit = "another", 0
        tab.on_event(LiveEvent(kind="reset", is_new_map=True))
        await settled()
        assert tab.sent == [{"a": 0.1}]

    run(scenario)


def test_undo_discards_steps_that_were_not_sent(run):
    async def scenario(tab):
        tab.press()
        assert await tab.discard_pending()
        assert tab.shown == {}
        await settled()
        assert tab.sent == []

    run(scenario)


def test_undo_waits_for_the_change_that_is_being_sent(run):
    async def scenario(tab):
        tab.press()
        await settled()
        tab.press()
        assert await tab.discard_pending()  # the second step, not the first
        waiting = asyncio.ensure_future(tab.discard_pending())
        await settled()
        assert not waiting.done()
        tab.commit()
        assert not await waiting
        assert tab.sent == [{"a": 0.1}]

    run(scenario)
