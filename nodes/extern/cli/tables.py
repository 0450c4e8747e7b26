"""What tables and cards in a terminal are made of."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping

from rich import box
from rich.table import Table
from rich.text import Text

from schemas.commands import LoggedCommit
from schemas.commits import Commit
from schemas.entities import Pose, Provenance


class Rows(Table):
    """A table whose cells are plain text, whatever stands in them."""

    def add(self, *cells: str | Text) -> None:
        """A row. What is no printable character in a string is shown by its escape."""
        self.add_row(*(printable(cell) if isinstance(cell, str) else cell for cell in cells))


def table(*columns: str, fold: bool = False) -> Rows:
    """An empty table; with `fold` what is too wide goes on in the next line."""
    rows = Rows(box=box.SIMPLE_HEAD, pad_edge=False)
    for column in columns:
        rows.add_column(Text(column), no_wrap=not fold, overflow="fold")
    return rows


def printable(text: str) -> Text:
    """Text as it is, with line ends and the like as escapes: they would break the row, or the terminal."""
    return Text("".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text))


def card(rows: Mapping[str, str]) -> Table:
    """Names and values, one row each."""
    lines = Table(box=None, show_header=False, pad_edge=False)
    lines.add_column(style="dim", no_wrap=True)
    lines.add_column()
    for key, value in rows.items():
        lines.add_row(key, printable(value))
    return lines


def pose_cells(pose: Pose | None) -> tuple[str, str, str, str]:
    """x, y, z [m] and yaw [degrees]."""
    if pose is None:
        return ("-", "-", "-", "-")
    x, y, z = (_plain(value, 3) for value in pose.position_m)
    return (x, y, z, _plain(math.degrees(pose.yaw_rad), 0))


def pose_text(pose: Pose | None) -> str:
    """A pose in one line."""
    return "none" if pose is None else "({}, {}, {}) m, yaw {}°".format(*pose_cells(pose))


def provenance_text(p: Provenance) -> str:
    """Which commit, when, who, why and how sure, in one line."""
    if p.commit == 0:
        return p.reason
    sure = "" if p.confidence is None else f" (confidence {p.confidence:.2f})"
    return f"commit {p.commit}, {moment(p.stamp_ns)}, {author(p)}: {p.reason}{sure}"


def author(p: Provenance | Commit | LoggedCommit) -> str:
    """The source with the agent."""
    return f"{p.source}/{p.agent}" if p.agent else p.source


def moment(stamp_ns: int) -> str:
    """A time, local, as `--as-of` takes it."""
    return time.strftime("%Y-%m-%dT%H:%M:%S", time.localtime(stamp_ns / 1e9))


def _plain(value: float, digits: int) -> str:
    """Rounded, and never minus zero."""
    return f"{round(value, digits) + 0.0:.{digits}f}"
