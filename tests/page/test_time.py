"""The timeline in a browser: slider, steps, playback, differences, and the return to now."""

from __future__ import annotations

import re

import pytest

from semmap.commands import Add, Remove, Update
from tests.conftest import until
from tests.page.test_shell import fresh
from tests.page.waiting import has_commit, settle


@pytest.fixture
def cup(system):
    """The name of a cup that was added and moved twice, and the three commits."""
    name = fresh("cup")
    with system.client() as client:
        added = client.send(Add(class_="Cup", name=name, at=(2.0, 3.0, 0.0))).commit
        moved = client.send(Update(name=name, at=(2.0, 3.5, 0.0))).commit
        again = client.send(Update(name=name, at=(2.5, 3.5, 0.0))).commit
    yield name, added, moved, again
    with system.client() as client:
        client.send(Remove(names=(name,)))


def caption(tab):
    return tab.locator(".semmap-bar [role=status]").inner_text()


def go_to(tab, when):
    if isinstance(when, int):
        has_commit(tab, when)
    field = tab.get_by_label("Go to commit or time")
    field.fill(str(when))
    field.press("Enter")


def chips(tab):
    return tab.get_by_label("Differences").inner_text()


def test_the_timeline_steps_and_returns_to_now(tab, cup):
    name, _, moved, again = cup
    tab.get_by_role("tab", name="History").click()  # the scene is slow in a browser without a GPU
    has_commit(tab, again)
    go_to(tab, moved)
    until(lambda: caption(tab).startswith(f"Past: commit {moved} of "), "it shows the past")
    until(lambda: "1 moved by this commit" in chips(tab), "what it moved is marked")
    assert name in chips(tab)
    tab.get_by_role("button", name="Previous commit").click()
    until(lambda: "1 added by this commit" in chips(tab), "what it added is marked")
    tab.locator(".q-slider__track-container").press("ArrowRight")
    until(lambda: caption(tab).startswith(f"Past: commit {moved} of "), "the slider goes on by one")
    tab.get_by_role("button", name="Slider over time").click()
    track = tab.locator(".q-slider__track-container")
    tab.get_by_role("slider", name="Time").wait_for()
    track.click(position={"x": 1, "y": 2})
    track.press("PageDown")
    until(lambda: caption(tab).startswith("Past: commit 1 of "), "the first moment is the first commit")
    track.click(position={"x": track.bounding_box()["width"] - 2, "y": 2})
    track.press("PageUp")
    until(lambda: caption(tab).startswith("Now: "), "the last moment is now")
    tab.get_by_role("button", name="Previous commit").click()
    until(lambda: caption(tab).startswith("Past: "), "it shows the past again")
    tab.keyboard.press("Home")
    until(lambda: caption(tab).startswith("Now: commit "), "it is now again")
    assert chips(tab) == ""


def test_home_directly_after_the_slider_returns_to_now(tab, cup):
    _, _, moved, _ = cup
    tab.get_by_role("tab", name="History").click()
    go_to(tab, moved - 1)
    until(lambda: caption(tab).startswith("Past: "), "it shows the past")
    tab.locator(".q-slider__track-container").press("ArrowRight")
    tab.keyboard.press("Home")
    settle(tab)
    assert caption(tab).startswith("Now: commit ")


def test_the_past_is_compared_with_now_and_is_read_only(tab, cup, system):
    name, added, *_ = cup
    tab.get_by_role("tab", name="History").click()
    go_to(tab, added)
    until(lambda: caption(tab).startswith(f"Past: commit {added} of "), "it shows the past")
    tab.get_by_label("Compare with").click()
    tab.get_by_role("option", name="now", exact=True).click()
    until(lambda: re.search(r"\d moved since then", chips(tab)), "what has moved since is marked")
    assert name in chips(tab)
    with system.client() as client:
        before = client.status().commit
        tab.keyboard.press("u")
        tab.get_by_text("the past is read-only").wait_for()
        assert client.status().commit == before


def test_the_options_of_a_list_are_shown_although_frames_are_late(tab):
    tab.evaluate(
        "() => { const draw = requestAnimationFrame.bind(window);"
        " window.requestAnimationFrame = (call) => setTimeout(() => draw(call), 500); }"
    )
    tab.get_by_label("Compare with").click()
    tab.get_by_role("option", name="now", exact=True).wait_for()


def test_playback_runs_to_the_end(tab, cup):
    _, added, *_ = cup
    tab.get_by_role("tab", name="History").click()
    go_to(tab, added)
    until(lambda: caption(tab).startswith(f"Past: commit {added} of "), "it shows the past")
    tab.get_by_role("button", name="Play").click()
    until(lambda: caption(tab).startswith("Now: commit "), "it has played to now")


def test_invalid_moments_are_rejected_with_a_message(tab, cup):
    for said, why in (
        ("1000000", "commit 1000000 does not exist yet"),
        ("soonish", "'soonish' is neither a commit"),
    ):
        go_to(tab, said)
        tab.get_by_text(why).first.wait_for()
    assert caption(tab).startswith("Now: commit ")


def test_the_history_of_selected_entities_opens_their_commits(tab, cup):
    name, added, moved, again = cup
    go_to(tab, added)
    until(lambda: name in chips(tab), "what it added is marked")
    tab.get_by_label("Differences").get_by_text(name).click()
    tab.get_by_role("tab", name="History").click()
    tab.get_by_role("checkbox", name="Selected entities only").click()
    table = tab.get_by_label("Commits").locator("tbody.q-virtual-scroll__content")

    def rows():
        return table.locator("tr").all_inner_texts()

    def lists_its_commits():
        listed = rows()
        seqs = {row.split()[0] for row in listed if row.strip()}
        return all(name in row for row in listed) and {str(added), str(moved), str(again)} <= seqs

    until(lists_its_commits, "only its commits are listed, and all of them")
    settle(tab)  # computing the details of the past takes seconds, and the next moment waits for it
    table.get_by_text(str(moved), exact=True).click()
    until(lambda: caption(tab).startswith(f"Past: commit {moved} of "), "the page goes there")


def test_details_of_the_past_show_past_facts(tab, cup):
    name, added, _, again = cup
    has_commit(tab, again)
    tab.get_by_label("Filter entities by text").fill(name)
    tab.locator(f'[row-id="{name}"] [col-id="name"]').click()
    tab.locator(".semmap-fact", has_text="class: Cup").wait_for()
    go_to(tab, added)
    until(lambda: caption(tab).startswith(f"Past: commit {added} of "), "it shows the past")
    details = tab.locator(".semmap-detail")
    details.get_by_text("available for the current map only").wait_for()
    details.locator(".semmap-fact", has_text="class: Cup").wait_for()
    details.locator(".semmap-fact", has_text="Dishware").first.wait_for(timeout=60_000)
    assert details.get_by_role("button", name="Why").count() == 0
    assert "moved from" not in details.inner_text()
