"""The panel of a class, with a stub of the system."""

import asyncio
from functools import partial

from nicegui import ElementFilter, ui

from semmap.nodes.extern.web.live import LiveEvent
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels import ontology
from semmap.nodes.extern.web.panels.widgets.redraw import LazyRedraw
from semmap.schemas import errors
from semmap.schemas.commands import Add, Properties
from semmap.schemas.sparql import SparqlResult
from tests.extern.web.panels.tabs import in_a_tab
from tests.extern.web.views.sample_maps import class_, commit


class Live:
    """A stub that rejects entities of the class Cup because of the map."""

    map_id, commit, scene, identity = "m", 1, None, None

    def __init__(self):
        self.classes = (class_("Cup"), class_("Mug"))
        self.entities = self.poses = {}
        self.tried = []
        self._listeners = []

    def listen(self, listener):
        self._listeners.append(listener)
        return lambda: None

    def happen(self, kind, *commits):
        for listener in self._listeners:
            listener(LiveEvent(kind=kind, commits=commits))

    def is_allowed(self, _):
        return True

    async def ask(self, command, timeout_s=10.0):
        if isinstance(command, Properties):
            return ()
        if isinstance(command, Add):
            self.tried.append(command.class_)
            if command.class_ == "Cup":
                raise errors.Inconsistent("cup1 is too small")
        return SparqlResult(kind="select", rows=(), seq=1)


async def settled():
    for _ in range(30):
        await asyncio.sleep(0)


def texts():
    return [label.text for label in ElementFilter(kind=ui.label)]


def test_the_map_may_change_without_another_dry_run(monkeypatch):
    monkeypatch.setattr(ontology, "LazyRedraw", partial(LazyRedraw, pause_s=0.0))

    async def test(client):
        live = Live()
        page = Page(live, client)
        ontology.ontology(page)
        (choice,) = ElementFilter(kind=ui.select)
        choice.value = "Cup"
        await settled()
        reason = "An entity of this class cannot be added to this map (as of commit 1): cup1 is too small"
        assert reason in texts()
        live.happen("commit", commit(2))
        await settled()
        assert live.tried == ["Cup"]
        choice.value = "Mug"
        await settled()
        assert reason not in texts()
        assert live.tried == ["Cup", "Mug"]
        live.classes = (class_("Mug"), class_("Pan"))
        live.happen("reset")
        await settled()
        assert (list(choice.options), choice.value) == (["Mug", "Pan"], "Mug")
        assert live.tried == ["Cup", "Mug", "Mug"]
        live.classes = (class_("Pan"),)
        live.happen("reset")
        await settled()
        assert (list(choice.options), choice.value) == (["Pan"], None)

    in_a_tab(test)
