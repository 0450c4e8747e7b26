"""Many forms at once, as arrays: the properties of `Form`, computed in a few passes of NumPy.

Forms of one model are stretched and turned together. Bounds, bottom and top equal those of `Form` to the
last bit, because the operations and their order are the same.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.kb_node.relations.geometry.fitting import box, model_shape, need_quarter_turn, turn_quarter
from semmap.nodes.kb_node.relations.geometry.forms import LOWEST_M, Form, have_slopes
from semmap.ontology.model_shapes import ConvexPart, Corner, Interior, ModelShape

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

_UNIT = box((1.0, 1.0, 1.0))
_LEVEL_M = 5e-7
_STEEP_M = 2e-6
"""A smaller rise than `_LEVEL_M` is level, and a greater one than this is not."""
_BEYOND = 0.06
"""The octagon that represents a disc extends slightly beyond it."""


@dataclass(frozen=True)
class Parts:
    """Convex parts, a row each, grouped by form. Lengths [m] from the form's origin."""

    first: Ints
    """(F,) the first row of each form."""
    count: Ints
    """(F,) the number of rows of each form."""
    low: Floats
    """(K, 3) and `high`: the axis-aligned bounding box."""
    high: Floats
    lowest: Floats
    """(K, 2) position of the lowest point, or NaN if rounding decides it."""
    centre: Floats
    """(K, 2) centre of the flat, level top, with half its sides or semi-axes `u` and `v`. NaN without one."""
    u: Floats
    v: Floats
    is_disc: Floats
    """(K,) 1 if the top is an ellipse, 0 if it is a parallelogram."""

    SHAPES: ClassVar = ((3,), (3,), (2,), (2,), (2,), (2,), ())


@dataclass(frozen=True)
class Hollows:
    """Interiors, a row each, grouped as in `Parts`: floor and lid [m], and a parallelogram of walls."""

    first: Ints
    count: Ints
    floor: Floats
    lid: Floats
    centre: Floats
    u: Floats
    v: Floats
    is_sealed: Floats
    """(K,) 1 or 0."""
    is_round: Floats
    """(K,) 1 if the walls are the ellipse in the parallelogram, else 0."""

    SHAPES: ClassVar = ((), (), (2,), (2,), (2,), (), ())


class Extents:
    """Extents of forms as arrays, a row each, in the given order. Lengths in metres."""

    def __init__(self, forms: Sequence[Form]) -> None:
        self.forms: Final = forms
        self.size: Final[Floats] = flat([form.size for form in forms], 3)
        """(F, 3)"""
        self.rotation: Final[Floats] = _rotations(forms)
        """(F, 3, 3) map from body."""
        (a, b, c), (d, e, f), (g, h, i) = np.moveaxis(self.rotation, 0, -1)
        x, y, z = self.size.T
        mid_x, mid_y = c * z / 2, f * z / 2
        half_x = (np.abs(a) * x + np.abs(b) * y + np.abs(c) * z) / 2
        half_y = (np.abs(d) * x + np.abs(e) * y + np.abs(f) * z) / 2
        self.bounds: Final[Floats] = np.stack(
            [mid_x - half_x, mid_y - half_y, mid_x + half_x, mid_y + half_y], axis=1
        )
        """(F, 4) least x and y, greatest x and y."""
        self.top: Final[Floats] = np.maximum(0.0, i * z) + (np.abs(g) * x + np.abs(h) * y) / 2
        for row, form in enumerate(forms):
            if form.joints:
                self.bounds[row], self.top[row] = form.bounds, form.top
        base = np.min([g * (sx * x / 2) + h * (sy * y / 2) for sx in (-1, 1) for sy in (-1, 1)], axis=0)
        self.lowest_corner: Final[Floats] = np.minimum(base + i * 0.0, base + i * z)

    def bottoms(self) -> Floats:
        """Return (F,) the lowest point of the parts of each, or of its box without parts."""
        found = self.lowest_corner.copy()
        for shape, of in self._shapes():
            if shape.parts:
                stretch, up = self.size[of] / np.array(shape.size_m), self.rotation[of, 2]
                heights = [_lows(alike, stretch, up).min(axis=1) for alike in _alike(shape.parts)]
                found[of] = np.minimum.reduce(heights)
        return found

    def _shapes(self) -> Iterator[tuple[ModelShape, Ints]]:
        """Yield each shape, and the rows of the forms that have it."""
        groups: dict[str, list[int]] = {}
        for row, form in enumerate(self.forms):
            if form.joints:
                yield form.shape, np.array([row])
            elif form.model is not None:
                groups.setdefault(form.model, []).append(row)
        for model, group in groups.items():
            own, rows = model_shape(model) or _UNIT, np.array(group)
            turned = need_quarter_turn(own, self.size[rows])
            for shape, of in ((own, rows[~turned]), (turn_quarter(own), rows[turned])):
                if len(of):
                    yield shape, of


