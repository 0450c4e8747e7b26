"""What a person chose is what it is called, wherever it is among the options when that is told."""

import pytest

from semmap.nodes.extern.web.panels.widgets.select_field import SelectField
from tests.extern.web.panels.tabs import in_a_tab, tell

TOLD = "update:modelValue"


@pytest.mark.parametrize("several", [False, True])
def test_an_option_that_has_moved_meanwhile_is_the_one_that_was_chosen(several):
    async def test(client):
        choice = SelectField({"cup1": "cup1", "cup3": "cup3"}, multiple=several)
        seen = {"value": 1, "label": "cup3"}
        choice.set_options({"cup1": "cup1", "cup2": "cup2", "cup3": "cup3"})
        await tell(choice, TOLD, [seen] if several else seen)
        assert choice.value == (["cup3"] if several else "cup3")

    in_a_tab(test)


def test_an_option_that_has_gone_meanwhile_is_not_chosen():
    async def test(client):
        choice = SelectField({"cup1": "cup1", "cup2": "cup2"}, value="cup1")
        choice.set_options({"cup1": "cup1", "cup3": "cup3"})
        await tell(choice, TOLD, {"value": 1, "label": "cup2"})
        assert choice.value is None

    in_a_tab(test)


def test_what_is_typed_is_taken_as_it_is():
    async def test(client):
        choice = SelectField({"Cup": "Cup · tazza"}, new_value_mode="add-unique")
        await tell(choice, TOLD, "tazz")
        assert choice.value == "tazz"
        await tell(choice, TOLD, None)
        assert choice.value is None

    in_a_tab(test)
