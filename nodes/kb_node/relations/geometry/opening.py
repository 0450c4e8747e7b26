"""Shapes with open doors, lids and drawers, at given joint positions."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping

from msgspec import structs

from semmap.nodes.kb_node.relations.geometry.fitting import fit_model, model_shape
from semmap.ontology.model_shapes import ConvexPart, Interior, LeafShape, ModelShape, Surface
from semmap.schemas.entities import Size, Vector
from semmap.schemas.joints import OPENING, Joint, stated

Positions = tuple[float, ...]
"""Joint positions of the leaves of a shape, in their order [rad, m], or () if all are as drawn."""

AS_DRAWN: Positions = ()
_NEGLIGIBLE = 0.002
"""A joint closer to its drawn position counts as there, because this is its play [rad, m]."""
_MOST_OF_TRAY = 0.5
"""The share of a drawer's hollow from which on it is part of a hollow of the frame, while it is closed."""
_NOWHERE: Vector = (0.0, 0.0, 0.0)
_LEVEL = math.cos(math.radians(2.0))
_LEAST_TOP = 0.02
"""As a share of the footprint. Smaller parts that turn level support nothing."""

_Map = Callable[[Vector], Vector]


def positions_of(model: str | None, size: Size | None, properties: Mapping[str, object]) -> Positions:
    """Return the joint positions that a map states for a model at a size, within the joint limits."""
    if not model or size is None or properties.keys().isdisjoint(OPENING):
        return AS_DRAWN
    own = model_shape(model)
    if own is None or not own.leaves:
        return AS_DRAWN
    leaves = fit_model(model, size).leaves
    at = stated(map(_joint, leaves), properties) or {}
    found = tuple(_within(leaf, at.get(leaf.name, 0.0)) for leaf in leaves)
    return found if any(found) else AS_DRAWN


def open_shape(shape: ModelShape, positions: Positions) -> ModelShape:
    """Return a shape with its leaves at these positions. Its box, `size_m`, remains as drawn.

    The hollows of the frame stay: a cabinet contains its contents whether its door is open or not. Surfaces
    and hollows on a slide move with it. A hinge provides supporting surfaces where it turns parts level.
    """
    if not positions:
        trays = [tray for leaf in shape.leaves for tray in _list_separate_trays(leaf, shape.interiors)]
        return structs.replace(shape, interiors=(*shape.interiors, *trays)) if trays else shape
    parts = list(shape.parts)
    surfaces: list[Surface | None] = list(shape.surfaces)
    opened: list[Surface] = []
    interiors = list(shape.interiors)
    for leaf, position in zip(shape.leaves, positions, strict=True):
        if not position:
            interiors += _list_separate_trays(leaf, shape.interiors)
            continue
        turned, there = _motion(leaf, position)
        for k in leaf.parts:
            parts[k] = _move_part(parts[k], turned, there)
        for k in leaf.surfaces:
            surface = surfaces[k]
            surfaces[k] = _shift_surface(surface, there) if surface and leaf.kind == "slide" else None
        if leaf.kind == "slide":
            interiors += (_move_with_slide(interior, leaf.name, there) for interior in leaf.interiors)
        else:
            least = _LEAST_TOP * shape.size_m[0] * shape.size_m[1]
            opened += _level_tops((parts[k] for k in leaf.parts), least)
    kept = (*filter(None, surfaces), *opened)
    return structs.replace(
        shape,
        parts=tuple(parts),
        surfaces=tuple(sorted(kept, key=lambda surface: -surface.height)),
        interiors=tuple(interiors),
    )


def joint_at(leaf: LeafShape, position: float) -> Joint:
    """Return the joint of a leaf at a position."""
    return structs.replace(_joint(leaf), position=position)


def _joint(leaf: LeafShape) -> Joint:
    lower, upper = leaf.limits or (None, None)
    return Joint(name=leaf.name, kind=leaf.kind, lower=lower, upper=upper, closed=leaf.closed)


def _within(leaf: LeafShape, position: float) -> float:
    if leaf.limits is not None:
        position = min(leaf.limits[1], max(leaf.limits[0], position))
    return position if abs(position) > _NEGLIGIBLE else 0.0


def _motion(leaf: LeafShape, position: float) -> tuple[_Map, _Map]:
    """Return the maps of directions and of points for a joint position."""
    x, y, z = leaf.axis
    ax, ay, az = leaf.anchor
    if leaf.kind == "slide":
        dx, dy, dz = position * x, position * y, position * z
        return (lambda vector: vector), (lambda point: (point[0] + dx, point[1] + dy, point[2] + dz))
    cosine, sine = math.cos(position), math.sin(position)
    rest = 1.0 - cosine
    (a, b, c), (d, e, f), (g, h, i) = (
        (cosine + rest * x * x, rest * x * y - sine * z, rest * x * z + sine * y),
        (rest * x * y + sine * z, cosine + rest * y * y, rest * y * z - sine * x),
        (rest * x * z - sine * y, rest * y * z + sine * x, cosine + rest * z * z),
    )

    def turned(vector: Vector) -> Vector:
        u, v, w = vector
        return a * u + b * v + c * w, d * u + e * v + f * w, g * u + h * v + i * w

    def there(point: Vector) -> Vector:
        u, v, w = turned((point[0] - ax, point[1] - ay, point[2] - az))
        return ax + u, ay + v, az + w

    return turned, there


def _move_part(part: ConvexPart, turned: _Map, there: _Map) -> ConvexPart:
    return ConvexPart(
        centre=there(part.centre),
        straight=tuple(map(turned, part.straight)),
        round=tuple(map(turned, part.round)),
        points=tuple(map(turned, part.points)),
    )


def _shift_surface(surface: Surface, there: _Map) -> Surface:
    x0, y0, height = there((*surface.low, surface.height))
    x1, y1, _ = there((*surface.high, surface.height))
    return structs.replace(surface, height=height, low=(x0, y0), high=(x1, y1))


def _move_with_slide(interior: Interior, by: str, there: _Map) -> Interior:
    return structs.replace(
        interior, low=there(interior.low), high=there(interior.high), behind=(), carried_by=by
    )


def _list_separate_trays(leaf: LeafShape, rooms: Iterable[Interior]) -> list[Interior]:
    """Return the hollows of a closed slide that are not in one of the frame, as of a drawer below a desk."""
    return [
        structs.replace(tray, carried_by=leaf.name)
        for tray in leaf.interiors
        if all(_find_shared_share(tray, room) < _MOST_OF_TRAY for room in rooms)
    ]


def _find_shared_share(tray: Interior, room: Interior) -> float:
    """Return the share of the box of a hollow that is in another one."""
    share = 1.0
    for low, high, its_low, its_high in zip(tray.low, tray.high, room.low, room.high, strict=True):
        share *= max(0.0, min(high, its_high) - max(low, its_low)) / (high - low)
    return share


def _level_tops(parts: Iterator[ConvexPart], least_m2: float) -> Iterator[Surface]:
    """Yield the tops of boards that lie flat, along the axes of the model."""
    for part in parts:
        if len(part.straight) != 3 or part.round or part.points:
            continue
        up, *level = sorted(part.straight, key=_length)
        if abs(up[2]) < _LEVEL * _length(up):
            continue
        half = (sum(abs(side[0]) for side in level), sum(abs(side[1]) for side in level))
        if 4.0 * half[0] * half[1] < least_m2:
            continue
        x, y, z = part.centre
        yield Surface(height=z + abs(up[2]), low=(x - half[0], y - half[1]), high=(x + half[0], y + half[1]))


def _length(side: Vector) -> float:
    return math.dist(_NOWHERE, side)
