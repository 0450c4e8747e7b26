"""The system: its problems first, then the state of the nodes, and charts of the last ten minutes."""

from __future__ import annotations

import time
from typing import Any, Final

from nicegui import ui

from semmap.nodes.extern.web.live import LiveEvent
from semmap.nodes.extern.web.loads import measure_loads
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.widgets.redraw import LazyRedraw
from semmap.nodes.extern.web.panels.widgets.tables import table
from semmap.nodes.extern.web.views.system_status import (
    KEPT_S,
    Sample,
    format_headline,
    list_problems,
    node_rows,
)
from semmap.schemas import errors
from semmap.schemas.commands import Status

_COLUMNS: Final = (
    ("node", "node"), ("state", "state"), ("detail", "detail"), ("beat", "heartbeat"), ("up", "uptime"),
    ("memory", "memory"), ("pid", "process"), ("host", "host"),
)  # fmt: skip
_INTERVAL_S: Final = 5.0
_GREY: Final = "#8b949e"
_CURVES: Final = (
    ("commits/s", "#2f81f7", 0),
    ("poses/s", "#a371f7", 0),
    ("memory [MB]", "#d29922", 1),
    ("CPU [% of a core]", "#3fb950", 1),
)


def status(page: Page) -> None:
    """Draw the problems, the table of nodes, and the charts."""
    _Status(page)


class _Status:
    def __init__(self, page: Page) -> None:
        self._page = page
        self._requested_s = 0.0
        with ui.column().classes("w-full gap-2"):
            with ui.column().classes("w-full gap-0").props('role="alert"') as self._alarm:
                pass
            self._headline = ui.label().classes("text-subtitle1").props('role="status"').mark("status-line")
            self._table = table("Nodes", _COLUMNS, key="node", height="18rem").mark("status-nodes")
            with ui.row().classes("w-full gap-2"):
                self._charts = [_chart(axis) for axis in (0, 1)]
        self._redraw = LazyRedraw(page, self._draw)
        page.client.on_delete(page.live.listen(self._on_event))

    def _on_event(self, event: LiveEvent) -> None:
        if event.kind in ("health", "connection"):
            self._redraw.mark_stale()

    async def _draw(self) -> None:
        live = self._page.live
        now_ns = time.time_ns()
        self._show_problems(list_problems(live.health, "" if live.connected else live.offline_reason, now_ns))
        self._table.rows = node_rows(live.health.values(), measure_loads(live.health.values()), now_ns)
        for axis, chart in enumerate(self._charts):
            _plot(chart, axis, list(live.rates.samples))
        if live.connected and time.monotonic() - self._requested_s > _INTERVAL_S:
            self._requested_s = time.monotonic()
            try:
                status = await live.ask(Status())
            except errors.SemmapError as error:
                self._headline.text = error.text
                return
            self._headline.text = format_headline(status)
            if status.problems:
                known = list_problems(live.health, "", now_ns)
                self._show_problems((*known, *(text for text in status.problems if text not in known)))

    def _show_problems(self, problems: tuple[str, ...]) -> None:
        shown = [label.text for label in self._alarm if isinstance(label, ui.label)]
        if shown == list(problems):
            return
        self._alarm.clear()
        with self._alarm:
            for problem in problems:
                ui.label(problem).classes("text-negative whitespace-pre-wrap")


def _chart(axis: int) -> ui.echart:
    curves = [curve for curve in _CURVES if curve[2] == axis]
    scales = [
        {
            "type": "value", "name": name, "min": 0, "position": ("left", "right")[i],
            "axisLabel": {"color": colour}, "nameTextStyle": {"color": colour},
            "splitLine": {"show": i == 0, "lineStyle": {"color": "rgba(139,148,158,.25)"}},
        }
        for i, (name, colour, _) in enumerate(curves)
    ]  # fmt: skip
    chart = ui.echart(
        {
            "animation": False,
            "grid": {"left": 48, "right": 52, "top": 34, "bottom": 24},
            "xAxis": {"type": "time", "axisLabel": {"color": _GREY, "hideOverlap": True}},
            "yAxis": scales,
            "series": [
                {
                    "type": "line", "name": name, "yAxisIndex": i, "showSymbol": False, "data": [],
                    "lineStyle": {"width": 1.5, "color": colour}, "itemStyle": {"color": colour},
                }
                for i, (name, colour, _) in enumerate(curves)
            ],
        }
    )  # fmt: skip
    names = " and ".join(name for name, _, _ in curves)
    chart.props(f'role="img" aria-label="{names} over the last ten minutes"')
    return chart.classes("grow").style("height: 13rem; min-width: 18rem")


def _plot(chart: ui.echart, axis: int, samples: list[Sample]) -> None:
    """Update the curves of one chart; times are in milliseconds since 1970."""
    now_ms = round(1000.0 * time.time())
    chart.options["xAxis"]["min"], chart.options["xAxis"]["max"] = now_ms - round(1000.0 * KEPT_S), now_ms
    series: list[dict[str, Any]] = chart.options["series"]
    for curve, field in zip(series, (1, 2) if axis == 0 else (3, 4), strict=True):
        curve["data"] = [[round(1000.0 * sample.at_s), round(sample[field], 2)] for sample in samples]
    chart.update()
