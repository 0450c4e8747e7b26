"""Draws names on an image, each at the top of its body."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

import mujoco
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from semmap.nodes.sim_node.bodies import Floats
from semmap.nodes.sim_node.vision.view import View

Box = tuple[float, float, float, float]

_TRIES: Final = 15
"""Number of positions that are tried for a label: at the thing, and above and below it."""
_SMALLEST_PX, _LARGEST_PX = 9, 16
_AHEAD_M: Final = 0.05
_INK, _PAPER, _LINE = (20, 20, 20), (255, 255, 255, 215), (255, 255, 255, 200)


def find_tops(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    owners: Sequence[str],
    box: tuple[Floats, Floats] | None = None,
) -> dict[str, Floats]:
    """Return the centre of the top (3,) [m] of each body with geoms, whose centre is in the box.

    `owners` (ngeom,) has the names of the bodies, "" for none. A nested body does not count in the one around
    it, and planes do not count.
    """
    number = {name: row for row, name in enumerate(dict.fromkeys(owners))}
    rotation = data.geom_xmat.reshape(-1, 3, 3)
    centre = data.geom_xpos + np.einsum("nij,nj->ni", rotation, model.geom_aabb[:, :3])
    half = np.einsum("nij,nj->ni", np.abs(rotation), model.geom_aabb[:, 3:])
    low, high = np.full((len(number), 3), np.nan), np.full((len(number), 3), np.nan)
    shown = np.flatnonzero(model.geom_type != int(mujoco.mjtGeom.mjGEOM_PLANE))
    rows = np.array([number[name] for name in owners], dtype=np.int64)[shown]
    np.fmin.at(low, rows, (centre - half)[shown])
    np.fmax.at(high, rows, (centre + half)[shown])
    found = {}
    for name, row in number.items():
        middle = (low[row] + high[row]) / 2.0
        if name and np.isfinite(middle).all() and (box is None or _is_in(middle, box)):
            found[name] = np.array([middle[0], middle[1], high[row, 2]])
    return found


def _is_in(point: Floats, box: tuple[Floats, Floats]) -> bool:
    return bool(((box[0] <= point) & (point <= box[1])).all())


def project_points(view: View, points: Mapping[str, Floats]) -> dict[str, tuple[float, float]]:
    """Return the image positions [pixel] of visible map points (3,) [m]."""
    camera_from_map = np.linalg.inv(view.map_from_camera)
    found = {}
    for name, point in points.items():
        x, y, z = camera_from_map[:3, :3] @ point + camera_from_map[:3, 3]
        if z > _AHEAD_M:
            u, v, _ = view.intrinsics @ np.array([x / z, y / z, 1.0])
            if 0.0 <= u < view.width and 0.0 <= v < view.height:
                found[name] = (float(u), float(v))
    return found


def draw_labels(image: Image.Image, points: Mapping[str, tuple[float, float]]) -> Image.Image:
    """Draw a name at each point [pixel]. A name without free space next to its point is omitted."""
    size_px = min(_LARGEST_PX, max(_SMALLEST_PX, image.height // 45))
    font = ImageFont.load_default(size_px)
    out = image.convert("RGBA")
    sheet = Image.new("RGBA", out.size, (0, 0, 0, 0))
    draw = ImageDraw.Draw(sheet)
    taken: list[Box] = []
    for name, (u, v) in sorted(points.items(), key=lambda item: item[1][1]):
        left, top, right, bottom = draw.textbbox((0, 0), name, font=font)
        place = free_place((u, v), (right - left + 4, bottom - top + 4), out.size, taken)
        if place is None:
            continue
        taken.append(place)
        middle = ((place[0] + place[2]) / 2, (place[1] + place[3]) / 2)
        draw.line([(u, v), middle], fill=_LINE, width=1)
        draw.rectangle(place, fill=_PAPER)
        draw.text((place[0] + 2 - left, place[1] + 2 - top), name, fill=_INK, font=font)
    return Image.alpha_composite(out, sheet).convert("RGB")


def free_place(
    at: tuple[float, float], size: tuple[float, float], within: tuple[int, int], taken: Iterable[Box]
) -> Box | None:
    """Return a free rectangle (width, height) near a point; None if there is none.

    Pixels; a rectangle is left, top, right, bottom, and lies within the image.
    """
    taken = tuple(taken)
    width, height = size
    left = min(max(0.0, at[0] - width / 2), within[0] - width)
    for step in range(_TRIES):
        away = (step + 1) // 2 * (1 if step % 2 else -1)
        top = min(max(0.0, at[1] - height / 2 + away * (height + 1)), within[1] - height)
        box = (left, top, left + width, top + height)
        if not any(_overlap(box, other) for other in taken):
            return box
    return None


def _overlap(a: Box, b: Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
