"""The list of facts: opened parts stay open when facts change."""

from types import SimpleNamespace

from nicegui import ElementFilter, ui

from semmap.nodes.extern.web.map_state import NOW
from semmap.nodes.extern.web.panels.details.fact_list import FactList
from semmap.nodes.extern.web.views.entities.facts import ExplainArgs, Fact, Facts
from semmap.schemas import errors
from tests.extern.web.panels.tabs import in_a_tab, send_event


def fact(text, measured="", other=""):
    return Fact(text, ExplainArgs("milk1", "type", text), other=other, measured=measured)


class Live:
    async def ask(self, command, timeout_s=10.0):
        raise errors.Refused(f"reasons of {command.value}")


def tab_of(*names):
    state = SimpleNamespace(entities=dict.fromkeys(names))
    return SimpleNamespace(moment=NOW, is_allowed=lambda verb: True, state=state, live=Live())


def button(label):
    (found,) = [one for one in ElementFilter(kind=ui.button) if one.props.get("aria-label") == label]
    return found


def texts():
    return [label.text for label in ElementFilter(kind=ui.label) if label.visible]


def test_open_explanations_stay_open_when_facts_change():
    async def test(client):
        shown = FactList(tab_of("table1"))
        shown.show(Facts((fact("is milk"),), (fact("is food"), fact("is old")), ()))
        why = button("Why: is food")
        await send_event(why, "click")
        assert "reasons of is food" in texts()
        shown.show(Facts((fact("is milk"),), (fact("is drink"), fact("is food")), (fact("is on table1"),)))
        assert button("Why: is food") is why
        assert "reasons of is food" in texts()
        assert "is old" not in texts()
        await send_event(why, "click")
        assert "reasons of is food" not in texts()

    in_a_tab(test)


def test_measurements_are_updated_without_redrawing():
    async def test(client):
        page = tab_of()
        shown = FactList(page)
        shown.show(Facts((), (), (fact("is near table1", "they are 2 cm apart", "table1"),)))
        why, select = button("Why: is near table1"), button("Select table1")
        assert not select.visible
        page.state.entities["table1"] = None
        shown.show(Facts((), (), (fact("is near table1", "they are 3 cm apart", "table1"),)))
        assert "they are 3 cm apart" in texts()
        assert "they are 2 cm apart" not in texts()
        assert button("Why: is near table1") is why
        assert select.visible

    in_a_tab(test)


def test_long_groups_are_closed_at_first_and_show_more_on_request():
    async def test(client):
        shown = FactList(tab_of())
        many = tuple(fact(f"is {i:02}") for i in range(50))
        shown.show(Facts((), many, ()))
        (group,) = [one for one in ElementFilter(kind=ui.expansion) if one.text.startswith("Inferred")]
        assert (group.text, group.value) == ("Inferred (50)", False)
        assert "is 39" in texts()
        assert "is 40" not in texts()
        (more,) = [one for one in ElementFilter(kind=ui.button) if one.text == "Show 10 more"]
        await send_event(more, "click")
        assert "is 49" in texts()
        assert not more.visible

    in_a_tab(test)
