"""A model's support surfaces and interiors, computed from its geometry.

Vertical lines through a grid over the footprint are intersected with every part, which gives the solid
intervals above each cell. A *support surface* is a patch of neighbouring cells whose solids end at one height
with free space above. An *interior* is a set of free cells with a floor below and walls on all four sides;
its top may be open, as of a bowl. Surfaces use colliding parts. Interiors also use visible parts, since a cup
collides as a solid but looks hollow, and a fridge the other way round. A part that looks and collides as a
solid, such as the body of a pot, declares its interior as its `cavity`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from semmap.nodes.sim_node.models.convex_parts import convex_part
from semmap.nodes.sim_node.models.library import Model
from semmap.nodes.sim_node.models.parts import Cavity, Floats, Part, Role, Shape, rotation_matrix
from semmap.ontology.model_shapes import Interior, LeafShape, ModelShape, Surface
from semmap.schemas import errors

CELLS = 64
"""Cells along the longer side of the footprint."""
LEVELS = 64
"""Cells along the height, for interiors."""
HEADROOM_M = 0.03
"""Free height above a support surface."""
LEVEL_M = 0.006
"""Maximum height difference of neighbouring cells of one surface."""
LEAST_AREA = 0.02
"""Share of the footprint; smaller patches are edges and handles."""
LEAST_FILL = 0.25
"""Share of the rectangle around a patch; a thinner one is a rim, a support only at the model's top."""
LEAST_VOLUME = 0.03
"""Share of the bounding box."""
LEAST_TRAY = 0.004
"""The same, for a drawer."""
_UPRIGHT = 0.9
"""The least cosine of the angle to the vertical of an axis that counts as vertical."""
GAP_M, GAP = 0.1, 0.2
"""The widest gap between the bars of a wall, such as of a cot, also as a share of the longer side."""
SHALLOW = 0.15
"""The least depth of a container as a share of its width; what is in a shallower tray is on it."""
RING = 1.5
"""The least height of a holder as a share of its width: a narrow ring holds what stands below it."""
LEAST_RIM_M = 0.012
"""The least depth of a tray."""
VESSEL_WALL_M, VESSEL_WALL = 0.006, 0.1
"""Maximum thickness of the walls around a cavity, also as a share of the least half extent of its part."""

Intervals = list[tuple[Floats, Floats]]
"""For each part both ends of its intersection with each cell's vertical line: (nx, ny), nan for none."""


def shape_of(model: Model) -> ModelShape:
    """Return the support surfaces and interiors of a model at its size, in metres in its own frame."""
    x, y, z = model.size_m
    step = max(x, y) / CELLS
    xs = np.arange(-x / 2 + step / 2, x / 2, step)
    ys = np.arange(-y / 2 + step / 2, y / 2, step)
    solid = [part for part in model.parts if part.role is not Role.VISUAL]
    walls = [(part, _cut(_as_thick_as(step, part), xs, ys)) for part in model.parts]

    def hollows(joints: Collection[str | None], least: float = LEAST_VOLUME) -> list[Interior]:
        """Return the interiors between the parts of these joints."""
        some = [(part.role, cut) for part, cut in walls if (part.joint and part.joint.name) in joints]
        if len(some) < 2:
            return []  # one part is convex
        seen, colliding = (
            [cut for role, cut in some if role is not out] for out in (Role.COLLISION, Role.VISUAL)
        )
        found = _together(*(_interiors(one, xs, ys, step, z, least) for one in (seen, colliding)))
        return [structs.replace(room, filled=_is_filled(room, colliding, xs, ys)) for room in found]

    names = [leaf.joint.name for leaf in model.leaves]
    interiors = hollows([None, *names])
    for name in names:
        without = hollows([None, *(other for other in names if other != name)])
        interiors = [
            room if _is_among(room, without) else structs.replace(room, behind=(*room.behind, name))
            for room in interiors
        ]
    interiors += [_cavity(part, part.cavity, xs, ys) for part in model.parts if part.cavity]
    surfaces = _surfaces([_cut(part, xs, ys) for part in solid], xs, ys, step)
    leaves = []
    for leaf in model.leaves:
        own = [_cut(part, xs, ys) for part in leaf.parts if part.role is not Role.VISUAL]
        tops = _surfaces(own, xs, ys, step) if own else []
        trays = hollows([leaf.joint.name], LEAST_TRAY) if leaf.joint.kind == "slide" else []
        leaves.append(
            LeafShape(
                name=leaf.joint.name,
                kind=leaf.joint.kind,
                anchor=leaf.joint.anchor,
                axis=leaf.joint.axis,
                limits=leaf.joint.range,
                closed=leaf.joint.closed,
                parts=tuple(k for k, part in enumerate(solid) if part.joint == leaf.joint),
                surfaces=tuple(k for k, top in enumerate(surfaces) if any(_is_one(top, o) for o in tops)),
                interiors=tuple(_up_to_the_lid(tray, interiors) for tray in trays),
            )
        )
    return ModelShape(
        size_m=model.size_m,
        surfaces=tuple(surfaces),
        interiors=tuple(interiors),
        parts=tuple(map(convex_part, solid)),
        leaves=tuple(leaves),
    )


