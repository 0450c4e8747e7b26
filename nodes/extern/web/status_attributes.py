"""The state of a tab as HTML attributes, for programs that drive a browser.

The element `.semmap-marks` has four attributes:

- `data-commit`: the commit that is shown
- `data-moment`: `now` or `past`
- `data-selected`: the names of the selected entities
- `data-pending`: the number of pending operations

`await semmapSettled()` in the browser returns when the page has processed all earlier input, nothing is
pending, and the result is drawn.
"""

from __future__ import annotations

from nicegui import events, ui

from semmap.nodes.extern.web.page import Page


def add_status_attributes(page: Page) -> None:
    """Add the hidden element to the page, and reply to `semmapSettled`."""
    element = ui.element("div").classes("semmap-marks").style("display: none")

    def show() -> None:
        attributes = {
            "data-commit": str(page.state.commit),
            "data-moment": "now" if page.moment.is_now else "past",
            "data-selected": " ".join(page.selected),
            "data-pending": str(page.pending),
        }
        if not attributes.items() <= element.props.items():
            element.props.update(attributes)

    async def settle(event: events.GenericEventArguments) -> None:
        request = event.args[0] if isinstance(event.args, list) else event.args
        number = int(request["number"])
        await page.settled()
        page.client.run_javascript(f"semmapIsSettled({number})")

    page.on_select(show)
    page.on_change(show)
    page.on_moment(show)
    page.on_pending(show)
    ui.on("semmap_settle", settle)
    show()
