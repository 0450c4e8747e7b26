"""From the columns of a file to a cloud."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import FARTHEST_M, NEAREST_M, Cloud
from semmap.nodes.perception_node.input.files import units

MAX_POINTS = 50_000_000
"""No frame has more; a header that says so is damaged."""
_BEHIND = 0.2
"""With such a share of its points behind the camera, a cloud's axes are not those of a camera's picture."""

Column = NDArray[Any]


Field = tuple[str, np.dtype[Any], int]
"""Name, type of an element, elements a point."""


class OtherVariant(ValueError):
    """A file may be whole, but is not of the sort that our reader knows."""


def columns_of_text(body: bytes, fields: Sequence[Field], points: int) -> dict[str, Column]:
    """Each field of one element a point, (points,), of numbers in words. Raises ValueError for too few."""
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


def cloud_of(columns: Mapping[str, Column], height: int, width: int) -> Cloud:
    """The cloud of columns of (height * width,) each: `x`, `y`, `z` [m], and colours where there are any.

    Colours are packed as 0xRRGGBB in `rgb` or `rgba`, an integer or the same bits called a float, or stand in
    `red`, `green` and `blue`. Points nearer or farther than any camera measures become NaN. Axes of other
    conventions are turned. Raises ValueError for missing columns, axes of nobody's, and other units.
    """
    if missing := [name for name in "xyz" if name not in columns]:
        raise ValueError(f"it has no field {', '.join(missing)}, only {', '.join(columns) or 'none'}")
    points = _optical(np.stack([columns[name].astype(np.float32) for name in "xyz"], axis=-1))
    depth = points[np.isfinite(points).all(axis=-1), 2]
    depth = depth[depth != 0.0]
    if len(depth) and np.median(depth) > FARTHEST_M:
        scale_m = units.likely(depth)
        raise ValueError(
            f"half of its points are more than {np.median(depth):.0f} m away, as if they were in"
            f" {units.name(scale_m)}; multiply them by {scale_m:g}"
        )
    measured = (np.abs(points) < FARTHEST_M).all(axis=-1) & (points[:, 2] > NEAREST_M)  # NaN is not
    points[~measured] = np.nan
    colors = _colors(columns)
    return Cloud(
        points_camera=points.reshape(height, width, 3),
        colors=None if colors is None else colors.reshape(height, width, 3),
    )


def _optical(points: NDArray[np.float32]) -> NDArray[np.float32]:
    """Points (N, 3) with x to the right, y down, z forward.

    Where all lie behind the camera, y is taken to be up and z to point backwards, as OpenGL has it. Where
    some do, and all have a positive x, x is forward and z up, as ROS has it of robots; or y is forward, where
    all have a positive y. Raises ValueError where none is forward: no camera at the origin saw that.
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
        f"{behind:.0%} of its points lie behind its camera; a cloud has its camera at the origin, x to the"
        " right, y down, z forward"
    )


def _colors(columns: Mapping[str, Column]) -> NDArray[np.uint8] | None:
    """(N, 3) rgb."""
    if all(name in columns for name in ("red", "green", "blue")):
        values = np.stack([columns[name] for name in ("red", "green", "blue")], axis=-1)
        return np.asarray(np.nan_to_num(np.clip(values, 0, 255)), np.uint8)
    for name in ("rgb", "rgba"):
        packed = columns.get(name)
        if packed is not None and packed.dtype.itemsize == 4:
            bits = np.ascontiguousarray(packed).view(np.uint32)
            return np.stack([bits >> shift & 255 for shift in (16, 8, 0)], axis=-1).astype(np.uint8)
    return None
