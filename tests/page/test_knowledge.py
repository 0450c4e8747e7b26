"""Panels for entities, details and changes in a browser."""

from __future__ import annotations

import itertools
import uuid

import pytest

from semmap.commands import Add
from tests.conftest import until
from tests.page.waiting import has_commit, settle

_PLACES = itertools.cycle(range(12))


def fresh(stem: str) -> str:
    return f"{stem}_{uuid.uuid4().hex[:8]}"


@pytest.fixture
def tab(open_tab, web):
    return open_tab(web)


@pytest.fixture
def client(system):
    with system.client() as client:
        yield client


@pytest.fixture
def added(client):
    """A function that adds a cup in a free place on the floor, and returns its name."""

    def add(**fields):
        name = fresh("cup")
        at = (2.0 + 0.25 * next(_PLACES), 2.9, 0.0)
        client.send(Add(class_=fields.pop("class_", "Cup"), name=name, at=at, wait=True, **fields))
        return name

    return add


def look_for(tab, text):
    tab.get_by_label("Filter entities by text").fill(text)


def row(tab, name):
    return tab.locator(f'.entity-table .ag-center-cols-container [row-id="{name}"]')


def select(tab, name):
    look_for(tab, name)
    row(tab, name).click()
    tab.get_by_role("heading", level=3).wait_for()
    tab.get_by_text(f"{name} ·", exact=False).first.wait_for()


def section(tab, title):
    """Return a section of the details, opened."""
    header = tab.locator(".semmap-detail .q-expansion-item").filter(has_text=title).first
    button = header.get_by_role("button").first

    def is_open():
        if button.get_attribute("aria-expanded") != "true":
            button.click()
            settle(tab)  # the details may be drawn again before the page has received the click
        return button.get_attribute("aria-expanded") == "true"

    until(is_open, f"the section {title} is open")
    return header


def open_add(tab):
    """Show the panel for adding, and return it."""
    tab.get_by_role("tab", name="Add").click()
    tab.get_by_role("button", name="Add", exact=True).wait_for()
    return tab.get_by_role("tabpanel", name="Add")


def choose_class(tab, form, typed):
    """Type into the class field of the form; the filter of the table has one with the same name."""
    form.get_by_role("combobox", name="Class").click()
    tab.get_by_role("option").first.wait_for()  # when the classes arrive, they clear typed text
    tab.keyboard.type(typed)


def test_the_table_filters_selects_and_follows_changes(tab, client, added):
    name = added(ref="blue cup")
    look_for(tab, name)
    row(tab, name).wait_for()
    tab.get_by_text("1 of").first.wait_for()
    row(tab, name).click()
    tab.get_by_role("heading", name="blue cup").wait_for()
    client.update(name, ref="green cup")
    tab.get_by_role("heading", name="green cup").wait_for()
    assert "ag-row-selected" in row(tab, name).get_attribute("class")
    client.remove(name)
    row(tab, name).wait_for(state="detached")


def test_a_class_chosen_in_the_tree_filters_the_table(tab, added):
    name = added()
    tab.get_by_role("tab", name="Classes").click()
    tab.get_by_label("Classes").get_by_text("Drinking_Vessel").click()
    tab.get_by_role("tab", name="Entities").click()
    row(tab, name).wait_for()
    assert not row(tab, "chair1").is_visible()
    tab.get_by_role("button", name="Clear filter").click()
    row(tab, "apple1").wait_for()
    tab.get_by_role("tab", name="Classes").click()  # it is not selected any more, so one click selects it
    tab.locator(".q-tree__node--selected").wait_for(state="detached")
    tab.get_by_label("Classes").get_by_text("Drinking_Vessel").click()
    tab.get_by_role("tab", name="Entities").click()
    row(tab, "apple1").wait_for(state="detached")


def test_entities_are_added_by_typing_a_label(tab, client):
    name = fresh("machine")
    choose_class(tab, open_add(tab), "macchina del")
    tab.get_by_role("option", name="Coffee_Machine").click()
    tab.get_by_label("Name (empty").fill(name)
    for axis, value in (("x", "2.5"), ("y", "3.1"), ("z", "1.2")):
        tab.get_by_label(f"position {axis}").fill(value)
    tab.get_by_role("button", name="Add", exact=True).click()
    until(lambda: name in {e.name for e in client.list()}, "it is in the map")
    first = client.history(name)[0].changes[0]
    assert (first.kind, first.now) == ("added", "Coffee_Machine")
    assert client.get(name).pose.position_m[:2] == pytest.approx((2.5, 3.1), abs=0.5)  # it falls
    tab.get_by_role("tab", name="Details").click()
    tab.get_by_text(f"{name} ·").wait_for()


