"""The page of a secure system has the role of its certificate, and shows only what that role may do."""

from __future__ import annotations

import pytest

from semmap.nodes.identity import authority
from tests.conftest import running, until
from tests.page.conftest import Web, serving


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page-secure") / "K"
    authority.init(folder)
    authority.add(folder, "vera", "viewer")
    authority.add(folder, "bob", "operator")
    return folder


def address(system):
    (line,) = [line for line in system.said if line.startswith("page ")]
    return line.split()[1]


@pytest.fixture(scope="module")
def secured(folder, tmp_path_factory):
    """A secure system with a page for a viewer."""
    words = ("--no-record", "--secure", folder, "--web", "--web-port", "0", "--web-as", "vera")
    with running(tmp_path_factory.mktemp("page-secured") / "d", *words) as system:
        yield system


def shown(tab):
    until(lambda: "78 entities" in tab.locator(".semmap-state").inner_text(), "the map is there")
    tab.get_by_label("Filter entities by text").fill("door1")
    tab.locator('.entity-table .ag-center-cols-container [row-id="door1"]').click()
    tab.get_by_role("heading", name="front door").wait_for()
    tab.get_by_text("Inferred (").wait_for()


def test_a_page_for_a_viewer_has_no_buttons_for_changes(chromium, open_tab, secured):
    tab = open_tab(Web(address(secured), secured.process))
    shown(tab)
    for name in ("Add an entity", "Undo the last change (u)", "Save", "Delete", "Unset isOpen", "yes"):
        assert tab.get_by_role("button", name=name, exact=True).count() == 0, name
    assert tab.get_by_role("tab", name="Details").count() == 1
    assert tab.get_by_role("tab", name="Add").count() == 0
    tab.get_by_role("button", name="Why: class: Door").click()
    tab.locator(".semmap-why").wait_for()
    for panel, told in {
        "History": "begun from flat.ttl",
        "Plan": "SVG",
        "SPARQL": "Run",
        "Check": "onsistent",
        "Files": "Export",
        "System": "kb_node",
    }.items():
        tab.get_by_role("tab", name=panel, exact=True).click()
        tab.get_by_label(panel, exact=True).get_by_text(told).first.wait_for()
    tab.get_by_role("tab", name="Files").click()
    assert tab.get_by_text("Choose or drop a file").count() == 0
    tab.keyboard.press("Delete")
    tab.get_by_text("deletion is not permitted").wait_for()
    tab.keyboard.press("u")
    tab.get_by_text("undo is not permitted").wait_for()


def test_a_page_for_an_operator_changes_the_map(chromium, open_tab, secured, folder):
    with serving(secured.endpoint, "--identity", str(folder / "bob")) as web:
        tab = open_tab(web)
        shown(tab)
        states = tab.locator(".semmap-state-row").filter(has_text="is open")
        states.get_by_role("button", name="yes").click()
        tab.get_by_text("door1: isOpen: ").first.wait_for()
        tab.get_by_role("button", name="Undo the last change (u)").click()
        tab.get_by_text("undid ").first.wait_for()


def test_a_secure_page_requires_an_identity(folder, tmp_path, capsys):
    from semmap.nodes.extern.cli.app import execute

    assert execute(["up", "--data", str(tmp_path), "--secure", str(folder), "--web"]) == 2
    assert "--web-as NAME" in capsys.readouterr().err
