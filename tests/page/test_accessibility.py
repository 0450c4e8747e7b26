"""The accessibility of the page, by the rules of axe-core."""

from __future__ import annotations

from typing import Any

import pytest

from semmap.nodes.extern.web.layout import CENTRE, LEFT, RIGHT
from tests.page.waiting import settle

axe = pytest.importorskip("axe_playwright_python.sync_playwright")

CONTEXT = {"exclude": [[".q-uploader a.q-btn"]]}
"""Quasar nests the file input in a button, which axe-core reports; both work with the keyboard."""
IMPACTS = ("serious", "critical")
TRIES = 50


def find_faults(tab: Any) -> list[str]:
    """Return the faults that axe-core finds in the page: impact, rule and element."""
    if not tab.evaluate("'axe' in window"):
        tab.evaluate(axe.Axe().axe_script)
    found = tab.evaluate("context => axe.run(context, {resultTypes: ['violations']})", CONTEXT)
    return [
        f"{violation['impact']}: {violation['id']}: {node['html']}"
        for violation in found["violations"]
        if violation["impact"] in IMPACTS
        for node in violation["nodes"]
    ]


def check(tab: Any, view: str) -> None:
    """Wait until axe-core finds no fault; a view may still be fading in, or receive its labels."""
    settle(tab)
    for _ in range(TRIES):
        if not (found := find_faults(tab)):
            return
        tab.evaluate("new Promise(requestAnimationFrame)")
    pytest.fail(f"{view}: {found}")


@pytest.mark.parametrize(
    ("dark", "views"),
    [
        (False, ("Scene", "SPARQL", "Files")),
        pytest.param(False, (*CENTRE, *LEFT, *RIGHT), marks=pytest.mark.long),
        pytest.param(True, (*CENTRE, *LEFT, *RIGHT), marks=pytest.mark.long),
    ],
    ids=["light", "light, all", "dark, all"],
)
def test_no_view_has_an_accessibility_fault(open_tab, web, dark, views):
    tab = open_tab(web, dark=dark)
    tab.locator(".entity-table .ag-center-cols-container .ag-row").first.click()
    tab.locator(".semmap-detail").wait_for()
    for view in views:
        tab.get_by_role("tab", name=view, exact=True).click()
        tab.get_by_role("tabpanel", name=view, exact=True).wait_for()
        check(tab, view)
