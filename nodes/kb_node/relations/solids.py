"""An entity as a solid: an oriented box in the map, its supporting surfaces and its hollows."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from msgspec import structs

from nodes.kb_node.relations.placed import Placed
from nodes.kb_node.relations.polygons import Point, area, hull
from ontology.model_shapes import ModelShape, shapes
from schemas.entities import Entity, Size, Vector

UPRIGHT = math.cos(math.radians(15.0))
"""A thing that leans more carries nothing, and stands on its lowest corners instead of its base."""
SAMPLES = 5
"""Points along each axis that stand for a volume."""
LOWEST = 0.15
"""Of the height of a leaning thing: corners this near to its lowest are what it stands on."""

Matrix = tuple[Vector, Vector, Vector]
Bounds = tuple[float, float, float, float]
"""Least x and y, greatest x and y [m]."""


@dataclass(frozen=True)
class Support:
    """A level surface of a solid in the map frame: height [m] and outline."""

    height: float
    outline: tuple[Point, ...]
    fill: float


@dataclass(frozen=True)
class Hollow:
    """A hollow of a solid in its own frame [m]."""

    low: Vector
    high: Vector
    open: bool


@dataclass(frozen=True, eq=False)
class Solid:
    """A thing or place in the map: position [m] of its bottom centre, rotation (map from body), extent [m].

    `is_measured`: somebody gave it a size, or its model has one. What is not is a point, and claims nothing
    but where its position is.
    """

    name: str
    position: Vector
    rotation: Matrix
    size: Size
    shape: ModelShape | None
    is_place: bool
    is_measured: bool

    @property
    def is_upright(self) -> bool:
        """Whether its z axis is up, within 15 degrees."""
        return self.rotation[2][2] >= UPRIGHT

    @cached_property
    def corners(self) -> tuple[Vector, ...]:
        """The eight corners, map frame [m]; the four of its base first."""
        x, y, z = self.size
        return tuple(
            self.to_map((sx * x / 2, sy * y / 2, level))
            for level in (0.0, z)
            for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))
        )

    @cached_property
    def bottom(self) -> float:
        """Its lowest point [m]."""
        return min(corner[2] for corner in self.corners)

    @cached_property
    def top(self) -> float:
        """Its highest point [m]."""
        return max(corner[2] for corner in self.corners)

    @cached_property
    def outline(self) -> list[Point]:
        """Its shadow on the floor."""
        corners = self.corners[:4] if self.rotation[2][2] > 0.9999 else self.corners
        return hull([(x, y) for x, y, _ in corners])

    @cached_property
    def base(self) -> list[Point]:
        """What it stands on: its base; of a thing that leans or lies, the shadow of its lowest corners."""
        if self.is_upright:
            return hull([(x, y) for x, y, _ in self.corners[:4]])
        reach = self.bottom + LOWEST * (self.top - self.bottom)
        lowest = hull([(x, y) for x, y, z in self.corners if z <= reach])
        return lowest if len(lowest) > 2 else self.outline

    @cached_property
    def centre(self) -> Vector:
        """The middle of its box, map frame [m]."""
        return self.to_map((0.0, 0.0, self.size[2] / 2))

    @cached_property
    def bounds(self) -> Bounds:
        """Least x and y, greatest x and y [m]."""
        (a, b, c), (d, e, f), _ = self.rotation
        x, y, z = self.size
        px, py, _ = self.position
        px, py = px + c * z / 2, py + f * z / 2
        half_x = (abs(a) * x + abs(b) * y + abs(c) * z) / 2
        half_y = (abs(d) * x + abs(e) * y + abs(f) * z) / 2
        return px - half_x, py - half_y, px + half_x, py + half_y

    @cached_property
    def supports(self) -> tuple[Support, ...]:
        """The surfaces that carry things; the whole top of what has no model."""
        if self.is_place or not self.is_measured or not self.is_upright:
            return ()
        if self.shape is None:
            top = hull([(x, y) for x, y, _ in self.corners[4:]])
            return (Support(self.top, tuple(top), 1.0),)
        fx, fy, fz = self._stretch(self.shape)
        return tuple(
            Support(
                self.to_map((0.0, 0.0, surface.height * fz))[2],
                tuple(
                    self.to_map((x * fx, y * fy, surface.height * fz))[:2]
                    for x, y in (
                        (surface.low[0], surface.low[1]),
                        (surface.high[0], surface.low[1]),
                        (surface.high[0], surface.high[1]),
                        (surface.low[0], surface.high[1]),
                    )
                ),
                surface.fill,
            )
            for surface in self.shape.surfaces
        )

    @cached_property
    def hollows(self) -> tuple[Hollow, ...]:
        """Its interiors."""
        if self.shape is None or not self.is_measured:
            return ()
        fx, fy, fz = self._stretch(self.shape)
        return tuple(
            Hollow(
                (inner.low[0] * fx, inner.low[1] * fy, inner.low[2] * fz),
                (inner.high[0] * fx, inner.high[1] * fy, inner.high[2] * fz),
                inner.open,
            )
            for inner in self.shape.interiors
        )

    def _stretch(self, shape: ModelShape) -> Vector:
        """How much its model is stretched along each axis."""
        return tuple(mine / own for mine, own in zip(self.size, shape.size_m, strict=True))  # type: ignore[return-value]

    def to_map(self, point: Vector) -> Vector:
        """A point of its own frame in the map's."""
        x, y, z = point
        (a, b, c), (d, e, f), (g, h, i) = self.rotation
        px, py, pz = self.position
        return (px + a * x + b * y + c * z, py + d * x + e * y + f * z, pz + g * x + h * y + i * z)

    def to_own(self, point: Vector) -> Vector:
        """A point of the map in its own frame."""
        x, y, z = (p - o for p, o in zip(point, self.position, strict=True))
        (a, b, c), (d, e, f), (g, h, i) = self.rotation
        return (a * x + d * y + g * z, b * x + e * y + h * z, c * x + f * y + i * z)

    @cached_property
    def volume(self) -> float:
        """Of its box [m^3]."""
        x, y, z = self.size
        return x * y * z

    @cached_property
    def footprint(self) -> float:
        """Of its shadow [m^2]."""
        return area(self.outline)

    @cached_property
    def samples(self) -> list[Vector]:
        """Points spread evenly over its volume, map frame [m]."""
        x, y, z = self.size
        shares = [(k + 0.5) / SAMPLES for k in range(SAMPLES)]
        return [
            self.to_map(((u - 0.5) * x, (v - 0.5) * y, w * z)) for u in shares for v in shares for w in shares
        ]


