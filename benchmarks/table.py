"""Tables of measurements and targets."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple


class Row(NamedTuple):
    """One figure. `reach` and `aim` are the most that is allowed, for rates (`more`) the least."""

    what: str
    value: float
    unit: str
    reach: float | None = None
    aim: float | None = None
    more: bool = False

    @property
    def met(self) -> str:
        """Which of the two is met."""
        for name, bound in (("aim", self.aim), ("reach", self.reach)):
            if bound is not None and (self.value >= bound if self.more else self.value <= bound):
                return name
        return "" if self.reach is None else "NO"


def lines(rows: Sequence[Row]) -> str:
    """Return the table in Markdown."""
    head = ["| what | measured | reach | aim | met |", "| --- | --- | --- | --- | --- |"]
    return "\n".join(
        head
        + [
            f"| {r.what} | {r.value:.3g} {r.unit} | {_bound(r.reach)} | {_bound(r.aim)} | {r.met} |"
            for r in rows
        ]
    )


def as_json(row: Row) -> dict[str, object]:
    """Return a row as JSON data."""
    better = "higher" if row.more else "lower"
    return {
        "what": row.what, "value": row.value, "unit": row.unit, "reach": row.reach, "aim": row.aim,
        "better": better,
    }  # fmt: skip


def _bound(bound: float | None) -> str:
    return "" if bound is None else f"{bound:g}"
