"""Forms: a shape at a size and orientation, shared by all equal solids."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import lru_cache
from itertools import product
from typing import Final

from semmap.nodes.geometry.polygons import Point, area, hull
from semmap.nodes.geometry.regions import Region
from semmap.nodes.kb_node.relations.geometry.convex import Convex, make_convex
from semmap.nodes.kb_node.relations.geometry.fitting import fit_model
from semmap.nodes.kb_node.relations.geometry.lazy_property import lazy_property
from semmap.nodes.kb_node.relations.geometry.opening import AS_DRAWN, Positions, open_shape
from semmap.ontology.model_shapes import ConvexPart, Interior, ModelShape
from semmap.schemas import errors
from semmap.schemas.entities import IDENTITY, Quaternion, Size, Vector
from semmap.schemas.polygons import Polygon, read_wkt

UPRIGHT = math.cos(math.radians(15.0))
"""An object that leans more has no level surfaces."""
LEVEL = math.cos(math.radians(0.2))
LOWEST_M = 0.01
"""Parts that end this close to the lowest point form the base."""
_BOX = ModelShape(size_m=(0.02, 0.02, 0.02))
"""The box of objects without a known size."""

Matrix = tuple[Vector, Vector, Vector]
Bounds = tuple[float, float, float, float]
"""Least x and y, greatest x and y [m]."""


class Form:
    """A shape at an orientation, relative to its bottom centre [m] and along the axes of the map.

    Most objects stand upright like others of their model, so derived properties are computed lazily and
    once for all of them. `joints` are the positions of doors and drawers. An open door is a colliding part
    and within the bounds. Size, outline, footprint and volume are those of the closed object.
    """

    __slots__ = (
        "__dict__", "is_level", "is_upright", "joints", "model", "orientation", "rotation", "size", "users",
    )  # fmt: skip

    def __init__(self, model: str | None, size: Size, wxyz: Quaternion, joints: Positions = AS_DRAWN) -> None:
        """A `model` of None has no parts, and "" is a box."""
        self.model: Final = model
        self.size: Final = size
        self.joints: Final = joints
        self.orientation: Final = wxyz
        self.rotation: Final = _rotation(wxyz)
        """Map from body."""
        self.users = 0
        """The number of solids that have or had it."""
        self.is_level: Final = self.rotation[2][2] >= LEVEL
        self.is_upright: Final = self.rotation[2][2] >= UPRIGHT

    region: Region | None = None
    """The area of a place whose extent is a polygon."""

    def is_of(self, model: str | None, size: Size, wxyz: Quaternion, joints: Positions = AS_DRAWN) -> bool:
        """Return whether it is the form of a model at this size, orientation and joint positions."""
        return (
            self.orientation == wxyz and self.size == size and self.model == model and self.joints == joints
        )

    @lazy_property
    def shape(self) -> ModelShape:
        """Return the shape of its model at its size and joint positions, in its own frame."""
        return _BOX if self.model is None else open_shape(fit_model(self.model, self.size), self.joints)

    def turned(self, vector: Vector) -> Vector:
        """Return a vector of its own frame along the axes of the map."""
        x, y, z = vector
        (a, b, c), (d, e, f), (g, h, i) = self.rotation
        return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z

    @lazy_property
    def corners(self) -> tuple[Vector, ...]:
        """Return the eight corners, the four of the base first."""
        x, y, z = self.size
        return tuple(
            self.turned((sx * x / 2, sy * y / 2, level))
            for level in (0.0, z)
            for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))
        )

    @lazy_property
    def lowest_corner(self) -> float:
        """Return the height of the lowest corner of the box."""
        return min(corner[2] for corner in self.corners)

    @lazy_property
    def bottom(self) -> float:
        """Return the height of the lowest point."""
        return min([part.low[2] for part in self.parts]) if self.parts else self.lowest_corner

    @lazy_property
    def top(self) -> float:
        """Return the height of the highest corner of the box, or of an open part above it."""
        (_, _, (g, h, i)), (x, y, z) = self.rotation, self.size
        top = max(0.0, i * z) + (abs(g) * x + abs(h) * y) / 2
        return max([top, *(part.high[2] for part in self.parts)]) if self.joints else top

    @lazy_property
    def lowest_top(self) -> float:
        """Return the height of the lowest top of a part."""
        return min([part.high[2] for part in self.parts], default=self.top)

    @lazy_property
    def has_slopes(self) -> bool:
        """Return whether an object may stand lower on a part than its top, if the form is level."""
        return have_slopes(self.shape.parts)

    @lazy_property
    def highest_bottom(self) -> float:
        """Return the height of the highest bottom of a part."""
        return max([part.low[2] for part in self.parts], default=self.bottom)

    @lazy_property
    def bounds(self) -> Bounds:
        """Return the bounds of the box and of open parts beyond it."""
        box = self._bounds_of_box()
        if not self.joints:
            return box
        lows, highs = zip(*((part.low, part.high) for part in self.parts), strict=True)
        return (
            min([box[0], *(x for x, _, _ in lows)]),
            min([box[1], *(y for _, y, _ in lows)]),
            max([box[2], *(x for x, _, _ in highs)]),
            max([box[3], *(y for _, y, _ in highs)]),
        )

    def _bounds_of_box(self) -> Bounds:
        (a, b, c), (d, e, f), _ = self.rotation
        x, y, z = self.size
        mid_x, mid_y = c * z / 2, f * z / 2
        half_x = (abs(a) * x + abs(b) * y + abs(c) * z) / 2
        half_y = (abs(d) * x + abs(e) * y + abs(f) * z) / 2
        return mid_x - half_x, mid_y - half_y, mid_x + half_x, mid_y + half_y

    @lazy_property
    def hollows(self) -> tuple[Interior, ...]:
        """Return the interiors that can contain something, in its own frame."""
        return tuple([hollow for hollow in self.shape.interiors if not hollow.shallow])

    @lazy_property
    def hollow_bounds(self) -> tuple[Vector, Vector] | None:
        """Return the lowest and highest corner of the box around its hollows, or None without one."""
        corners = [
            self.turned((x, y, z))
            for hollow in self.hollows
            for x, y, z in product(*zip(hollow.low, hollow.high, strict=True))
        ]
        if not corners:
            return None
        xs, ys, zs = zip(*corners, strict=True)
        return (min(xs), min(ys), min(zs)), (max(xs), max(ys), max(zs))

    @lazy_property
    def is_sealed(self) -> bool:
        """Return whether nothing can get into it from outside, although it has a hollow."""
        return all(hollow.is_sealed for hollow in self.hollows)

    @lazy_property
    def is_square(self) -> bool:
        """Return whether the outline equals the bounds."""
        (a, b, _), (d, e, _), _ = self.rotation
        return (
            self.is_level
            and not self.joints
            and (max(abs(b), abs(d)) < _EXACTLY or max(abs(a), abs(e)) < _EXACTLY)
        )

    @lazy_property
    def outline(self) -> list[Point]:
        """Return the projection of the box onto the floor."""
        if not self.is_level:
            return hull([(x, y) for x, y, _ in self.corners])
        (a, b, _), (d, e, _), _ = self.rotation
        x, y, _ = self.size
        ax, ay, bx, by = a * x / 2, d * x / 2, b * y / 2, e * y / 2
        return [(-ax - bx, -ay - by), (ax - bx, ay - by), (ax + bx, ay + by), (-ax + bx, -ay + by)]

    @lazy_property
    def base(self) -> Sequence[Point]:
        """Return the outline of the lowest parts."""
        parts = [part for part in self.parts if part.low[2] <= self.bottom + LOWEST_M]
        return (
            parts[0].projection if len(parts) == 1 else hull([xy for part in parts for xy in part.projection])
        )

    @lazy_property
    def parts(self) -> tuple[Convex, ...]:
        """Return the colliding parts."""
        turned = self.turned
        return tuple(
            make_convex(
                turned(part.centre),
                tuple(map(turned, part.straight)),
                tuple(map(turned, part.round)),
                tuple(map(turned, part.points)),
            )
            for part in self.shape.parts
        )

    @lazy_property
    def volume(self) -> float:
        """Return the volume of the box [m^3]."""
        x, y, z = self.size
        return x * y * z

    @lazy_property
    def footprint(self) -> float:
        """Return the area of the outline [m^2]."""
        return area(self.outline)

    def clear_cache(self) -> None:
        """Drop all cached properties."""
        del self.__dict__


_EXACTLY = 1e-9


class RegionForm(Form):
    """The form of a place whose extent is a polygon, relative to the centre of its upright bounding box."""

    def __init__(self, polygon: Polygon, size: Size, middle: Point) -> None:
        super().__init__(None, size, IDENTITY)
        x, y = middle
        self.region = Region([[(px - x, py - y) for px, py in ring] for ring in polygon.rings])

    def is_of(self, model: str | None, size: Size, wxyz: Quaternion, joints: Positions = AS_DRAWN) -> bool:
        """Return False, because each place has its own extent."""
        return False

    def clear_cache(self) -> None:
        """Drop all cached properties except the region, which cannot be computed again."""
        region = self.region
        super().clear_cache()
        self.region = region

    @lazy_property
    def is_square(self) -> bool:
        """Return False, because only a box can be square."""
        return False

    @lazy_property
    def outline(self) -> list[Point]:
        """Return the convex hull of the area."""
        if self.region is None:
            raise errors.InternalError("the solid has no region")
        return hull([point for piece in self.region.pieces for point in piece.corners])

    @lazy_property
    def footprint(self) -> float:
        """Return the area [m^2]."""
        if self.region is None:
            raise errors.InternalError("the solid has no region")
        return self.region.area

    @lazy_property
    def volume(self) -> float:
        """Return the area times the height [m^3]."""
        return self.footprint * self.size[2]


@lru_cache(maxsize=1024)
def region_form(wkt: str, size: Size, middle: Point) -> RegionForm:
    """Return the form of a place with this extent, whose bounding box has this size and centre."""
    return RegionForm(read_wkt(wkt), size, middle)


@lru_cache(maxsize=4096)
def form_of(model: str | None, size: Size, wxyz: Quaternion, joints: Positions = AS_DRAWN) -> Form:
    """Return the form of a model at a size. A model of None has no parts, and "" is a box."""
    return Form(model, size, wxyz, joints)


@lru_cache(maxsize=1024)
def _rotation(wxyz: Quaternion) -> Matrix:
    w, x, y, z = wxyz
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


def have_slopes(parts: Iterable[ConvexPart]) -> bool:
    """Return whether the upper side of a part is neither level nor that of a ball, such as of a ramp."""
    made = (make_convex(part.centre, part.straight, part.round, part.points) for part in parts)
    return any(not part.has_flat_top and len(part.round) != 3 for part in made)