def _cavity(part: Part, cavity: Cavity, xs: Floats, ys: Floats) -> Interior:
    """Return the interior of a solid part, between its walls."""
    centre, reach = np.asarray(part.centre), part.reach()
    wall = min(VESSEL_WALL_M, VESSEL_WALL * float(reach.min()))
    low, high = centre - reach + wall, centre + reach - wall
    low[2] += 2.0 * cavity.floor * reach[2]
    if cavity.is_open:
        high[2] += wall
    (x0, y0, z0), (x1, y1, z1) = low.tolist(), high.tolist()
    below, _ = _cut(part, xs, ys)
    return Interior(
        low=(x0, y0, z0),
        high=(x1, y1, z1),
        fill=part.volume / float(np.prod(2.0 * reach)),
        round=_is_round(np.argwhere(~np.isnan(below))),
        open=cavity.is_open,
        filled=True,
    )


def _is_round(cells: NDArray[np.int64]) -> bool:
    """Return whether an ellipse matches the outline of (N, 2) cells better than the rectangle around them."""
    low, high = cells.min(axis=0), cells.max(axis=0) + 1
    covered = np.zeros(high - low, dtype=bool)
    covered[tuple((cells - low).T)] = True
    across, along = (2.0 * (np.arange(count) + 0.5) / count - 1.0 for count in covered.shape)
    ellipse = across[:, None] ** 2 + along**2 <= 1.0
    return bool(np.count_nonzero(covered != ellipse) < np.count_nonzero(~covered))


def _as_thick_as(step: float, part: Part) -> Part:
    """Return a thin wall or bar made so thick that a line of the grid intersects it.

    Boards and floors keep their heights: only what is thin across the lines is made thicker.
    """
    rises = np.abs(rotation_matrix(part.turn)[2]) > _UPRIGHT
    is_bar = part.shape in (Shape.CYLINDER, Shape.CAPSULE) and rises[2]
    least = step * (0.71 if is_bar else 0.51)  # a disc meets a point of the grid only if it is this large
    if min(part.half) > least or not (is_bar or part.shape is Shape.BOX):
        return part
    x, y, z = np.where(rises, part.half, np.maximum(part.half, least)).tolist()
    return replace(part, half=(x, y, z))


def _is_filled(room: Interior, colliding: Intervals, xs: Floats, ys: Floats) -> bool:
    """Return whether one colliding part fills the middle of an interior, nearly from its floor to its top."""
    x, y, _ = np.add(room.low, room.high) / 2
    i, j = np.abs(xs - x).argmin(), np.abs(ys - y).argmin()
    (_, _, floor), (_, _, top) = room.low, room.high
    spare = 0.1 * (top - floor)
    return any(low[i, j] < floor + spare and high[i, j] > top - spare for low, high in colliding)


def _is_among(room: Interior, others: Iterable[Interior]) -> bool:
    """Return whether an interior still exists, no smaller and no more open."""
    return any(
        room.open >= other.open
        and other.fill > 0.9 * room.fill
        and _shared(room, other) > 0.9 * _volume(room)
        for other in others
    )


def _shared(one: Interior, other: Interior) -> float:
    """Return the common volume of two interiors [m^3]."""
    extents = np.minimum(one.high, other.high) - np.maximum(one.low, other.low)
    return float(np.prod(np.maximum(extents, 0.0)))


def _is_one(one: Surface, other: Surface) -> bool:
    """Return whether two surfaces are level, and most of the first is in the second."""
    extents = np.minimum(one.high, other.high) - np.maximum(one.low, other.low)
    shared = float(np.prod(np.maximum(extents, 0.0)))
    return abs(one.height - other.height) < LEVEL_M and shared > 0.5 * float(
        np.prod(np.subtract(one.high, one.low))
    )


def _up_to_the_lid(tray: Interior, rooms: Iterable[Interior]) -> Interior:
    """Extend a drawer's interior above its sides, up to the part above it when it is closed."""
    x, y, z = tray.high
    lid = max([z, *(room.high[2] for room in rooms if _shared(tray, room) > 0.5 * _volume(tray))])
    return structs.replace(tray, high=(x, y, lid), shallow=False)


