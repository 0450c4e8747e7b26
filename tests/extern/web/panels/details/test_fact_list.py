"""The facts of one thing: what was opened stays open while they change."""

from types import SimpleNamespace

from nicegui import ElementFilter, ui

from semmap.nodes.extern.web.map_state import NOW
from semmap.nodes.extern.web.panels.details.fact_list import FactList
from semmap.nodes.extern.web.views.entities.facts import ExplainArgs, Fact, Facts
from semmap.schemas import errors
from tests.extern.web.panels.tabs import in_a_tab, tell


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


def test_reasons_that_are_open_stay_open_and_no_button_is_drawn_anew_when_facts_come_and_go():
    async def test(client):
        shown = FactList(tab_of("table1"))
        shown.show(Facts((fact("is milk"),), (fact("is food"), fact("is old")), ()))
        why = button("Why: is food")
        await tell(why, "click")
        assert "reasons of is food" in texts()
        shown.show(Facts((fact("is milk"),), (fact("is drink"), fact("is food")), (fact("is on table1"),)))
        assert button("Why: is food") is why
        assert "reasons of is food" in texts()
        assert "is old" not in texts()
        await tell(why, "click")
        assert "reasons of is food" not in texts()

    in_a_tab(test)


def test_a_fact_shows_what_was_measured_last_without_being_drawn_anew():
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


def test_a_long_group_is_closed_at_first_and_shows_some_until_all_are_wanted():
    async def test(client):
        shown = FactList(tab_of())
        many = tuple(fact(f"is {i:02}") for i in range(50))
        shown.show(Facts((), many, ()))
        (group,) = [one for one in ElementFilter(kind=ui.expansion) if one.text.startswith("Inferred")]
        assert (group.text, group.value) == ("Inferred (50)", False)
        assert "is 39" in texts()
        assert "is 40" not in texts()
        (more,) = [one for one in ElementFilter(kind=ui.button) if one.text == "Show 10 more"]
        await tell(more, "click")
        assert "is 49" in texts()
        assert not more.visible

    in_a_tab(test)
