"""Rows with unchanged contents are not redrawn."""

from nicegui import ui

from semmap.nodes.extern.web.panels.widgets.rows import Rows, keyed
from tests.extern.web.panels.tabs import in_a_tab


def written(container):
    return [row.default_slot.children[0].text for row in container.default_slot.children]


def test_unchanged_rows_are_moved_and_not_redrawn():
    async def test(client):
        box = ui.column()
        rows = Rows(box, lambda content: ui.label(content) and None, tag="li")
        rows.show([("a", "one"), ("b", "two"), ("c", "three")])
        before = {row.id for row in box.default_slot.children}
        rows.show([("c", "three"), ("new", "four"), ("a", "one")])
        assert written(box) == ["three", "four", "one"]
        after = [row.id for row in box.default_slot.children]
        assert after[0] in before
        assert after[2] in before
        assert after[1] not in before
        assert all(row.tag == "li" for row in box.default_slot.children)
        rows.show([("c", "another")])
        assert written(box) == ["another"]

    in_a_tab(test)


def test_rows_with_an_update_function_stay():
    async def test(client):
        def draw(content):
            label = ui.label(content)
            return label.set_text

        box = ui.column()
        rows = Rows(box, draw)
        rows.show([("a", "one")])
        (before,) = box.default_slot.children
        rows.show([("a", "uno")])
        assert box.default_slot.children == [before]
        assert written(box) == ["uno"]

    in_a_tab(test)


def test_contents_with_the_same_key_are_numbered():
    assert [key for key, _ in keyed("aba", str.upper)] == [("A", 0), ("B", 0), ("A", 1)]
