"""Converts columns of a file to a cloud."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import FARTHEST_M, NEAREST_M, Cloud, Floats, Transform
from semmap.nodes.perception_node.input.files import units
from semmap.nodes.perception_node.input.viewpoint import Placement, find_up, is_seen_from_origin

MAX_POINTS = 50_000_000
"""A header with more points is damaged."""
_BEHIND = 0.2
"""With this share of points behind the camera, the axes of a cloud are not those of a camera."""

_NO_LEVEL = (
    "no camera at the origin can have seen the points, and no level surface shows which axis is up; if they"
    " are in the frame of a map or robot: --up AXIS"
)

Column = NDArray[Any]


Field = tuple[str, np.dtype[Any], int]
"""Name, element type, and number of elements per point."""


class OtherVariant(ValueError):
    """The file may be valid, but our reader does not support its variant."""


def columns_of_text(body: bytes, fields: Sequence[Field], points: int) -> dict[str, Column]:
    """Parse the fields with one element per point, (points,), from text. Raises ValueError if truncated."""
    per_point = sum(count for _, _, count in fields)
    words = body.split()
    if len(words) < points * per_point:
        raise ValueError(f"truncated: {len(words) // per_point} of {points} points")
    table = np.array(words[: points * per_point], dtype=np.float64).reshape(points, per_point)
    columns, place = {}, 0
    with np.errstate(invalid="ignore", over="ignore"):  # a label may be NaN, where the point is
        for name, dtype, count in fields:
            if count == 1:
                columns[name] = table[:, place].astype(dtype)
            place += count
    return columns


def cloud_of(
    columns: Mapping[str, Column], height: int, width: int, placement: Placement | None = None
) -> Cloud:
    """Return the cloud of columns (height * width,): `x`, `y`, `z` [m], and optional colours.

    Colours are packed as 0xRRGGBB in `rgb` or `rgba` (integer or float bits), or in `red`, `green` and
    `blue`. Points outside the range of depth cameras become NaN. Axes of other conventions are converted, or
    the points are in the frame of a map that `placement` describes. Raises ValueError for missing columns,
    unknown axes, and other units.
    """
    if missing := [name for name in "xyz" if name not in columns]:
        raise ValueError(f"it has no field {', '.join(missing)}, only {', '.join(columns) or 'none'}")
    points = np.stack([columns[name].astype(np.float32) for name in "xyz"], axis=-1)
    points, pose, notes = _in_camera(points, height, width, placement or Placement())
    depth = points[np.isfinite(points).all(axis=-1), 2]
    depth = depth[depth != 0.0]
    if len(depth) and np.median(depth) > FARTHEST_M:
        scale_m = units.likely(depth)
        raise ValueError(
            f"the median distance of its points is {np.median(depth):.0f} m; the unit"
            f" is probably {units.name(scale_m)}: multiply them by {scale_m:g}"
        )
    measured = (np.abs(points) < FARTHEST_M).all(axis=-1) & (points[:, 2] > NEAREST_M)  # NaN is not
    points[~measured] = np.nan
    colors = _colors(columns)
    return Cloud(
        points_camera=points.reshape(height, width, 3),
        colors=None if colors is None else colors.reshape(height, width, 3),
        map_from_camera=pose,
        notes=notes,
    )


def _in_camera(
    points: Floats, height: int, width: int, placement: Placement
) -> tuple[Floats, Transform | None, tuple[str, ...]]:
    """Return points (N, 3) in the camera's frame, map_from_camera if it is known, and notes.

    If the frame is not stated, and no camera at its origin could have seen the points, it is that of a map or
    robot, whose vertical is found.
    """
    up, notes = placement.up, tuple[str, ...]()
    if up is None:
        doubt = ""
        try:
            optical = _optical(points)
        except ValueError as error:
            doubt = str(error)
        if not doubt and is_seen_from_origin(optical):
            return optical, placement.frame_from_camera, ()
        found = find_up(points)
        if found is None:
            if doubt:
                raise ValueError(doubt)
            return optical, placement.frame_from_camera, (_NO_LEVEL,)
        up, doubtful = found
        notes = (
            "no camera at the origin can have seen the points, so they are read in the frame of a map or"
            f" robot with {up} up; if another axis points up: --up AXIS",
        )
        if doubtful:
            notes += (
                f"more points are below the largest level surface than above it, so {up} may point down; if"
                f" it does: --up -{up}",
            )
    placed, pose = replace(placement, up=up).place(points.reshape(height, width, 3))
    return placed.reshape(-1, 3), pose, notes


def _optical(points: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return points (N, 3) with x to the right, y down, z forward.

    If all points are behind the camera, y is up and z backwards, as in OpenGL. If some are, and all have a
    positive x, x is forward and z up, as in ROS; with a positive y, y is forward. Raises ValueError if no
    axis is forward.
    """
    x, y, z = seen = points[np.isfinite(points).all(axis=-1) & (points != 0.0).any(axis=-1)].T
    if not seen.size or (behind := float(np.mean(z < 0.0))) < _BEHIND:
        return points
    if (z <= 0.0).all():
        return points * np.array([1, -1, -1], np.float32)
    match bool((x > 0.0).all()), bool((y > 0.0).all()):
        case True, False:
            return points[:, [1, 2, 0]] * np.array([-1, -1, 1], np.float32)
        case False, True:
            return points[:, [0, 2, 1]] * np.array([1, -1, 1], np.float32)
    raise ValueError(
        f"{behind:.0%} of its points are behind the camera; if they are in the frame of a map or robot, name"
        " the axis that points up: --up z"
    )


def _colors(columns: Mapping[str, Column]) -> NDArray[np.uint8] | None:
    """Return rgb (N, 3)."""
    if all(name in columns for name in ("red", "green", "blue")):
        values = np.stack([columns[name] for name in ("red", "green", "blue")], axis=-1)
        return np.asarray(np.nan_to_num(np.clip(values, 0, 255)), np.uint8)
    for name in ("rgb", "rgba"):
        packed = columns.get(name)
        if packed is not None and packed.dtype.itemsize == 4:
            bits = np.ascontiguousarray(packed).view(np.uint32)
            return np.stack([bits >> shift & 255 for shift in (16, 8, 0)], axis=-1).astype(np.uint8)
    return None