def test_enter_selects_the_class_with_the_typed_label(tab):
    form = open_add(tab)
    choose_class(tab, form, "tazz")
    options = tab.get_by_role("option")
    until(lambda: options.first.inner_text().startswith("Cup ·"), "the best match comes first")
    tab.keyboard.press("Enter")
    field = form.get_by_role("combobox", name="Class")
    until(lambda: field.input_value().startswith("Cup ·"), "the class that was meant is chosen")


def test_the_table_is_one_tab_stop(tab):
    row(tab, "apple1").locator('[col-id="name"]').click()
    tab.keyboard.press("ArrowDown")
    focused = "document.activeElement.closest('.entity-table') !== null"
    assert tab.evaluate(focused)
    tab.keyboard.press("Tab")
    assert not tab.evaluate(focused)
    assert tab.evaluate("document.documentElement.lang") == "en-US"
    assert tab.get_by_role("heading", level=1).all_inner_texts() == ["semmap"]


def test_a_rejected_add_shows_the_reason_and_a_fix(tab, client, added):
    name = added()
    choose_class(tab, open_add(tab), "Cup ·")
    tab.get_by_role("option", name="Cup ·").first.click()
    tab.get_by_label("Name (empty").fill(name)
    tab.get_by_role("button", name="Add", exact=True).click()
    dialog = tab.get_by_role("dialog", name="Rejected")
    dialog.get_by_text(f"the name '{name}' is taken").wait_for()
    before = {e.name for e in client.list()}
    dialog.get_by_role("button", name="Use the name").click()
    until(lambda: {e.name for e in client.list()} > before, "it is added under another name")


def test_a_contradiction_shows_its_proof_and_a_fix(tab, client, added):
    name = added()
    client.set(name, "isSwitchedOn", True)
    select(tab, name)
    client.track(name)
    tab.get_by_text("No live pose received from a stream").wait_for()
    client.publish_pose(name, at=client.get(name).pose.position_m)
    tab.get_by_text("Stale: last live pose from a stream").wait_for()
    client.track(name, off=True)
    tab.locator(".semmap-robot").wait_for(state="detached")
    form = section(tab, "Edit")
    form.get_by_role("combobox", name="Class").click()
    tab.get_by_role("option").first.wait_for()
    tab.keyboard.press("Control+a")
    tab.keyboard.type("Kitchen ·")
    tab.get_by_role("option", name="Kitchen ·").first.click()
    tab.get_by_role("button", name="Save").click()
    dialog = tab.get_by_role("dialog", name="Rejected")
    dialog.get_by_text("as a Kitchen it would be a place").wait_for()
    dialog.get_by_role("button", name="Force the change").click()
    steps = dialog.get_by_label("Steps")
    steps.get_by_text(f"{name} is switched on").wait_for()
    steps.get_by_text("nothing is both a location and an object").wait_for()
    assert client.get(name).class_ == "Cup"
    dialog.get_by_role("button", name=f"Unset {name} isSwitchedOn true and retry").click()
    until(lambda: client.get(name).class_ == "Kitchen", "it is a kitchen")
    client.remove(name)


def test_typed_contents_stay_when_tracking_begins_and_ends(tab, client, added):
    name = added()
    select(tab, name)
    label = section(tab, "Edit").get_by_label("Label", exact=True)
    label.fill("grandmother's cup")
    client.track(name)
    tab.locator(".semmap-robot").wait_for()
    assert label.input_value() == "grandmother's cup"
    client.track(name, off=True)
    tab.locator(".semmap-robot").wait_for(state="detached")
    assert label.input_value() == "grandmother's cup"


def test_explanations_are_shown_step_by_step(tab):
    select(tab, "milk1")
    why = tab.get_by_role("button", name="Why: is food")
    why.click()
    steps = tab.get_by_label("Steps")
    steps.get_by_text("milk1 is milk").wait_for()
    steps.get_by_text("every drink is food").wait_for()
    assert steps.get_by_text("asserted", exact=True).count() == 1
    why.click()
    steps.wait_for(state="detached")


def test_clicks_are_not_lost_while_the_map_changes(tab, client, added):
    name = added()
    select(tab, name)
    why = tab.get_by_role("button", name="Why: is an object")
    reasons = tab.locator(".semmap-why")
    for number in range(10):
        is_on = number % 2 == 0
        if is_on:  # adds or removes a fact above the others, which moves the button
            done = client.set(name, "isSwitchedOn", True)
        else:
            done = client.unset(name, "isSwitchedOn")
        why.click()  # while the page processes the change
        has_commit(tab, done.commit)
        asserted = tab.locator(".semmap-detail").get_by_text(f"Asserted ({1 + is_on})")
        asserted.wait_for()
        if is_on:
            reasons.get_by_label("Steps").wait_for()
        else:
            reasons.wait_for(state="detached")


