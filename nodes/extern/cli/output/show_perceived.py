"""The output of `semmap perceive`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from rich.table import Table

from semmap.nodes.extern.cli.output.show import console
from semmap.nodes.extern.cli.output.tables import table
from semmap.schemas import wording
from semmap.schemas.perception import FrameRow, Observation, SeenInFrame

if TYPE_CHECKING:
    from semmap.nodes.perception_node.views.segmented_view import SegmentedView

_COLUMNS = ("object", "class", "probability", "points", "x", "y", "z", "yaw", "size [m]")

_UPRIGHT = 0.7


def counts(sight: SegmentedView) -> dict[int, int]:
    """Return the number of points of each label."""
    return {segment.label: segment.count for segment in sight.segments}


def as_records(sight: SegmentedView, observations: Mapping[int, Observation | None]) -> list[dict[str, Any]]:
    """Return the objects with label, number of points, and observation (None for clutter)."""
    of = counts(sight)
    return [
        {"label": label, "points": of[label], "observation": seen}
        for label, seen in sorted(observations.items())
    ]


def as_table(sight: SegmentedView, observations: Mapping[int, Observation | None]) -> Table:
    """Return a table with one row per object: its class, pose and size."""
    rows = table(*_COLUMNS, fold=("class", "size [m]"))
    of = counts(sight)
    for label, seen in sorted(observations.items()):
        rows.add(*_cells(label, of[label], seen))
    return rows


def show_frame(row: FrameRow) -> None:
    """Print the objects of one frame of a dataset."""
    found = wording.counted(len(row.objects), "object") + (
        f", {len(row.dropped)} dropped" if row.dropped else ""
    )
    console().print(f"{row.frame}: {row.error or found}", markup=False)
    if row.objects:
        rows = table(*_COLUMNS, fold=("class", "size [m]"))
        for n, seen in enumerate(row.objects, 1):
            rows.add(*_cells(n, seen.points, seen))
        console().print(rows)


def _cells(label: int, points: int, seen: Observation | SeenInFrame | None) -> list[str]:
    if seen is None:
        return [str(label), "?", "", str(points), *[""] * 5]
    return [
        *(
            str(label),
            seen.class_ + (f" ({seen.label})" if seen.label else ""),
            f"{seen.probability:.2f}",
            str(points),
        ),
        *(f"{value:.3f}" for value in seen.pose.position_m),
        f"{math.degrees(seen.pose.yaw_rad):.0f}°" + ("" if seen.pose.upright > _UPRIGHT else " lying"),
        " x ".join(f"{side:.3f}" for side in seen.size_m),
    ]
