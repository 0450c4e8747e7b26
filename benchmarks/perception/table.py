"""Tables of measurements and targets."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple


class Row(NamedTuple):
    """One figure. `reach` and `aim` are the least that is wanted, or the most where `less` is better."""

    what: str
    value: float
    unit: str = ""
    reach: float | None = None
    aim: float | None = None
    less: bool = False

    @property
    def met(self) -> str:
        """Which of the two is met."""
        for name, bound in (("aim", self.aim), ("reach", self.reach)):
            if bound is not None and (self.value <= bound if self.less else self.value >= bound):
                return name
        return "" if self.reach is None else "NO"


def lines(rows: Sequence[Row]) -> str:
    """A table in Markdown."""
    body = [
        f"| {r.what} | {_figure(r.value, r.unit)} | {_bound(r.reach)} | {_bound(r.aim)} | {r.met} |"
        for r in rows
    ]
    return "\n".join(["| what | measured | reach | aim | met |", "| --- | --- | --- | --- | --- |", *body])


def _figure(value: float, unit: str) -> str:
    return f"{value:.3f}" if not unit else f"{value:.3g} {unit}"


def _bound(value: float | None) -> str:
    return "" if value is None else f"{value:g}"
