"""Entities as solids: an oriented box in the map, with supporting surfaces and hollows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from semmap.nodes.geometry.polygons import Point
from semmap.nodes.kb_node.relations.geometry.convex import OCTAGON, Convex, translate
from semmap.nodes.kb_node.relations.geometry.forms import Bounds, Form, Matrix, form_of, region_form
from semmap.nodes.kb_node.relations.geometry.lazy_property import lazy_property
from semmap.nodes.kb_node.relations.geometry.opening import AS_DRAWN, Positions
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity, extent_in, joints_in, model_of
from semmap.ontology.model_shapes import Interior, own_size_m
from semmap.schemas.entities import Entity, Pose, Size, Vector

Shape = tuple[str | None, Size | None, Positions]
Extent = tuple[Bounds, float, float]
"""Bounds, bottom and top."""
UNMEASURED: Final[Size] = (0.02, 0.02, 0.02)
"""The size of entities without one, nearly a point."""
SAMPLES = 5
"""Sample points along each axis of a volume."""


@dataclass(frozen=True)
class Support:
    """A level surface of a solid in the map frame: height [m] and outline."""

    height: float
    outline: tuple[Point, ...]
    fill: float


class Solid:
    """An object or place in the map: position [m] of its bottom centre, and its form.

    `is_measured` is True if the map or the model gives a size. Otherwise it is a point, whose only property
    is its position.
    """

    __slots__ = (
        "__dict__", "bottom", "bounds", "form", "is_fixed", "is_level", "is_measured", "is_place", "name",
        "position", "top",
    )  # fmt: skip

    def __init__(
        self,
        name: str,
        position: Vector,
        form: Form,
        is_place: bool,
        is_measured: bool,
        extent: Extent | None = None,
        is_fixed: bool = False,
    ) -> None:
        """`extent` is the bounds, bottom and top, if they are already known."""
        self.name: Final = name
        self.position: Final = position
        self.form: Final = form
        self.is_place: Final = is_place
        self.is_measured: Final = is_measured
        self.is_fixed: Final = is_fixed
        """Whether it is mounted, such as a picture or a sink."""
        form.users += 1
        self.is_level: Final = form.is_level
        """Whether it is tilted by less than a fifth of a degree."""
        bounds, bottom, top = extent or self._extent()
        self.bounds: Final = bounds
        """Least x and y, greatest x and y [m]."""
        self.bottom: Final = bottom
        """The lowest point [m]."""
        self.top: Final = top
        """The highest point [m] of its box."""

    def _extent(self) -> Extent:
        form, z = self.form, self.position[2]
        bottom = form.bottom if self.has_parts else form.lowest_corner
        return _bounds(form, self.position), z + bottom, z + form.top

    @property
    def has_parts(self) -> bool:
        """Return whether it can collide: it is an object of known size."""
        return self.is_measured and not self.is_place

    @property
    def rotation(self) -> Matrix:
        """Return the rotation from body to map."""
        return self.form.rotation

    @property
    def size(self) -> Size:
        """Return the size along its own axes [m]."""
        return self.form.size

    @property
    def is_upright(self) -> bool:
        """Return whether its z axis is up, within 15 degrees."""
        return self.form.is_upright

    @property
    def volume(self) -> float:
        """Return the volume of its box [m^3]."""
        return self.form.volume

    @property
    def footprint(self) -> float:
        """Return the area of its outline [m^2]."""
        return self.form.footprint

    @property
    def hollows(self) -> tuple[Interior, ...]:
        """Return the interiors that can contain something, in its own frame."""
        return self.form.hollows if self.is_measured else ()

    def outline_of(self, hollow: Interior) -> list[Point]:
        """Return the walls of one of its hollows on the floor plan. Those of a round one are an octagon."""
        (x0, y0, z0), (x1, y1, _) = hollow.low, hollow.high
        corners: Sequence[Point] = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
        if hollow.round:
            x, y, half_x, half_y = (x0 + x1) / 2, (y0 + y1) / 2, (x1 - x0) / 2, (y1 - y0) / 2
            corners = [(x + half_x * c, y + half_y * s) for c, s in OCTAGON]
        return [self.to_map((*corner, z0))[:2] for corner in corners]

    @property
    def lowest_top(self) -> float:
        """Return the lowest top of a part [m]. Nothing upright stands lower on it."""
        return self.position[2] + self.form.lowest_top if self.has_parts else self.top

    @property
    def highest_bottom(self) -> float:
        """Return the highest bottom of a part [m]. A bookshelf may rest on a table by one of its boards."""
        return self.position[2] + self.form.highest_bottom if self.has_parts else self.bottom

    @lazy_property
    def outline(self) -> list[Point]:
        """Return its projection onto the floor."""
        px, py, _ = self.position
        return [(px + x, py + y) for x, y in self.form.outline]

    @lazy_property
    def base(self) -> Sequence[Point]:
        """Return the outline of its lowest parts, on which it stands."""
        px, py, _ = self.position
        return [(px + x, py + y) for x, y in self.form.base] if self.parts else []

    @lazy_property
    def centre(self) -> Vector:
        """Return the centre of its box in the map frame [m]."""
        return self.to_map((0.0, 0.0, self.size[2] / 2))

    @lazy_property
    def supports(self) -> tuple[Support, ...]:
        """Return the supporting surfaces. Without a model it is the whole top."""
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
            for surface in self.form.shape.surfaces
        )

    @lazy_property
    def parts(self) -> tuple[Convex, ...]:
        """Return the colliding parts in the map frame.

        Without a model it is the whole box, without a size none.
        """
        if not self.has_parts:
            return ()
        return tuple([translate(part, self.position) for part in self.form.parts])

    @property
    def open_parts(self) -> list[Convex]:
        """Return the parts that a joint has moved from their drawn position, in the map frame."""
        form = self.form
        opened = [
            k for leaf, at in zip(form.shape.leaves, form.joints, strict=False) if at for k in leaf.parts
        ]
        return [self.parts[k] for k in opened] if self.has_parts else []

    def clear_cache(self) -> None:
        """Drop cached properties except the location. For many solids they take most of the memory."""
        del self.__dict__
        if self.form.users <= 1:
            self.form.clear_cache()

    def to_map(self, point: Vector) -> Vector:
        """Transform a point from its own frame to the map."""
        px, py, pz = self.position
        x, y, z = self.form.turned(point)
        return px + x, py + y, pz + z

    def to_own(self, point: Vector) -> Vector:
        """Transform a point from the map to its own frame."""
        x, y, z = (p - o for p, o in zip(point, self.position, strict=True))
        (a, b, c), (d, e, f), (g, h, i) = self.rotation
        return (a * x + d * y + g * z, b * x + e * y + h * z, c * x + f * y + i * z)

    @lazy_property
    def samples(self) -> list[Vector]:
        """Return points spread evenly over its volume, in the map frame [m]."""
        x, y, z = self.size
        shares = [(k + 0.5) / SAMPLES for k in range(SAMPLES)]
        return [
            self.to_map(((u - 0.5) * x, (v - 0.5) * y, w * z)) for u in shares for v in shares for w in shares
        ]


def solid_of(entity: Entity | PlacedEntity, before: Solid | None = None) -> Solid | None:
    """Return the solid of an entity, or None without a position.

    `before` is the one that it replaces. A solid that only moved keeps its form. At the same height it also
    keeps bottom and top, which are expensive to compute.
    """
    pose = entity.pose
    if pose is None:
        return None
    model, size, joints = shape_of(entity)
    if entity.place and (form := _find_region_form(entity, pose.position_m, size)) is not None:
        return Solid(entity.name, pose.position_m, form, True, True)
    extent, turn = size or UNMEASURED, pose.orientation_wxyz
    if before is None or not before.form.is_of(model, extent, turn, joints):
        form = form_of(model, extent, turn, joints)
        return Solid(
            entity.name, pose.position_m, form, entity.place, size is not None, is_fixed=entity.fixed
        )
    form = before.form
    form.users -= 1
    stays = before.position[2] == pose.position_m[2]
    is_alike = stays and (before.is_place, before.is_measured) == (entity.place, size is not None)
    known = (_bounds(form, pose.position_m), before.bottom, before.top) if is_alike else None
    return Solid(entity.name, pose.position_m, form, entity.place, size is not None, known, entity.fixed)


def form_in(entity: Entity | PlacedEntity, pose: Pose, shape: Shape) -> Form:
    """Return the form of an entity at `pose`, given `shape_of` it."""
    model, size, joints = shape
    found = _find_region_form(entity, pose.position_m, size) if entity.place else None
    return found or form_of(model, size or UNMEASURED, pose.orientation_wxyz, joints)


def _find_region_form(entity: Entity | PlacedEntity, position: Vector, size: Size | None) -> Form | None:
    """Return the form of a place whose extent is a polygon, or None for a box."""
    if size is None or not (wkt := extent_in(entity)):
        return None
    return region_form(wkt, size, position[:2])


def _bounds(form: Form, position: Vector) -> Bounds:
    x, y, _ = position
    low_x, low_y, high_x, high_y = form.bounds
    return x + low_x, y + low_y, x + high_x, y + high_y


def shape_of(entity: Entity | PlacedEntity) -> Shape:
    """Return model (None without parts), size or that of the model [m], and joints of an entity."""
    size = entity.size_m
    if entity.place:
        return None, size, AS_DRAWN
    model = model_of(entity)
    if size is None and model:
        size = own_size_m(model)
    if size is None:
        return None, None, AS_DRAWN
    if isinstance(entity, Entity) and not entity.properties:
        return model, size, AS_DRAWN
    return model, size, joints_in(entity)