class _Top(NamedTuple):
    """The upper end of one solid interval above a cell."""

    height: float
    room: float


def _surfaces(cuts: Intervals, xs: Floats, ys: Floats, step: float) -> list[Surface]:
    tops = _tops(cuts)
    owner: dict[tuple[int, int, int], int] = {}
    surfaces: list[Surface] = []
    highest = max((top.height for here in tops.values() for top in here), default=0.0)
    least = max(LEAST_AREA * len(xs) * len(ys), 4.0)
    for (i, j), here in sorted(tops.items()):
        for k, top in enumerate(here):
            if (i, j, k) in owner or top.room < HEADROOM_M:
                continue
            patch = _patch(tops, (i, j, k), owner)
            if len(patch) < least:
                continue
            cells = np.array([(a, b) for a, b, _ in patch])
            height = float(np.median([tops[a, b][c].height for a, b, c in patch]))
            (x0, y0), (x1, y1) = cells.min(axis=0), cells.max(axis=0)
            fill = len(patch) / float((x1 - x0 + 1) * (y1 - y0 + 1))
            if fill < LEAST_FILL and height < 0.95 * highest:
                continue
            surfaces.append(
                Surface(
                    height=height,
                    low=(float(xs[x0] - step / 2), float(ys[y0] - step / 2)),
                    high=(float(xs[x1] + step / 2), float(ys[y1] + step / 2)),
                    fill=fill,
                )
            )
    return sorted(surfaces, key=lambda surface: -surface.height)


def _patch(
    tops: dict[tuple[int, int], list[_Top]],
    start: tuple[int, int, int],
    owner: dict[tuple[int, int, int], int],
) -> list[tuple[int, int, int]]:
    """Return the tops that are level with the first and connected to it."""
    level = tops[start[0], start[1]][start[2]].height
    patch, waiting = [start], [start]
    owner[start] = 1
    while waiting:
        i, j, _ = waiting.pop()
        for a, b in ((i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)):
            for c, top in enumerate(tops.get((a, b), ())):
                near = abs(top.height - level) < LEVEL_M and top.room >= HEADROOM_M
                if near and (a, b, c) not in owner:
                    owner[a, b, c] = 1
                    patch.append((a, b, c))
                    waiting.append((a, b, c))
    return patch


def _tops(cuts: Intervals) -> dict[tuple[int, int], list[_Top]]:
    """Return the upper ends of the solid intervals above each cell, from below, with the free heights."""
    lows = np.stack([low for low, _ in cuts])
    highs = np.stack([high for _, high in cuts])
    tops: dict[tuple[int, int], list[_Top]] = {}
    for i, j in zip(*np.nonzero(~np.isnan(lows).all(axis=0)), strict=True):
        ends: list[list[float]] = []
        met = ~np.isnan(lows[:, i, j])
        for low, high in sorted(zip(lows[met, i, j], highs[met, i, j], strict=True)):
            if ends and low <= ends[-1][1] + 0.003:
                ends[-1][1] = max(ends[-1][1], high)
            else:
                ends.append([low, high])
        above = [low for low, _ in ends[1:]] + [np.inf]
        tops[int(i), int(j)] = [_Top(high, up - high) for (_, high), up in zip(ends, above, strict=True)]
    return tops