def solid_of(entity: Entity | Placed) -> Solid | None:
    """The solid of an entity; None without a position."""
    if entity.pose is None:
        return None
    shape = None if entity.place else shapes().get(entity.model)
    size = entity.size_m or (shape.size_m if shape is not None else None)
    turned = shape is not None and size is not None and _is_turned(shape.size_m, size)
    return Solid(
        name=entity.name,
        position=entity.pose.position_m,
        rotation=_rotation(entity.pose.orientation_wxyz),
        size=size or (0.02, 0.02, 0.02),
        shape=_quarter_turned(shape) if shape is not None and turned else shape,
        is_place=entity.place,
        is_measured=size is not None,
    )


def _is_turned(own: Size, size: Size) -> bool:
    """Whether the simulator meets a size by turning the model a quarter (sim_node/models/library.py)."""
    longer, shorter = max(own[:2]), min(own[:2])
    return (own[0] - own[1]) * (size[0] - size[1]) < 0.0 and longer > 1.3 * shorter


def _quarter_turned(shape: ModelShape) -> ModelShape:
    """The shape turned by -90 degrees about z: (x, y) becomes (y, -x)."""
    x, y, z = shape.size_m
    return structs.replace(
        shape,
        size_m=(y, x, z),
        surfaces=tuple(
            structs.replace(s, low=(s.low[1], -s.high[0]), high=(s.high[1], -s.low[0]))
            for s in shape.surfaces
        ),
        interiors=tuple(
            structs.replace(i, low=(i.low[1], -i.high[0], i.low[2]), high=(i.high[1], -i.low[0], i.high[2]))
            for i in shape.interiors
        ),
    )


def _rotation(wxyz: tuple[float, float, float, float]) -> Matrix:
    w, x, y, z = wxyz
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