class FormColumns(Extents):
    """Forms as arrays, a row each, in the given order. Lengths in metres along the axes of the map."""

    def __init__(self, forms: Sequence[Form]) -> None:
        super().__init__(forms)
        self.is_level: Final[Bools] = np.array([form.is_level for form in forms], dtype=bool)
        (a, b, c), (d, e, f), (g, h, i) = np.moveaxis(self.rotation, 0, -1)
        x, y, z = self.size.T
        self.volume: Final[Floats] = x * y * z
        is_box = np.array([form.region is None and not form.joints for form in forms], dtype=bool)
        self.is_plumb: Final[Bools] = (np.abs([c, f, g, h]).max(axis=0) < 1e-9) & (i > 0.0) & is_box
        """Whether its z axis is that of the map except for rounding, without a polygon or open doors."""
        self.is_square: Final[Bools] = self.is_plumb & (
            (np.maximum(np.abs(b), np.abs(d)) < 1e-9) | (np.maximum(np.abs(a), np.abs(e)) < 1e-9)
        )
        """Whether its outline equals its bounds."""
        self.u: Final[Floats] = np.stack([a * x / 2, d * x / 2], axis=1)
        """(F, 2) and `v`: half the sides of its outline, if it is plumb."""
        self.v: Final[Floats] = np.stack([b * y / 2, e * y / 2], axis=1)
        self.bottom: Final[Floats] = self.lowest_corner.copy()
        self.base: Final[Floats] = np.zeros((len(forms), 4))
        """(F, 4) bounds that contain its base."""
        self.footing: Final[Ints] = np.full(len(forms), -1)
        """(F,) the row of the only part that it stands on, or -1 if there are several."""
        self.has_slopes: Final[Bools] = np.zeros(len(forms), dtype=bool)
        """(F,) `Form.has_slopes`"""
        self.parts, self.hollows = self._shaped()

    def _shaped(self) -> tuple[Parts, Hollows]:
        parts = _Rows(len(self.forms), Parts.SHAPES)
        hollows = _Rows(len(self.forms), Hollows.SHAPES)
        for shape, of in self._shapes():
            self._add(shape, of, parts, hollows)
        return (
            Parts(parts.first, parts.count, *parts.columns()),
            Hollows(hollows.first, hollows.count, *hollows.columns()),
        )

    def _add(self, shape: ModelShape, of: Ints, parts: _Rows, hollows: _Rows) -> None:
        """Add the rows of the forms with this shape, stretched and turned."""
        rotation = self.rotation[of]
        stretch = self.size[of] / np.array(shape.size_m)
        if containers := [interior for interior in shape.interiors if not interior.shallow]:
            hollows.add(of, _hollows(containers, stretch, rotation))
        if not shape.parts:
            return
        self.has_slopes[of] = have_slopes(shape.parts)
        made = [_parts(alike, stretch, rotation) for alike in _alike(shape.parts)]
        low, high, *others = (np.concatenate(column, axis=1) for column in zip(*made, strict=True))
        parts.add(of, [low, high, *others])
        self.bottom[of] = bottom = low[:, :, 2].min(axis=1)
        is_lowest = low[:, :, 2] <= bottom[:, None] + LOWEST_M + _LEVEL_M
        least = np.where(is_lowest[:, :, None], low[:, :, :2], np.inf).min(axis=1)
        greatest = np.where(is_lowest[:, :, None], high[:, :, :2], -np.inf).max(axis=1)
        beyond = (_BEYOND / 2 if any(part.round for part in shape.parts) else 0.0) * (greatest - least)
        self.base[of] = np.concatenate([least - beyond, greatest + beyond], axis=1)
        stands_on_one = np.count_nonzero(is_lowest, axis=1) == 1
        self.footing[of] = np.where(stands_on_one, parts.first[of] + is_lowest.argmax(axis=1), -1)


