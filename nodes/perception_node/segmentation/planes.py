"""Dominant planes by RANSAC: floor, walls, and supports.

Three nearby points make a hypothesis. All hypotheses are drawn and scored together. Each plane that is found
removes its voters, and the best remaining hypothesis is fitted by least squares.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from semmap.nodes.perception_node.input.cloud import Transform
from semmap.nodes.perception_node.segmentation.working_image import Floats, Labels, Mask

Kind = Literal["floor", "wall", "support", "plane"]

_SAMPLE = 3000  # points that planes are fitted to
_VOTERS = 600  # of these vote for hypotheses
_FEWEST_CELLS = 50
_LEAST_AREA_M2 = 1e-5
_TRIALS = 240
_REACH_CELLS = 60  # the three points of a hypothesis lie this near one another
_MOST_PLANES = 6
LEAST_SHARE = 0.04  # of all points, for a plane that gravity explains
_LEAST_SHARE_UNKNOWN = 0.2
_LEAST_SIDE_M = 0.35
_LEAST_RAISED_SIDE_M = 0.2  # of a support higher above another one than things are tall
_LEAST_WALL_M = 1.0  # of its shorter side; a smaller one is the side of things
_MOST_BEHIND = 0.5  # of all points; behind the side of a thing there are more
_STRAY = 0.02
_UPRIGHT_COS = np.cos(np.radians(8))
_LEVEL_COS = np.cos(np.radians(80))
_FLOOR_BELOW_M = 0.06
_OVER = 0.3  # minimum share above the visible part of the other plane
_SMALLER = 0.7  # else it is a shelf above a shelf
_TALLEST_M = 0.5
_AROUND = np.ones((3, 3))
_STEEP = 0.5
"""Minimum slope (sine) of a slice through upright things, from row to row."""
_ROWS_APART = 8


@dataclass(frozen=True)
class Plane:
    """Points p with normal · p = offset_m, camera frame; the normal points to the camera's side.

    `points`: number of cells on it. `sides_m`: extents along its longer and shorter axis. If the pose of the
    camera is unknown, the largest is the support, and others are of kind `plane`.
    """

    normal: NDArray[np.float64]
    offset_m: float
    kind: Kind
    points: int
    sides_m: tuple[float, float]

    def height_m(self, points: Floats) -> Floats:
        """Return the distance of points (3, ...) on the camera's side."""
        return _height(points, self.normal.astype(np.float32), np.float32(self.offset_m))


def thickness_m(distance_m: Floats) -> Floats:
    """Return the tolerance of a plane's points: noise grows with the square of the distance."""
    return np.asarray(np.maximum(0.009, 0.006 * distance_m**2), np.float32)


def _height(points: Floats, normal: Floats, offset: Floats | np.float32) -> Floats:
    x, y, z = points
    return np.asarray(normal[0] * x + normal[1] * y + normal[2] * z - offset)


def find_planes(
    points: Floats,
    map_from_camera: Transform | None,
    rng: np.random.Generator,
    *,
    keep_tops: bool = False,
    least_share: float | None = None,
) -> tuple[tuple[Plane, ...], Labels]:
    """Return the planes of an image (3, h, w), and the plane of each cell from 1, 0 for none.

    The tops of things on a larger support are not supports, unless `keep_tops` is set. A plane has at least
    `least_share` of all points, by default more if gravity is unknown, because it may be the side of a box.
    """
    of_plane = np.zeros(points.shape[1:], np.int32)
    thickness = thickness_m(points[2])
    free = np.isfinite(thickness)
    everything = int(free.sum())
    if least_share is None:
        least_share = _LEAST_SHARE_UNKNOWN if map_from_camera is None else LEAST_SHARE
    least = max(_FEWEST_CELLS, least_share * everything)
    if everything < least:
        return (), of_plane
    search = _Search(points, free, rng)
    planes: list[Plane] = []
    for _ in range(_MOST_PLANES):
        normal, offset = search.best()
        on = free & (np.abs(_height(points, normal, offset)) < thickness)
        count = int(on.sum())
        if count < least:
            break
        free &= ~on
        search.leave_out(on)
        height = _height(points, normal, offset)
        kind = _kind(normal, offset, map_from_camera, first=not planes)
        is_side = map_from_camera is None and (height < -thickness).sum() > _MOST_BEHIND * everything
        if kind is None or is_side:
            continue
        level = kind == "support" and map_from_camera is not None
        for piece in pieces_of(on, points, height, thickness, least) if level else [on]:
            count = int(piece.sum())
            solid = piece if kind == "floor" else largest_piece(piece)  # things cut a floor into islands
            sides = _sides(_some(points, solid, count), normal)
            if level and sides[1] < _LEAST_SIDE_M:  # another plane may have cut it, such as a thing's side
                solid = _piece_around(piece, np.abs(height) < thickness)
                sides = _sides(_some(points, solid, int(solid.sum())), normal)
            if (planes or kind == "wall") and sides[1] < _least_side_m(kind, float(offset), planes):
                continue
            planes.append(Plane(normal.astype(np.float64), float(offset), kind, count, sides))
            of_plane[piece] = len(planes)
    if map_from_camera is None or keep_tops:
        return tuple(planes), of_plane
    tops = _tops_of_things(planes, of_plane, points, map_from_camera)
    kept = [n for n in range(1, len(planes) + 1) if n not in tops]
    number = np.zeros(len(planes) + 1, np.int32)
    number[kept] = np.arange(1, len(kept) + 1)
    return tuple(planes[n - 1] for n in kept), number[of_plane]