def _interiors(
    cuts: Intervals, xs: Floats, ys: Floats, step: float, height: float, least: float
) -> list[Interior]:
    from scipy import ndimage  # slow to import, and a start needs it for own models only

    rise = height / LEVELS
    levels = (np.arange(LEVELS) + 0.5) * rise
    solid = np.zeros((len(xs), len(ys), LEVELS), dtype=bool)
    for low, high in cuts:
        with np.errstate(invalid="ignore"):
            solid |= (low[..., None] - rise / 2 <= levels) & (levels <= high[..., None] + rise / 2)
    walled = ~solid
    bars = 1 + int(min(GAP_M, GAP * step * max(len(xs), len(ys))) / step)
    for axis in (0, 1):
        wall = _close_gaps(solid, 1 - axis, bars)
        walled &= _have_before(wall, axis) & np.flip(_have_before(np.flip(wall, axis), axis), axis)
    walled &= np.logical_or.accumulate(solid, axis=2)
    is_covered = np.zeros_like(solid)
    is_covered[..., :-1] = np.logical_or.accumulate(solid[..., :0:-1], axis=2)[..., ::-1]
    labels, count = ndimage.label(walled)
    found: list[Interior] = []
    for label in range(1, count + 1):
        cells = np.argwhere(labels == label)
        low, high = cells.min(axis=0), cells.max(axis=0) + 1
        low[2] -= (reach := _reach_below(solid, cells))
        if (high - low)[2] * rise < RING * (high - low)[:2].max() * step:
            low[2] += reach  # not a holder
        filled = len(cells) * (high - low)[2] / (high[2] - cells[:, 2].min())
        if filled < least * walled.size:
            continue
        lid = solid[cells[:, 0], cells[:, 1]].shape[1]
        top = cells[cells[:, 2] == cells[:, 2].max()]
        covered = is_covered[tuple(top.T)] if high[2] < lid else np.array([False])
        floor, lid_m = _floor_and_lid(cuts, cells, float(low[2] * rise), float(high[2] * rise), rise)
        has_lid = bool(covered.all()) and lid_m is not None
        top_m = float(high[2] * rise) if lid_m is None or not has_lid else lid_m
        width = float((high - low)[:2].min() * step)
        shallow = top_m - floor < SHALLOW * width and not has_lid
        if shallow and top_m - floor < LEAST_RIM_M:
            continue
        found.append(
            Interior(
                low=(
                    float(xs[0] + (low[0] - 0.5) * step),
                    float(ys[0] + (low[1] - 0.5) * step),
                    floor,
                ),
                high=(float(xs[0] + (high[0] - 0.5) * step), float(ys[0] + (high[1] - 0.5) * step), top_m),
                fill=float(filled / np.prod(high - low)),
                round=_is_round(cells[:, :2]),
                open=not covered.all(),
                shallow=shallow,
            )
        )
    return found


def _reach_below(solid: NDArray[np.bool_], cells: NDArray[np.int64]) -> int:
    """Return the number of free levels between most of some free cells and the solids below them."""
    lowest = np.full(solid.shape[:2], LEVELS)
    np.minimum.at(lowest, tuple(cells[:, :2].T), cells[:, 2])
    columns = _columns(cells)
    below = solid[columns] & (np.arange(LEVELS) < lowest[columns][:, None])
    floor = LEVELS - 1 - np.argmax(below[:, ::-1], axis=1)
    return int(np.median(lowest[columns] - 1 - floor))