def test_a_label_is_edited_and_the_change_undone(tab, client, added):
    name = added(ref="cup")
    select(tab, name)
    section(tab, "Edit").get_by_label("Label", exact=True).fill("grandmother's cup")
    tab.get_by_role("button", name="Save").click()
    until(lambda: client.get(name).preferred_reference == "grandmother's cup", "it is called so")
    tab.get_by_role("heading", name="grandmother's cup").wait_for()
    tab.get_by_label("History").get_by_text("label: 'cup' → 'grandmother's cup'").wait_for()
    tab.get_by_role("button", name="Undo the last change").click()
    until(lambda: client.get(name).preferred_reference == "cup", "it is undone")
    tab.get_by_role("heading", name="cup", exact=True).wait_for()


def test_a_state_is_set_and_unset(tab, client, added):
    name = added()
    select(tab, name)
    fields = section(tab, "States")
    fields.get_by_label("mass").fill("0.25")
    fields.get_by_label("mass").press("Enter")
    until(lambda: client.get(name).properties.get("mass") == 0.25, "the mass is set")
    tab.get_by_role("button", name="Unset mass").click()
    until(lambda: "mass" not in client.get(name).properties, "the mass is unset")


def test_deletion_is_confirmed_and_lists_its_effects(tab, client, added):
    name = added()
    select(tab, name)
    tab.keyboard.press("Escape")
    select(tab, name)
    section(tab, "Edit").get_by_role("button", name="Delete").click()
    dialog = tab.get_by_role("dialog", name="Delete")
    dialog.get_by_text("inferred fact").wait_for()
    dialog.get_by_role("button", name="Cancel").click()
    dialog.wait_for(state="detached")
    assert name in {e.name for e in client.list()}
    section(tab, "Edit").get_by_role("button", name="Delete").click()
    tab.get_by_role("dialog", name="Delete").get_by_role("button", name="Delete", exact=True).click()
    until(lambda: name not in {e.name for e in client.list()}, "it is gone")


def test_several_entities_are_moved_and_deleted_together(tab, client, added):
    one, two = added(ref="twin"), added(ref="twin")
    look_for(tab, "twin")
    row(tab, one).click()
    row(tab, two).click(modifiers=["Control"])
    tab.get_by_role("heading", name="2 entities selected").wait_for()
    tab.get_by_label("offset x").fill("0.5")
    tab.get_by_role("button", name="Move", exact=True).click()
    tab.get_by_text(f"changed 2: {one} and {two}").wait_for()
    ((first,), (second,)) = (client.history(limit=1, name=name) for name in (one, two))
    assert (first.seq, first.verb) == (second.seq, "batch")
    tab.get_by_role("button", name="Delete all").click()
    tab.get_by_role("dialog", name="Delete").get_by_role("button", name="Delete", exact=True).click()
    until(lambda: not {one, two} & {e.name for e in client.list()}, "both are gone")


def test_descriptions_select_entities_or_list_candidates(tab):
    box = tab.get_by_label("Find by words")
    box.fill("il latte")
    box.press("Enter")
    tab.get_by_role("heading", name="milk").wait_for()
    assert "ag-row-selected" in row(tab, "milk1").get_attribute("class")
    box.fill("the sink")
    box.press("Enter")
    tab.get_by_text("Which one: the sink in the kitchen or the one in the bathroom?").wait_for()
    tab.locator(".semmap-answer").get_by_text("sink2").click()
    tab.get_by_text("sink2 ·").wait_for()
    box.fill("the purple elephant")
    box.press("Enter")
    tab.locator(".semmap-answer").get_by_text("elephant").wait_for()


def test_markup_is_text_and_long_texts_fit(tab, client, added):
    evil = "<script>document.title='gone'</script><img src=x onerror=\"document.title='gone'\">{{ 7*7 }}"
    name = added(ref=evil, alt=("long " * 199,))
    select(tab, name)
    tab.get_by_role("heading", name=evil).wait_for()
    box = tab.get_by_label("Find by words")
    box.fill(evil)
    box.press("Enter")
    tab.locator(".semmap-answer").wait_for()
    tab.keyboard.press("Escape")
    select(tab, name)
    section(tab, "Edit").get_by_role("button", name="Delete").click()
    tab.get_by_role("dialog", name="Delete").get_by_role("button", name="Delete", exact=True).click()
    until(lambda: name not in {e.name for e in client.list()}, "it is gone")
    assert tab.title() == "semmap"
    assert tab.locator("img[src=x]").count() == 0
    assert tab.evaluate("document.documentElement.scrollWidth") <= 1280