def _least_side_m(kind: Kind, offset_m: float, planes: Sequence[Plane]) -> float:
    """Return the least shorter side of a plane in addition to others that were found."""
    if kind == "wall":
        return _LEAST_WALL_M
    lowest = min((plane.offset_m for plane in planes if plane.kind in ("floor", "support")), default=offset_m)
    is_raised = kind == "support" and offset_m - lowest > _TALLEST_M
    return _LEAST_RAISED_SIDE_M if is_raised else _LEAST_SIDE_M


def _tops_of_things(
    planes: Sequence[Plane], of_plane: Labels, points: Floats, map_from_camera: Transform
) -> set[int]:
    """Return numbers of supports above a larger one: they are the tops of things there."""
    pose = map_from_camera.astype(np.float32)
    boxes = {}
    for number, plane in enumerate(planes, 1):
        if plane.kind == "support":
            own = _some(points, of_plane == number, plane.points)
            boxes[number] = np.percentile(pose[:3, :3] @ own + pose[:3, 3:], (1, 99), axis=1)
    found = set()
    for top, other in permutations(boxes, 2):
        (low, high), (lowest, highest) = boxes[top], boxes[other]
        shared = np.clip(np.minimum(high, highest) - np.maximum(low, lowest), 0, None)[:2].prod()
        over = shared > _OVER * (high - low)[:2].prod()
        smaller = np.prod(planes[top - 1].sides_m) < _SMALLER * np.prod(planes[other - 1].sides_m)
        if over and smaller and 0 < (low + high - lowest - highest)[2] / 2 < _TALLEST_M:
            found.add(top)
    return found


