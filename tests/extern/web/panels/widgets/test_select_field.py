"""A select field identifies the chosen option by its label, not by its index."""

import pytest

from semmap.nodes.extern.web.panels.widgets.select_field import SelectField
from tests.extern.web.panels.tabs import in_a_tab, send_event

TOLD = "update:modelValue"


@pytest.mark.parametrize("several", [False, True])
def test_an_option_with_a_new_index_is_selected_by_its_label(several):
    async def test(client):
        choice = SelectField({"cup1": "cup1", "cup3": "cup3"}, multiple=several)
        seen = {"value": 1, "label": "cup3"}
        choice.set_options({"cup1": "cup1", "cup2": "cup2", "cup3": "cup3"})
        await send_event(choice, TOLD, [seen] if several else seen)
        assert choice.value == (["cup3"] if several else "cup3")

    in_a_tab(test)


def test_a_removed_option_is_not_selected():
    async def test(client):
        choice = SelectField({"cup1": "cup1", "cup2": "cup2"}, value="cup1")
        choice.set_options({"cup1": "cup1", "cup3": "cup3"})
        await send_event(choice, TOLD, {"value": 1, "label": "cup2"})
        assert choice.value is None

    in_a_tab(test)


def test_typed_text_is_accepted():
    async def test(client):
        choice = SelectField({"Cup": "Cup · tazza"}, new_value_mode="add-unique")
        await send_event(choice, TOLD, "tazz")
        assert choice.value == "tazz"
        await send_event(choice, TOLD, None)
        assert choice.value is None

    in_a_tab(test)