def flat(rows: Sequence[tuple[float, ...]], width: int) -> Floats:
    """Return an (N, width) array, faster than np.array does."""
    return np.fromiter(chain.from_iterable(rows), np.float64, width * len(rows)).reshape(-1, width)


def _rotations(forms: Sequence[Form]) -> Floats:
    """Return (F, 3, 3). Each distinct rotation is converted once, because most are equal."""
    ways = {form.rotation: form.rotation for form in forms}
    rows = {rotation: row for row, rotation in enumerate(ways)}
    table = np.array(list(ways), dtype=np.float64).reshape(-1, 3, 3)
    return table[np.fromiter((rows[form.rotation] for form in forms), np.int64, len(forms))]


class _Rows:
    """Rows of several forms, several for each, concatenated."""

    def __init__(self, forms: int, shapes: Sequence[tuple[int, ...]]) -> None:
        """`shapes` are the shapes of a row in each column."""
        self.first = np.zeros(forms, dtype=np.int64)
        self.count = np.zeros(forms, dtype=np.int64)
        self._made: list[Sequence[Floats]] = [[np.zeros((0, *shape)) for shape in shapes]]
        self._length = 0

    def add(self, forms: Ints, columns: Sequence[Floats]) -> None:
        """Add (N, M, ...) columns: M rows for each of N forms."""
        each = columns[0].shape[1]
        self.first[forms] = self._length + each * np.arange(len(forms))
        self.count[forms] = each
        self._made.append([column.reshape(-1, *column.shape[2:]) for column in columns])
        self._length += each * len(forms)

    def columns(self) -> Iterator[Floats]:
        """Return all rows."""
        return (np.concatenate(column) for column in zip(*self._made, strict=True))


def _turned(vectors: Floats, rotation: Floats) -> Floats:
    """Return (N, ..., 3) vectors of the frames of (N, 3, 3) forms along the axes of the map."""
    between = (1,) * (vectors.ndim - 2)
    (a, b, c), (d, e, f), (g, h, i) = np.moveaxis(rotation, 0, -1).reshape(3, 3, -1, *between)
    x, y, z = np.moveaxis(vectors, -1, 0)
    found = np.empty_like(vectors)
    found[..., 0] = a * x + b * y + c * z
    found[..., 1] = d * x + e * y + f * z
    found[..., 2] = g * x + h * y + i * z
    return found


def _alike(parts: Sequence[ConvexPart]) -> list[list[ConvexPart]]:
    """Group parts by the numbers of their vectors."""
    found: dict[tuple[int, int, int], list[ConvexPart]] = {}
    for part in parts:
        found.setdefault((len(part.straight), len(part.round), len(part.points)), []).append(part)
    return list(found.values())


def _parts(alike: Sequence[ConvexPart], stretch: Floats, rotation: Floats) -> list[Floats]:
    """Return (N, P, ...) columns of `Parts` for (N, 3) stretches of P parts with equal numbers of vectors."""

    def placed(vectors: Sequence[Sequence[Corner]]) -> Floats:
        own = np.array(vectors).reshape(len(alike), -1, 3)
        return _turned(stretch[:, None, None, :] * own, rotation)

    centre = placed([[part.centre] for part in alike])[:, :, 0]
    straight, round_, points = (
        placed([part.straight for part in alike]),
        placed([part.round for part in alike]),
        placed([part.points for part in alike]),
    )
    reach, squares = np.zeros_like(centre), np.zeros_like(centre)
    for n in range(straight.shape[2]):
        reach += np.abs(straight[:, :, n])
    for n in range(round_.shape[2]):
        squares += round_[:, :, n] * round_[:, :, n]
    reach += np.sqrt(squares)
    low, high = centre - reach, centre + reach
    nothing, no_disc = np.full_like(centre[:, :, :2], np.nan), np.zeros_like(centre[:, :, 0])
    if points.shape[2]:
        low, high = low + points.min(axis=2), high + points.max(axis=2)
        return [low, high, nothing, nothing, nothing, nothing, no_disc]
    lowest, is_sure, is_flat_below = _lowest(centre, straight, round_)
    top, u, v = nothing, nothing, nothing
    is_disc = straight.shape[2] == 1 and round_.shape[2] == 2
    if is_disc:
        upright, u, v = straight[:, :, 0], round_[:, :, 0, :2], round_[:, :, 1, :2]
    elif straight.shape[2] == 3 and not round_.shape[2]:
        by_rise = np.argsort(np.abs(straight[:, :, :, 2]), axis=2)[:, :, :, None]
        first, second, upright = np.moveaxis(np.take_along_axis(straight, by_rise, axis=2), 2, 0)
        is_flat_below &= np.abs(second[:, :, 2]) <= _LEVEL_M
        u, v = first[:, :, :2], second[:, :, :2]
    if u is not nothing:
        has_top = is_sure & is_flat_below & (np.abs(upright[:, :, :2]).max(axis=2) < _LEVEL_M)
        has_top &= np.abs(upright[:, :, 2]) > _STEEP_M
        top = np.where(has_top[:, :, None], centre[:, :, :2], np.nan)
    return [low, high, lowest, top, u, v, no_disc + is_disc]