def _columns(cells: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the indices (i, j) of the columns that cells (n, 3) are in, each column once."""
    is_used = np.zeros(cells[:, :2].max(axis=0) + 1, dtype=bool)
    is_used[cells[:, 0], cells[:, 1]] = True
    i, j = np.nonzero(is_used)
    return i, j


def _have_before(wall: NDArray[np.bool_], axis: int) -> NDArray[np.bool_]:
    """Return the cells with a wall before them along an axis; a gap between bars is not before itself."""
    found = np.roll(np.logical_or.accumulate(wall, axis=axis), 1, axis=axis)
    np.moveaxis(found, axis, 0)[0] = False
    return found


def _close_gaps(solid: NDArray[np.bool_], axis: int, cells: int) -> NDArray[np.bool_]:
    """Return solid cells, and those between two of them along an axis that are fewer than `cells`."""
    from scipy import ndimage  # slow to import

    spare, size = [(0, 0)] * 3, [1] * 3
    spare[axis], size[axis] = (cells, cells), cells
    closed = ndimage.binary_closing(np.pad(solid, spare), np.ones(size))  # which needs room at the ends
    found: NDArray[np.bool_] = closed[
        tuple(slice(a, n - b) for n, (a, b) in zip(closed.shape, spare, strict=True))
    ]
    return found


def _floor_and_lid(
    cuts: Intervals, cells: NDArray[np.int64], low_m: float, high_m: float, rise: float
) -> tuple[float, float | None]:
    """Return the exact heights of the solids below and above some free cells, None without one above."""
    columns = _columns(cells)
    ends = np.concatenate([high[columns] for _, high in cuts])
    starts = np.concatenate([low[columns] for low, _ in cuts])
    below = ends[(ends <= low_m + rise) & (ends >= low_m - 2 * rise)]
    above = starts[(starts >= high_m - rise) & (starts <= high_m + 2 * rise)]
    return (
        float(np.median(below)) if below.size else low_m,
        float(np.median(above)) if above.size else None,
    )


def _together(one: list[Interior], other: list[Interior]) -> list[Interior]:
    """Return the interiors of both variants; of those that overlap, the larger."""
    kept: list[Interior] = []
    for room in sorted([*one, *other], key=lambda room: -_volume(room)):
        if not any(_meet(room, known) for known in kept):
            kept.append(room)
    return sorted(kept, key=lambda room: room.low[::-1])


def _meet(one: Interior, other: Interior) -> bool:
    return all(one.low[k] < other.high[k] and other.low[k] < one.high[k] for k in range(3))


def _volume(room: Interior) -> float:
    return float(np.prod(np.subtract(room.high, room.low)))


def _cut(part: Part, xs: Floats, ys: Floats) -> tuple[Floats, Floats]:
    """Return where the vertical lines enter and leave a part: two arrays (nx, ny), nan for none."""
    rotation = rotation_matrix(part.turn)
    grid = np.stack(np.broadcast_arrays(xs[:, None], ys[None, :], 0.0), axis=-1) - np.asarray(part.centre)
    origin, up = grid @ rotation, rotation[2]  # in the part's own axes
    half = np.asarray(part.half)
    with np.errstate(divide="ignore", invalid="ignore"):
        match part.shape:
            case Shape.BOX:
                enter, leave = _slabs(origin, up, half)
            case Shape.ELLIPSOID:
                enter, leave = _ball(origin / half, up / half, 1.0)
            case Shape.CYLINDER:
                enter, leave = _can(origin, up, float(half[0]), float(half[2]))
            case Shape.CAPSULE:
                tips = np.array([0.0, 0.0, half[2]])
                ends = [
                    _can(origin, up, float(half[0]), float(half[2])),
                    _ball(origin - tips, up, float(half[0])),
                    _ball(origin + tips, up, float(half[0])),
                ]
                enter, leave = np.fmin.reduce([a for a, _ in ends]), np.fmax.reduce([b for _, b in ends])
            case Shape.MESH:
                enter, leave = _hull(part, origin, up)
    return enter, leave


def _ends(enter: Floats, leave: Floats) -> tuple[Floats, Floats]:
    missed = ~(enter <= leave)
    return np.where(missed, np.nan, enter), np.where(missed, np.nan, leave)


def _slabs(origin: Floats, up: Floats, half: Floats) -> tuple[Floats, Floats]:
    enter, leave = np.full(origin.shape[:2], -np.inf), np.full(origin.shape[:2], np.inf)
    for axis in range(3):
        if abs(up[axis]) < 1e-9:
            outside = np.abs(origin[..., axis]) > half[axis]
            enter[outside] = np.inf
        else:
            one, other = (
                (-half[axis] - origin[..., axis]) / up[axis],
                (half[axis] - origin[..., axis]) / up[axis],
            )
            enter, leave = (
                np.maximum(enter, np.minimum(one, other)),
                np.minimum(leave, np.maximum(one, other)),
            )
    return _ends(enter, leave)


def _ball(origin: Floats, up: Floats, radius: float) -> tuple[Floats, Floats]:
    a, b = float(up @ up), origin @ up
    root = np.sqrt(b * b - a * ((origin**2).sum(axis=-1) - radius**2))
    return (-b - root) / a, (-b + root) / a


def _can(origin: Floats, up: Floats, radius: float, half: float) -> tuple[Floats, Floats]:
    a = float(up[0] ** 2 + up[1] ** 2)
    flat = origin[..., :2]
    if a < 1e-12:
        inside = (flat**2).sum(axis=-1) <= radius**2
        enter = np.where(inside, -np.inf, np.inf)
        leave = np.where(inside, np.inf, -np.inf)
    else:
        b = flat @ up[:2]
        root = np.sqrt(b * b - a * ((flat**2).sum(axis=-1) - radius**2))
        enter, leave = (-b - root) / a, (-b + root) / a
    if abs(up[2]) < 1e-9:
        return _ends(np.where(np.abs(origin[..., 2]) > half, np.inf, enter), leave)
    one, other = (-half - origin[..., 2]) / up[2], (half - origin[..., 2]) / up[2]
    return _ends(np.maximum(enter, np.minimum(one, other)), np.minimum(leave, np.maximum(one, other)))


def _hull(part: Part, origin: Floats, up: Floats) -> tuple[Floats, Floats]:
    """Intersect the lines with the planes of a mesh's convex hull, as it collides."""
    from scipy.spatial import ConvexHull

    if part.mesh is None:
        raise errors.InternalError("the part is not a mesh")
    planes = ConvexHull(part.mesh.vertices).equations
    enter, leave = np.full(origin.shape[:2], -np.inf), np.full(origin.shape[:2], np.inf)
    for *normal, offset in planes:
        slope, height = float(np.dot(normal, up)), origin @ np.asarray(normal) + offset
        if abs(slope) < 1e-9:
            enter = np.where(height > 0, np.inf, enter)
        elif slope < 0:
            enter = np.maximum(enter, -height / slope)
        else:
            leave = np.minimum(leave, -height / slope)
    return _ends(enter, leave)
