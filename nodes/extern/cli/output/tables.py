"""Tables and cards for a terminal."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any

from rich import box
from rich.console import Console, ConsoleOptions, RenderResult
from rich.segment import Segment
from rich.table import Column, Table
from rich.text import Text

from semmap.nodes.extern.cli.output import plain
from semmap.nodes.extern.cli.output.printable import escaped

_NARROWEST = 8
"""The minimum width of a wrapped column."""
_BETWEEN = 2
_MANY = 1000
"""From this number of rows, plain lines are printed, because rich takes seconds or even minutes."""


class Rows(Table):
    """A table whose cells are plain text without markup, and are never truncated."""

    def __init__(self, *headers: Column | str, **style: Any) -> None:
        super().__init__(*headers, **style)
        self._lines: list[tuple[str | Text, ...]] = []

    def add(self, *cells: str | Text) -> None:
        """Add a row. Control characters in strings are escaped."""
        self._lines.append(cells)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Render the table with its full width, even if the terminal is narrower and wraps the lines.

        In a file or a pipe it is plain columns: the header first, and a line for each row.
        """
        if len(self._lines) >= _MANY or not console.is_terminal:
            return self._in_plain_lines()
        for cells in self._lines[self.row_count :]:
            self._lay_out(cells)
        least = sum((column.min_width or 0) + _BETWEEN for column in self.columns) + _BETWEEN
        return super().__rich_console__(console, options.update_width(max(options.max_width, least)))

    def _lay_out(self, cells: Iterable[str | Text]) -> None:
        texts = [printable(cell) if isinstance(cell, str) else cell for cell in cells]
        for column, text in zip(self.columns, texts, strict=True):
            least = min(text.cell_len, text.cell_len if column.no_wrap else _NARROWEST)
            column.min_width = max(column.min_width or 0, least)
        self.add_row(*texts)

    def _in_plain_lines(self) -> RenderResult:
        """Render the table without colours and wrapped columns."""
        names = [str(column.header) for column in self.columns]
        rows = [[str(cell) for cell in cells] for cells in self._lines]
        to_the_right = [column.justify == "right" for column in self.columns]
        return (Segment(f"{line}\n") for line in plain.lines(names, rows, to_the_right))


def table(*columns: str, fold: Collection[str]) -> Rows:
    """Return an empty table. In a narrow terminal, only the columns `fold` are wrapped."""
    rows = Rows(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    for name in columns:
        least = min(len(name), _NARROWEST) if name in fold else len(name)
        rows.add_column(Text(name), no_wrap=name not in fold, overflow="fold", min_width=least)
    return rows


def printable(text: str) -> Text:
    """Return a text for rich, with its line ends and control characters escaped."""
    return Text(escaped(text))


def card(rows: Mapping[str, str]) -> Table:
    """Return a table of names and values."""
    lines = Table(box=None, show_header=False, pad_edge=False)
    lines.add_column(style="dim", no_wrap=True)
    lines.add_column(overflow="fold")
    for key, value in rows.items():
        lines.add_row(key, printable(value))
    return lines