def _lows(alike: Sequence[ConvexPart], stretch: Floats, up: Floats) -> Floats:
    """Return (N, P) the bottom of the box around each part, equal to `_parts` to the last bit.

    `up` is (N, 3), the last row of each rotation.
    """
    g, h, i = up.T[:, :, None, None]

    def risen(vectors: Sequence[Sequence[Corner]]) -> Floats:
        x, y, z = np.moveaxis(stretch[:, None, None, :] * np.array(vectors).reshape(len(alike), -1, 3), -1, 0)
        found: Floats = g * x + h * y + i * z
        return found

    centre = risen([[part.centre] for part in alike])[:, :, 0]
    reach, squares = np.zeros_like(centre), np.zeros_like(centre)
    for vectors in np.moveaxis(risen([part.straight for part in alike]), 2, 0):
        reach += np.abs(vectors)
    for vectors in np.moveaxis(risen([part.round for part in alike]), 2, 0):
        squares += vectors * vectors
    low: Floats = centre - (reach + np.sqrt(squares))
    points = risen([part.points for part in alike])
    return low + points.min(axis=2) if points.shape[2] else low


def _lowest(centre: Floats, straight: Floats, round_: Floats) -> tuple[Floats, Bools, Bools]:
    """Return (N, P, 2) lowest points, NaN if uncertain.

    Also whether they are certain, and whether discs are level.
    """
    rises = straight[:, :, :, 2:]
    away = np.where(np.abs(rises) > _STEEP_M, np.sign(rises) * straight[:, :, :, :2], 0.0)
    lowest = centre[:, :, :2] - _added(away)
    steepness = np.abs(rises[:, :, :, 0])
    is_sure = ((steepness <= _LEVEL_M) | (steepness > _STEEP_M)).all(axis=2)
    rise = np.sqrt(_added(round_[:, :, :, 2] ** 2))
    is_level: Bools = rise <= _LEVEL_M
    is_sure = is_sure & (is_level | (rise > _STEEP_M))
    along = _added(round_[:, :, :, :2] * round_[:, :, :, 2:]) / np.maximum(rise, _LEVEL_M)[:, :, None]
    lowest -= np.where(is_level[:, :, None], 0.0, along)
    return np.where(is_sure[:, :, None], lowest, np.nan), is_sure, is_level


def _added(few: Floats) -> Floats:
    """Return (N, P, ...) sums along the short third axis, five times as fast as np.sum."""
    return sum(np.moveaxis(few, 2, 0), start=np.zeros((*few.shape[:2], *few.shape[3:])))


def _hollows(containers: Sequence[Interior], stretch: Floats, rotation: Floats) -> list[Floats]:
    """Return (N, H, ...) columns of `Hollows` for (N, 3) stretches of the interiors of one shape."""
    low = stretch[:, None, :] * np.array([hollow.low for hollow in containers])
    high = stretch[:, None, :] * np.array([hollow.high for hollow in containers])
    middle, half = (low + high) / 2, (high - low) / 2
    vectors = (middle * [1.0, 1.0, 0.0], half * [1.0, 0.0, 0.0], half * [0.0, 1.0, 0.0])
    walls = [_turned(vector, rotation)[:, :, :2] for vector in vectors]
    kinds = [(float(hollow.is_sealed), float(hollow.round)) for hollow in containers]
    flags = [np.broadcast_to(kind, low.shape[:2]) for kind in np.array(kinds).T]
    return [low[:, :, 2], high[:, :, 2], *walls, *flags]
