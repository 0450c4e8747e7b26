"""An entity as a solid: an oriented box in the map, its supporting surfaces and its hollows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from nodes.kb_node.relations.convex import Convex, convex
from nodes.kb_node.relations.fitting import fitted
from nodes.kb_node.relations.lazily import lazily
from nodes.kb_node.relations.placed import Placed
from nodes.kb_node.relations.polygons import Point, area, hull
from ontology.model_shapes import Interior, ModelShape, own_size_m
from schemas.entities import Entity, Size, Vector

UPRIGHT = math.cos(math.radians(15.0))
"""A thing that leans more has no level surfaces."""
SAMPLES = 5
"""Points along each axis that stand for a volume."""
LEVEL = math.cos(math.radians(0.2))
LOWEST_M = 0.01
"""Parts that end this near to the lowest point are what a thing stands on."""
_BOX = ModelShape(size_m=(0.02, 0.02, 0.02))
"""Of what nobody measured."""

Matrix = tuple[Vector, Vector, Vector]
Bounds = tuple[float, float, float, float]
"""Least x and y, greatest x and y [m]."""


@dataclass(frozen=True)
class Support:
    """A level surface of a solid in the map frame: height [m] and outline."""

    height: float
    outline: tuple[Point, ...]
    fill: float


_WORKED_OUT = ("corners", "outline", "base", "centre", "supports", "parts", "samples", "footprint")


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
    shape: ModelShape
    """As it is at this size, in its own frame."""
    is_place: bool
    is_measured: bool

    @property
    def is_upright(self) -> bool:
        """Whether its z axis is up, within 15 degrees."""
        return self.rotation[2][2] >= UPRIGHT

    @property
    def is_level(self) -> bool:
        """Whether it leans by less than a fifth of a degree."""
        return self.rotation[2][2] >= LEVEL

    @lazily
    def corners(self) -> tuple[Vector, ...]:
        """The eight corners, map frame [m]; the four of its base first."""
        x, y, z = self.size
        return tuple(
            self.to_map((sx * x / 2, sy * y / 2, level))
            for level in (0.0, z)
            for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))
        )

    @lazily
    def bottom(self) -> float:
        """Its lowest point [m]."""
        if not self.parts:
            return min(corner[2] for corner in self.corners)
        return min([part.low[2] for part in self.parts])

    @lazily
    def top(self) -> float:
        """Its highest point [m], that of its box."""
        (_, _, (g, h, i)), (x, y, z) = self.rotation, self.size
        return self.position[2] + max(0.0, i * z) + (abs(g) * x + abs(h) * y) / 2

    @lazily
    def lowest_top(self) -> float:
        """Where the first of its parts ends [m]: what stands on it upright does not stand lower."""
        return min([part.high[2] for part in self.parts], default=self.top)

    @lazily
    def outline(self) -> list[Point]:
        """Its shadow on the floor."""
        if not self.is_level:
            return hull([(x, y) for x, y, _ in self.corners])
        (a, b, _), (d, e, _), _ = self.rotation
        x, y, _ = self.size
        px, py, _ = self.position
        ax, ay, bx, by = a * x / 2, d * x / 2, b * y / 2, e * y / 2
        return [
            (px - ax - bx, py - ay - by),
            (px + ax - bx, py + ay - by),
            (px + ax + bx, py + ay + by),
            (px - ax + bx, py - ay + by),
        ]

    @lazily
    def base(self) -> Sequence[Point]:
        """What it stands on: the outline of its lowest parts."""
        parts = [part for part in self.parts if part.low[2] <= self.bottom + LOWEST_M]
        return parts[0].shadow if len(parts) == 1 else hull([xy for part in parts for xy in part.shadow])

    @lazily
    def centre(self) -> Vector:
        """The middle of its box, map frame [m]."""
        return self.to_map((0.0, 0.0, self.size[2] / 2))

    @lazily
    def bounds(self) -> Bounds:
        """Least x and y, greatest x and y [m]."""
        (a, b, c), (d, e, f), _ = self.rotation
        x, y, z = self.size
        px, py, _ = self.position
        px, py = px + c * z / 2, py + f * z / 2
        half_x = (abs(a) * x + abs(b) * y + abs(c) * z) / 2
        half_y = (abs(d) * x + abs(e) * y + abs(f) * z) / 2
        return px - half_x, py - half_y, px + half_x, py + half_y

    @lazily
    def supports(self) -> tuple[Support, ...]:
        """The surfaces that carry things; the whole top of what has no model."""
        if self.is_place or not self.is_measured or not self.is_upright:
            return ()
        return tuple(
            Support(
                self.to_map((0.0, 0.0, surface.height))[2],
                tuple(
                    self.to_map((x, y, surface.height))[:2]
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

    @property
    def hollows(self) -> tuple[Interior, ...]:
        """Its interiors, in its own frame."""
        return self.shape.interiors if self.is_measured else ()

    @lazily
    def parts(self) -> tuple[Convex, ...]:
        """What of it collides, map frame; the whole box of what has no model, nothing of what has no size."""
        if self.is_place or not self.is_measured:
            return ()
        (a, b, c), (d, e, f), (g, h, i) = self.rotation

        def turned(vectors: tuple[Vector, ...]) -> tuple[Vector, ...]:
            return tuple(
                (a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z) for x, y, z in vectors
            )

        return tuple(
            convex(self.to_map(part.centre), turned(part.straight), turned(part.round), turned(part.points))
            for part in self.shape.parts
        )

    def forget(self) -> None:
        """Drop what can be worked out again, but where it is: of many solids that is most of the memory."""
        for name in _WORKED_OUT:
            self.__dict__.pop(name, None)

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

    @lazily
    def volume(self) -> float:
        """Of its box [m^3]."""
        x, y, z = self.size
        return x * y * z

    @lazily
    def footprint(self) -> float:
        """Of its shadow [m^2]."""
        return area(self.outline)

    @lazily
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
    size = entity.size_m or (None if entity.place else own_size_m(entity.model) if entity.model else None)
    return Solid(
        name=entity.name,
        position=entity.pose.position_m,
        rotation=_rotation(entity.pose.orientation_wxyz),
        size=size or (0.02, 0.02, 0.02),
        shape=_BOX if size is None or entity.place else fitted(entity.model, size),
        is_place=entity.place,
        is_measured=size is not None,
    )


@lru_cache(maxsize=4096)
def _rotation(wxyz: tuple[float, float, float, float]) -> Matrix:
    w, x, y, z = wxyz
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