def _some(points: Floats, where: Mask, count: int) -> Floats:
    """Return a sample (3, N) of points (3, h, w) in a region of at most `count` cells."""
    cells = np.flatnonzero(where)[:: max(1, count // _SAMPLE)]
    return points.reshape(3, -1).take(cells, axis=1)


def largest_piece(on: Mask) -> Mask:
    """Return the largest connected part: level tops of several things are not a table."""
    parts, count = ndimage.label(on)
    if count < 2:
        return on
    return np.asarray(parts == 1 + np.bincount(parts.ravel())[1:].argmax())


def _piece_around(piece: Mask, on: Mask) -> Mask:
    """Return the connected part of `on` that has most of a piece."""
    parts, _ = ndimage.label(on)
    return np.asarray(parts == np.bincount(parts[piece]).argmax())


class _Search:
    """Hypotheses for all planes of an image, and the remaining points that vote for them."""

    def __init__(self, points: Floats, free: Mask, rng: np.random.Generator) -> None:
        """Draw hypotheses and voters. `free`: (h, w) cells, of which at least one must be set."""
        cells = np.flatnonzero(free)
        self._cells = cells[rng.integers(len(cells), size=_SAMPLE)]
        self._points = points.reshape(3, -1).take(self._cells, axis=1)
        self._thickness = thickness_m(self._points[2])
        self._left = np.ones(_SAMPLE, bool)
        row, column = np.divmod(self._cells[:_TRIALS], free.shape[1])
        first, sides = self._points[:, :_TRIALS], []
        for _ in range(2):
            down, right = rng.integers(-_REACH_CELLS, _REACH_CELLS + 1, size=(2, _TRIALS))
            r, c = np.clip(row + down, 0, free.shape[0] - 1), np.clip(column + right, 0, free.shape[1] - 1)
            any_other = self._points[:, rng.integers(_SAMPLE, size=_TRIALS)]
            sides.append(np.where(free[r, c], points[:, r, c], any_other) - first)
        normals = np.cross(sides[0], sides[1], axis=0)
        length = np.sqrt((normals * normals).sum(axis=0))
        length[length < _LEAST_AREA_M2] = np.inf  # three points on a line are invalid
        self._normals = normals / length
        self._offsets = np.where(np.isinf(length), np.float32(np.inf), (self._normals * first).sum(axis=0))
        off = np.abs(
            _height(self._points[:, None, :_VOTERS], self._normals[..., None], self._offsets[:, None])
        )
        self._votes = (off < self._thickness[:_VOTERS]).astype(np.float32)

    def leave_out(self, on: Mask) -> None:
        """Exclude cells (h, w) from the vote."""
        self._left &= ~on.ravel()[self._cells]

    def best(self) -> tuple[Floats, np.float32]:
        """Return the plane with the most votes, fitted to its points: normal (3,) to the camera, offset."""
        votes = np.einsum("tv,v->t", self._votes, self._left[:_VOTERS].astype(np.float32))
        normal, offset = self._normals[:, votes.argmax()], self._offsets[votes.argmax()]
        for _ in range(2):
            near = self._left & (np.abs(_height(self._points, normal, offset)) < self._thickness)
            on = self._points[:, near]
            if on.shape[1] < 3:
                break
            middle = on.mean(axis=1)
            # a plane's error in depth grows with the square of the distance, so near points count more
            spread = (on - middle[:, None]) / np.maximum(on[2], np.float32(0.3))
            normal = np.linalg.eigh(spread @ spread.T)[1][:, 0].astype(np.float32)
            offset = np.float32(middle @ normal)
        return (normal, offset) if offset <= 0 else (-normal, -offset)


def _kind(
    normal: Floats, offset: np.float32, map_from_camera: Transform | None, *, first: bool
) -> Kind | None:
    """Return the kind of a plane, or None for a sloping one."""
    if map_from_camera is None:
        return "support" if first else "plane"
    up = map_from_camera[2, :3] @ normal
    if up > _UPRIGHT_COS:
        foot = map_from_camera @ np.append(normal * offset, 1.0)
        return "floor" if foot[2] < _FLOOR_BELOW_M else "support"
    return "wall" if abs(up) < _LEVEL_COS else None


def _sides(points: Floats, normal: Floats) -> tuple[float, float]:
    """Return the extents of points (3, N) along the two axes within the plane, without outliers."""
    axes = np.linalg.svd(normal[None, :])[2][1:]
    flat = axes @ points
    flat -= flat.mean(axis=1, keepdims=True)
    main = np.linalg.eigh(flat @ flat.T)[1]
    along = np.sort(main.T @ flat, axis=1)
    stray = round(_STRAY * along.shape[1])
    sides = along[:, -1 - stray] - along[:, stray]
    return float(sides.max()), float(sides.min())


def pieces_of(on: Mask, points: Floats, height: Floats, thickness: Floats, least: float) -> list[Mask]:
    """Return the pieces (h, w) of a plane with at least `least` cells, the largest first.

    `on`: (h, w) which of `points` (3, h, w) lie on it. `height`: their distance on the camera's side,
    `thickness`: the tolerance [m]. Pieces are separated where the camera looks past the plane; behind an
    occluder it may continue. Slices through things are excluded.
    """
    hidden = height > thickness  # NaN is not
    numbers = np.where(on, ndimage.label(on | hidden, _AROUND)[0], 0)
    counts = np.bincount(numbers.ravel())
    counts[0] = 0
    large = [n for n in np.argsort(-counts, kind="stable") if counts[n] >= least]
    pieces = (np.asarray(numbers == n) for n in large)
    return [piece for piece in pieces if not _is_slice(piece, points, height, thickness)]


def _is_slice(piece: Mask, points: Floats, height: Floats, thickness: Floats) -> bool:
    """Return whether the plane cuts through a thing: from row to row its points rise more than recede.

    The rows are so far apart that a step is longer than the noise, which is the `thickness`.
    """
    both = piece[1:] & piece[:-1]
    if not both.any():
        return True
    step_m = float(np.median(np.linalg.norm(np.diff(points, axis=1)[:, both], axis=0)))
    apart = min(_ROWS_APART, math.ceil(float(np.median(thickness[piece])) / max(step_m, 1e-6)))
    both = piece[apart:] & piece[:-apart]
    if not both.any():
        return True
    step = np.linalg.norm((points[:, apart:] - points[:, :-apart])[:, both], axis=0)
    rise = np.abs((height[apart:] - height[:-apart])[both])
    return bool(np.median(rise / np.maximum(step, 1e-6)) > _STEEP)
