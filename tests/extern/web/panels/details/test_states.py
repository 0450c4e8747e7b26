"""The fields for states: values being entered stay when others change."""

from types import SimpleNamespace

import pytest
from nicegui import ElementFilter, ui

from semmap.nodes.extern.web.map_state import NOW
from semmap.nodes.extern.web.panels.details import states as states_module
from semmap.nodes.extern.web.panels.details.states import States
from semmap.schemas.entities import PropertyInfo
from tests.extern.web.panels.tabs import in_a_tab, send_event
from tests.extern.web.views.sample_maps import thing


def known(name, kind, range_, **fields):
    fields = {"domain": (), "functional": True, "comment": "", "values": {}, "labels": {}, **fields}
    return PropertyInfo(
        name=name, iri=f"urn:{name}", kind=kind, range=(range_,), datatypes=(range_,), **fields
    )


PROPERTIES = {
    "mass": known("mass", "data", "float"),
    "isBroken": known("isBroken", "data", "boolean"),
}


class Live:
    def __init__(self, entity):
        self.entities = {entity.name: entity}


@pytest.fixture
def page(monkeypatch):
    knowledge = SimpleNamespace(properties=PROPERTIES)
    monkeypatch.setattr(
        states_module, "MapView", SimpleNamespace(of=lambda page: SimpleNamespace(knowledge=knowledge))
    )
    changes = []

    async def change(command):
        changes.append(command)

    live = Live(thing("cup1"))
    return SimpleNamespace(
        moment=NOW, is_allowed=lambda verb: True, state=live, live=live, change=change, changes=changes
    )


def now(page, **properties):
    page.live.entities["cup1"] = entity = thing("cup1", properties=properties)
    return entity


def field(kind):
    (found,) = ElementFilter(kind=kind)
    return found


def test_a_number_being_entered_stays_when_another_state_changes(page):
    async def test(client):
        shown = States(page, now(page))
        mass, broken = field(ui.number), field(ui.toggle)
        await send_event(mass, "update:modelValue", 0.25)
        shown.show(now(page, isBroken=True, mass=0.1))
        assert (field(ui.number), field(ui.toggle)) == (mass, broken)
        assert (mass.value, broken.value) == (0.25, "True")
        await send_event(mass, "blur")
        assert [(c.property, c.values) for c in page.changes] == [("mass", (0.25,))]

    in_a_tab(test)


def test_values_set_by_others_are_shown_and_not_sent(page):
    async def test(client):
        shown = States(page, now(page, mass=0.1))
        shown.show(now(page, mass=0.2, isBroken=False))
        assert (field(ui.number).value, field(ui.toggle).value) == (0.2, "False")
        await send_event(field(ui.number), "blur")
        assert page.changes == []

    in_a_tab(test)
