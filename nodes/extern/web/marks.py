"""What a tab shows and whether it is done, as attributes: for whoever drives a browser and waits for it.

`.semmap-marks` has four of them:

- `data-commit`: the commit that is shown
- `data-moment`: `now` or `past`
- `data-selected`: the names of what is selected
- `data-pending`: how much is asked for and not shown yet

`await semmapSettled()` in the browser returns when all that was done there before has been taken in, nothing
is pending any more, and what came of it is drawn.
"""

from __future__ import annotations

from nicegui import events, ui

from semmap.nodes.extern.web.page import Page


def marks(page: Page) -> None:
    """Draw them where it is called, unseen, and answer `semmapSettled`."""
    element = ui.element("div").classes("semmap-marks").style("display: none")

    def show() -> None:
        marked = {
            "data-commit": str(page.state.commit),
            "data-moment": "now" if page.moment.is_now else "past",
            "data-selected": " ".join(page.selected),
            "data-pending": str(page.pending),
        }
        if not marked.items() <= element.props.items():
            element.props.update(marked)

    async def settle(event: events.GenericEventArguments) -> None:
        asked = event.args[0] if isinstance(event.args, list) else event.args
        number = int(asked["number"])
        await page.settled()
        page.client.run_javascript(f"semmapIsSettled({number})")

    page.on_select(show)
    page.on_change(show)
    page.on_moment(show)
    page.on_pending(show)
    ui.on("semmap_settle", settle)
    show()
