"""The table with 5000 entities: filters, updates and scrolling."""

from __future__ import annotations

import json

import pytest

from tests.conftest import running, until
from tests.page.conftest import serving

_ROOMS, _CUPS = 20, 249
_RELATED_MS = 120_000
"""Timeout for the first query of places after a large load, on a busy machine."""


@pytest.fixture(scope="module")
def crowded(chromium, tmp_path_factory):
    """A map of 20 kitchens with a long table and 249 cups each, and its page."""
    folder = tmp_path_factory.mktemp("many")
    rows = []
    for r in range(_ROOMS):
        x, y = r % 5 * 20.0, r // 5 * 6.0
        rows.append({"class": "Kitchen", "name": f"kitchen{r}", "at": [x, y, 0.0], "size": [19.0, 5.0, 2.5]})
        rows.append({"class": "Table", "name": f"table{r}", "at": [x, y, 0.0], "size": [18.0, 1.0, 0.7]})
        for i in range(_CUPS):
            at = [x - 8.5 + i // 3 * 0.2, y + (i % 3 - 1) * 0.25, 0.7]
            rows.append({"class": "Cup", "name": f"cup{r}_{i}", "at": at, "ref": f"cup number {i}"})
    scene = folder / "many.json"
    scene.write_text(json.dumps({"entities": rows}))
    with running(folder / "map", "--abox", "none", "--no-sim", "--no-record") as system:
        with system.client() as client:
            client.load(scene)
        with serving(system.endpoint) as web:
            yield system, web


@pytest.mark.long
def test_five_thousand_entities_are_usable(crowded, open_tab):
    system, web = crowded
    tab = open_tab(web)
    tab.get_by_text("5,020 entities").wait_for()
    assert tab.locator(".entity-table .ag-row").count() < 200  # those in sight, and a few more
    tab.get_by_label("Filter entities by text").fill("number 248")
    tab.get_by_text("20 of 5,020 entities").wait_for()
    tab.get_by_role("button", name="Clear filter").click()
    tab.get_by_text("5,020 entities", exact=True).wait_for()
    scroll = tab.locator(".entity-table .ag-body-vertical-scroll-viewport")
    until(lambda: scroll.evaluate("e => e.scrollHeight") > 150_000, "the table has all rows again")
    row = tab.locator('.entity-table .ag-center-cols-container [row-index="2005"]')
    # The table may receive its rows after that, and follows only a bar that moves.
    move = "e => e.scrollTop = e.scrollTop === 60000 ? 60001 : 60000"
    until(lambda: scroll.evaluate(move) and row.count(), "the table is scrolled")
    row.click()
    name = row.get_attribute("row-id")
    top = scroll.evaluate("e => e.scrollTop")
    with system.client() as client:
        client.update(name, ref="quite another cup")
    tab.get_by_role("heading", name="quite another cup").wait_for()
    assert scroll.evaluate("e => e.scrollTop") == top
    chosen = tab.locator(f'.entity-table .ag-center-cols-container [row-id="{name}"]')
    assert "ag-row-selected" in chosen.get_attribute("class")
    tab.get_by_role("tab", name="Places").click()
    tab.get_by_text("kitchen3 · 250").click(timeout=_RELATED_MS)
    tab.get_by_role("tab", name="Entities").click()
    tab.get_by_text("250 of 5,020 entities").wait_for()
